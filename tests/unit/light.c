/* SPDX-License-Identifier: Apache-2.0 */
/* Light in the volume, and transfer functions of two dimensions: pictures against brute force over all cells in
 * extended precision; shadows and the ambient light that arrives against closed forms, and that what they are off by is
 * of second order in the size of cells; that what is kept is made anew when it must be; and what the library says where
 * it can't.
 */
#include "brute.h"

enum { W = 29, H = 23, PIXELS = W * H };

/* A transfer function, linear between knots that are the same for colour and extinction. */
enum { KNOTS = 5 };
typedef struct Matter {
  double at[KNOTS], extinction[KNOTS], color[KNOTS][3];
  int count;
} Matter;

static const Matter thin = {.at = {0, 0.2, 0.45, 0.6, 1},
                            .extinction = {0.25, 1, 0, 2, 0.5},
                            .color = {{1, 0, 0.5}, {0, 1, 0.25}, {0.5, 0.5, 1}, {1, 0.75, 0}, {0, 0.25, 1}},
                            .count = KNOTS};
static const Matter thick = {.at = {0, 0.2, 0.45, 0.6, 1},
                             .extinction = {0, 30, 1, 2000, 3},
                             .color = {{1, 0, 0.5}, {0, 1, 0.25}, {0.5, 0.5, 1}, {1, 0.75, 0}, {0, 0.25, 1}},
                             .count = KNOTS};

static TetcastTransferFunction *transfer_of_matter(World *world, const Matter *matter) {
  double color[KNOTS][4], extinction[KNOTS][2];
  for (int i = 0; i < matter->count; ++i) {
    color[i][0] = extinction[i][0] = matter->at[i];
    extinction[i][1] = matter->extinction[i];
    memcpy(color[i] + 1, matter->color[i], sizeof matter->color[i]);
  }
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.extinction = extinction[0];
  desc.color_count = desc.extinction_count = matter->count;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(world->fixture.context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

static void set_matter(World *world, const Matter *matter) {
  TetcastTransferFunction *transfer = transfer_of_matter(world, matter);
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

static double *shoot(const World *world, const TetcastCamera *camera, int width, int height, double tolerance) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  TetcastFrame *frame = NULL;
  TetcastRenderDesc render = render_desc();
  TetcastRenderStats stats;
  render.tolerance = tolerance;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, camera, &render, frame, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  const size_t size = (size_t)width * (size_t)height * 4 * sizeof(double);
  double *pixels = malloc(size);
  memcpy(pixels, tetcast_frame_pixels(frame), size);
  tetcast_frame_destroy(&frame);
  return pixels;
}

/* ── brute force ── */

typedef struct Reference {
  const Cube *cube;
  const double *values;
  const Matter *matter; /* of two dimensions: [rows], all with the same knots */
  int rows;
  const double *row_at, *second;     /* [rows]; [cells], NULL: the gradient's magnitude */
  const TetcastShadingDesc *shading; /* NULL: not lit */
  Real (*gradients)[3];
  const TetcastHalfSpace *clip;     /* NULL: none */
  const TetcastIsosurface *surface; /* NULL: none; it is not lit */
} Reference;

static void matter_at(const Matter *m, Real s, Real optics[4]) {
  int i = 0;
  while (i < m->count && m->at[i] <= s)
    ++i;
  const int a = i > 0 ? i - 1 : 0, b = i < m->count ? i : m->count - 1;
  const Real u = a < b ? (s - m->at[a]) / ((Real)m->at[b] - m->at[a]) : 0;
  optics[0] = m->extinction[a] + u * ((Real)m->extinction[b] - m->extinction[a]);
  for (int k = 0; k < 3; ++k)
    optics[1 + k] = m->color[a][k] + u * ((Real)m->color[b][k] - m->color[a][k]);
}

/* What a vertex is seen in: a factor and what is added, of each component. */
static void vertex_light(const Reference *r, const TetcastCamera *camera, int64_t id, Real factor[3], Real add[3]) {
  double along[3];
  Real length = 0, toward = 0, normal[3];
  for (int k = 0; k < 3; ++k) {
    along[k] = camera->projection == TETCAST_ORTHOGRAPHIC ? camera->target[k] - camera->eye[k]
                                                          : r->cube->vertices[3 * id + k] - camera->eye[k];
    length += (Real)along[k] * along[k];
  }
  for (int k = 0; k < 3; ++k) {
    along[k] = (double)(along[k] / sqrtl(length));
    toward += along[k] * r->gradients[id][k];
  }
  for (int k = 0; k < 3; ++k) {
    normal[k] = toward > 0 ? -r->gradients[id][k] : r->gradients[id][k];
    factor[k] = 1;
    add[k] = 0;
  }
  Real copy[3] = {normal[0], normal[1], normal[2]};
  light_up(r->shading, normal, along, factor);
  light_up(r->shading, copy, along, add);
  for (int k = 0; k < 3; ++k)
    factor[k] -= add[k];
}

/* Between which rows a cell is, by search from the end; *w is where between them. */
static int row_of(const Reference *r, Real second, Real *w) {
  *w = 0;
  if (second <= r->row_at[0])
    return 0;
  int row = r->rows - 1;
  while (r->row_at[row] > second)
    --row;
  if (row < r->rows - 1)
    *w = (second - r->row_at[row]) / ((Real)r->row_at[row + 1] - r->row_at[row]);
  return row;
}

/* What a cell's transfer function is. */
static Matter matter_of(const Reference *r, int64_t cell, const Linear *scalar) {
  Matter m = r->matter[0];
  if (r->rows == 0)
    return m;
  const Real *g = scalar->gradient;
  Real w;
  if (r->second && isnan(r->second[cell])) { /* transparent, but for surfaces */
    memset(m.extinction, 0, sizeof m.extinction);
    return m;
  }
  const int row = row_of(r, r->second ? (Real)r->second[cell] : sqrtl(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]), &w);
  const Matter *a = &r->matter[row], *b = &r->matter[row + 1 < r->rows ? row + 1 : row];
  for (int i = 0; i < m.count; ++i) {
    m.extinction[i] = (double)((1 - w) * a->extinction[i] + w * b->extinction[i]);
    for (int k = 0; k < 3; ++k)
      m.color[i][k] = (double)((1 - w) * a->color[i][k] + w * b->color[i][k]);
  }
  return m;
}

/* A stretch of a ray in a cell. */
typedef struct Stretch {
  Real from, to;
  Matter matter;
  Linear scalar, factor[3], add[3];
} Stretch;

static int by_middle(const void *a, const void *b) {
  const Real x = ((const Stretch *)a)->from + ((const Stretch *)a)->to,
             y = ((const Stretch *)b)->from + ((const Stretch *)b)->to;
  return x < y ? -1 : x > y;
}

/* Gauss's rule of five nodes, in steps of an optical depth of 1/16 and less. */
static void add_part(const Stretch *s, const double eye[3], const double direction[3], Real from, Real to,
                     Real color[3], Real *depth) {
  static const Real node[3] = {0, 0.538469310105683091036314420700208804967L,
                               0.906179845938663992797626878299392965125L},
                    weight[3] = {0.568888888888888888888888888888888888889L, 0.478628670499366468041291514835638192912L,
                                 0.236926885056189087514264040719917362644L};
  Real ends[2][4], at[2];
  for (int e = 0; e < 2; ++e) { /* inside of the piece */
    at[e] = from + (to - from) * (e ? 0.75L : 0.25L);
    matter_at(&s->matter, value_at(&s->scalar, eye, direction, at[e]), ends[e]);
  }
  const Real slope = (ends[1][0] - ends[0][0]) / (at[1] - at[0]);
  const Real k0 = fmaxl(0, ends[0][0] - slope * (at[0] - from)), all = (to - from) * (k0 + slope * (to - from) / 2);
  const int steps = (int)fminl(1e6L, ceill(16 * all) + 4);
  for (int i = 0; i < steps && *depth < 60; ++i) {
    const Real low = from + (to - from) * i / steps, high = from + (to - from) * (i + 1) / steps;
    for (int n = -2; n <= 2; ++n) {
      const Real t = (low + high) / 2 + (high - low) / 2 * (n < 0 ? -node[-n] : node[n]), h = t - low;
      const Real k_low = k0 + slope * (low - from), k = k0 + slope * (t - from);
      const Real w = weight[abs(n)] * (high - low) / 2 * k * expl(-*depth - h * (k_low + slope * h / 2));
      for (int c = 0; c < 3; ++c) {
        const Real at_t = ends[0][1 + c] + (ends[1][1 + c] - ends[0][1 + c]) / (at[1] - at[0]) * (t - at[0]);
        color[c] += w * (at_t * value_at(&s->factor[c], eye, direction, t) + value_at(&s->add[c], eye, direction, t));
      }
    }
    *depth += (high - low) * (k0 + slope * ((low + high) / 2 - from));
  }
}

/* The pixel; false: rounding decides what the ray meets. */
static bool trace(const Reference *r, const TetcastCamera *camera, int pixel, const double (*light)[6], Real rgba[4]) {
  double eye[3], direction[3];
  ray_of(camera, W, H, pixel, eye, direction);
  Stretch stretches[600];
  int count = 0;
  Real behind = 0;
  if (r->clip) {
    Real at = r->clip->offset, along = 0;
    for (int k = 0; k < 3; ++k)
      at -= (Real)r->clip->normal[k] * eye[k], along += (Real)r->clip->normal[k] * direction[k];
    behind = at / along;
    assert_true(along > 0);
  }
  double *column = malloc((size_t)r->cube->vertex_count * sizeof *column);
  bool sure = true;
  for (int64_t cell = 0; cell < r->cube->cell_count && sure; ++cell) {
    Stretch s;
    Real volume;
    if (!cross_cell(r->cube, cell, eye, direction, &s.from, &s.to))
      continue;
    if (s.to - s.from < 1e-10L)
      sure = false;
    s.from = fmaxl(s.from, behind);
    if (!(s.to > s.from))
      continue;
    s.scalar = linear_of(r->cube, cell, r->values, &volume);
    s.matter = matter_of(r, cell, &s.scalar);
    for (int j = 0; j < 6; ++j) {
      for (int k = 0; k < 4; ++k)
        column[r->cube->cells[4 * cell + k]] = light[r->cube->cells[4 * cell + k]][j];
      *(j < 3 ? &s.factor[j] : &s.add[j - 3]) = linear_of(r->cube, cell, column, &volume);
    }
    stretches[count++] = s;
  }
  free(column);
  qsort(stretches, (size_t)count, sizeof *stretches, by_middle);
  Real color[3] = {0, 0, 0}, depth = 0, left = 1;
  for (int i = 0; i < count; ++i) {
    Stretch *s = &stretches[i];
    const Real a = value_at(&s->scalar, eye, direction, s->from), b = value_at(&s->scalar, eye, direction, s->to);
    Real cut[KNOTS + 3];
    int cuts = 0;
    cut[cuts++] = s->from;
    for (int n = 0; n <= s->matter.count; ++n) { /* of knots in their order along the ray, then the surface */
      const int knot = a < b ? n : s->matter.count - 1 - n;
      if (n == s->matter.count)
        break;
      const Real u = (s->matter.at[knot] - a) / (b - a);
      if (u > 0 && u < 1)
        cut[cuts++] = s->from + (s->to - s->from) * u;
    }
    cut[cuts++] = s->to;
    for (int c = 0; c + 1 < cuts; ++c) {
      Real from = cut[c], to = cut[c + 1], met = INFINITY;
      if (r->surface) {
        met = s->from + (s->to - s->from) * (r->surface->value - a) / (b - a);
        if (fabsl(a - r->surface->value) < 1e-12L || fabsl(b - r->surface->value) < 1e-12L)
          sure = false;
      }
      for (int half = 0; half < 2; ++half) {
        Real part[3] = {0, 0, 0};
        const bool meets = met > from && met <= to;
        add_part(s, eye, direction, from, half == 0 && meets ? met : to, part, &depth);
        for (int k = 0; k < 3; ++k)
          color[k] += left * part[k];
        if (half == 1 || !meets)
          break;
        for (int k = 0; k < 3; ++k)
          color[k] += left * expl(-depth) * r->surface->opacity * r->surface->color[k];
        left *= 1 - r->surface->opacity;
        from = met;
      }
    }
  }
  memcpy(rgba, color, sizeof color);
  rgba[3] = 1 - left * expl(-depth);
  return sure;
}

/* The light of all vertices as a camera sees them. */
static double (*vertex_lights(const Reference *r, const TetcastCamera *camera))[6] {
  double(*light)[6] = malloc((size_t)r->cube->vertex_count * sizeof *light);
  for (int64_t i = 0; i < r->cube->vertex_count; ++i) {
    Real factor[3], add[3];
    if (r->shading)
      vertex_light(r, camera, i, factor, add);
    for (int k = 0; k < 3; ++k) {
      light[i][k] = r->shading ? (double)factor[k] : 1;
      light[i][3 + k] = r->shading ? (double)add[k] : 0;
    }
  }
  return light;
}

static double along_x(const double p[3]) {
  return 0.75 * p[0] + 0.125;
}

/* Fields at random have gradients that the library keeps in single precision; that of a field along x is exact, and
 * its light differs from vertex to vertex by where they are seen. */
static void pictures_are_as_brute_force_has_them(void **state) {
  (void)state;
  static const TetcastLight white[] = {{.direction = {1, 2, 3}, .color = {0.75, 0.75, 0.75}},
                                       {.direction = {-4, 1, 0}, .color = {0.5, 0.5, 0.5}}},
                            colored[] = {{.direction = {1, 2, 3}, .color = {1, 0.5, 0.25}},
                                         {.direction = {-40, 1, 0}, .color = {0.125, 0.25, 1}}};
  static const TetcastIsosurface surface = {.value = 0.5, .color = {1, 0, 0.25}, .opacity = 0.25};
  static const TetcastHalfSpace clip = {.normal = {-1, -0.5, -2}, .offset = -1.4};
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 0.1, 0.3, 0),
                                   parallel(3, 2, 4, 1.6)};
  for (int i = 0; i < 16; ++i) {
    const bool random = i & 1, heavy = i & 2;
    World world;
    world_begin(&world, 4, 0.6, 1, i % 5 == 4 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.vertex_count; ++j)
      values[j] = random ? world.cube.values[j] : along_x(&world.cube.vertices[3 * j]);
    set_values(&world, values, TETCAST_POINT);
    TetcastShadingDesc shading = tetcast_shading_desc_default();
    shading.shade = TETCAST_SHADE_VOLUME;
    shading.exponent = i % 3 ? 4 : 30;
    shading.specular = 0.5;
    shading.lights = i & 8 ? colored : white;
    shading.light_count = i & 4 ? 2 : 0;
    Reference r = {.cube = &world.cube, .values = values, .matter = heavy ? &thick : &thin, .shading = &shading};
    if (i % 3 == 0) {
      r.surface = &surface;
      assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, &surface, 1), TETCAST_OK);
    }
    const TetcastCamera *camera = &cameras[i % 3];
    if (i % 4 == 3 && i % 3 != 1) {
      r.clip = &clip;
      assert_int_equal(tetcast_scene_set_clip(world.scene, &clip, 1), TETCAST_OK);
    }
    assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
    set_matter(&world, r.matter);
    r.gradients = vertex_gradients(r.cube, r.values);
    double(*light)[6] = vertex_lights(&r, camera), *pixels = shoot(&world, camera, W, H, 0),
    *loose = shoot(&world, camera, W, H, 1e-3);
    /* Where the extinction is steep, so is its change with the rounding of the scalar. */
    const double steep = heavy ? 5e-12 : 1e-13, tolerance = random ? 3e-6 : steep;
    int compared = 0;
    for (int p = 0; p < PIXELS; ++p) {
      Real wanted[4];
      if (!trace(&r, camera, p, (const double(*)[6])light, wanted))
        continue;
      ++compared;
      for (int k = 0; k < 4; ++k) {
        const double got = pixels[4 * p + k];
        if (!(fabsl(got - wanted[k]) <= (k == 3 ? steep : tolerance)))
          fail_msg("world %d, pixel %d, channel %d: %.17g, not %.17Lg", i, p, k, got, wanted[k]);
        if (!(fabsl(loose[4 * p + k] - wanted[k]) <= 1e-3))
          fail_msg("world %d, pixel %d, channel %d: %.17g within 1e-3, not %.17Lg", i, p, k, loose[4 * p + k],
                   wanted[k]);
      }
    }
    assert_true(compared > PIXELS * 9 / 10);
    free(pixels);
    free(loose);
    free(light);
    free(r.gradients);
    free(values);
    world_end(&world);
  }
}

/* All ambient light and no other is no change, to the last bits; without any gradient there is no highlight. */
static void plain_light_changes_nothing(void **state) {
  (void)state;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 6, 0.6, 1, TETCAST_TRAVERSAL_SHELL);
  set_matter(&world, &thin);
  for (int flat = 0; flat < 2; ++flat) {
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.vertex_count; ++j)
      values[j] = flat ? 0.3 : world.cube.values[j];
    set_values(&world, values, TETCAST_POINT);
    assert_int_equal(tetcast_scene_set_shading(world.scene, NULL), TETCAST_OK);
    double *plain = shoot(&world, &camera, W, H, 0);
    TetcastShadingDesc shading = tetcast_shading_desc_default();
    shading.shade = TETCAST_SHADE_ALL;
    shading.ambient = flat ? 0.25 : 1;
    shading.diffuse = flat ? 0.75 : 0;
    shading.specular = flat ? 1 : 0;
    assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
    double *lit = shoot(&world, &camera, W, H, 0);
    assert_true(largest_difference(plain, lit, 4 * PIXELS) <= 2e-15);
    free(plain);
    free(lit);
    free(values);
  }
  world_end(&world);
}

/* ── what arrives ── */

/* A cube of one extinction, lit from above: at height z what arrives is e^−κ(1 − z). Seen along x, with nothing but
 * diffuse light and no gradient. Returns the largest error; with `at_vertices`, along rays through vertices' heights.
 */
static double shadow_error(int n, bool at_vertices) {
  const double kappa = 2;
  static const TetcastLight above = {.direction = {0, 0, 3}, .color = {1, 1, 1}};
  static const Matter even = {.at = {0}, .extinction = {2}, .color = {{1, 0.5, 0.25}}, .count = 1};
  const int rows = at_vertices ? 8 : 512;
  World world;
  world_begin(&world, n, 0, 1, TETCAST_TRAVERSAL_SHELL);
  double *values = calloc((size_t)world.cube.vertex_count, sizeof *values);
  set_values(&world, values, TETCAST_POINT);
  set_matter(&world, &even);
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.shade = TETCAST_SHADE_VOLUME;
  shading.ambient = 0;
  shading.diffuse = 1;
  shading.lights = &above;
  shading.light_count = 1;
  shading.shadows = 1;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  const double shift = at_vertices ? 0.5 / rows : 0; /* the middles of pixels at multiples of 1 / rows */
  const TetcastCamera camera = {.eye = {5, 0.47, 0.5 + shift},
                                .target = {0, 0.47, 0.5 + shift},
                                .up = {0, 0, 1},
                                .projection = TETCAST_ORTHOGRAPHIC,
                                .height = 1};
  double *pixels = shoot(&world, &camera, 1, rows, 0), worst = 0;
  for (int y = 0; y < rows; ++y) {
    const double z = 1 - (y + 0.5) / rows + shift, arrives = exp(-kappa * (1 - z)), seen = -expm1(-kappa);
    if (z >= 1)
      continue;
    worst = fmax(worst, fabs(pixels[4 * y] - arrives * seen));
    assert_true(fabs(pixels[4 * y + 1] - 0.5 * pixels[4 * y]) < 1e-15);
  }
  free(pixels);
  free(values);
  world_end(&world);
  return worst;
}

static void shadows_are_of_second_order(void **state) {
  (void)state;
  /* At vertices they are exact, but for single precision and for rays that start a little beside. */
  assert_true(shadow_error(8, true) < 1e-5);
  double before = shadow_error(4, false);
  assert_true(before > 1e-3);
  for (int n = 8; n <= 32; n *= 2) {
    const double error = shadow_error(n, false), ratio = before / error;
    if (!(ratio > 3.4 && ratio < 4.5))
      fail_msg("%d cells along an edge: an error of %g, %g times less than with half as many", n, error, ratio);
    before = error;
  }
}

/* What arrives at a point of the unit cube from n directions. */
static double open_at(const double point[3], double kappa, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, across = sqrt(1 - z * z), turn = i * acos(-1) * (3 - sqrt(5));
    const double d[3] = {across * cos(turn), across * sin(turn), z};
    double length = INFINITY;
    for (int k = 0; k < 3; ++k) {
      if (d[k] != 0)
        length = fmin(length, fmax(-point[k] / d[k], (1 - point[k]) / d[k]));
    }
    sum += exp(-kappa * length);
  }
  return sum / n;
}

/* Along a row of vertices the light is linear between one and the next. */
static void ambient_light_comes_from_all_sides(void **state) {
  (void)state;
  enum { N = 4, RAYS = 50, STEPS = 4000 };
  const double kappa = 2;
  static const Matter even = {.at = {0}, .extinction = {2}, .color = {{1, 0.5, 0.25}}, .count = 1};
  World world;
  world_begin(&world, N, 0, 1, TETCAST_TRAVERSAL_SHELL);
  double *values = calloc((size_t)world.cube.vertex_count, sizeof *values);
  set_values(&world, values, TETCAST_POINT);
  set_matter(&world, &even);
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.shade = TETCAST_SHADE_VOLUME;
  shading.ambient = 1;
  shading.diffuse = 0;
  shading.occlusion_rays = RAYS;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  for (int j = 1; j < N; ++j) {
    const TetcastCamera camera = {.eye = {5, (double)j / N, 0.25},
                                  .target = {0, (double)j / N, 0.25},
                                  .up = {0, 0, 1},
                                  .projection = TETCAST_ORTHOGRAPHIC,
                                  .height = 0.01};
    double *pixel = shoot(&world, &camera, 1, 1, 0), wanted = 0;
    for (int i = 0; i < STEPS; ++i) {
      const double x = 1 - (i + 0.5) / STEPS, u = x * N - floor(x * N);
      const double a[3] = {floor(x * N) / N, (double)j / N, 0.25}, b[3] = {(floor(x * N) + 1) / N, a[1], a[2]};
      wanted +=
          kappa / STEPS * exp(-kappa * (1 - x)) * ((1 - u) * open_at(a, kappa, RAYS) + u * open_at(b, kappa, RAYS));
    }
    if (!(fabs(pixel[0] - wanted) < 1e-5))
      fail_msg("row %d: %.9g, not %.9g", j, pixel[0], wanted);
    free(pixel);
  }
  free(values);
  world_end(&world);
}

/* A picture of a scene whose shadows were computed for something else is that of a new scene. Surfaces have shadows as
 * well: those of the volume. */
static void shadows_are_made_anew(void **state) {
  (void)state;
  static const TetcastLight light = {.direction = {1, 2, 3}, .color = {1, 1, 1}};
  static const TetcastIsosurface surface = {.value = 0.5, .color = {1, 1, 1}, .opacity = 1};
  static const TetcastHalfSpace clip = {.normal = {0, 0, -1}, .offset = -0.7};
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 6, 0.6, 1, TETCAST_TRAVERSAL_SHELL);
  double *values = malloc((size_t)world.cube.vertex_count * sizeof *values), *before = NULL;
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.shade = TETCAST_SHADE_ALL;
  shading.lights = &light;
  shading.light_count = 1;
  for (int step = 0; step < 7; ++step) {
    double *pictures[2];
    for (int fresh = 0; fresh < 2; ++fresh) { /* the scene that has seen the steps before, and a new one */
      if (fresh) {
        tetcast_scene_destroy(&world.scene);
        assert_int_equal(tetcast_scene_create(world.fixture.context, world.volume, &world.scene), TETCAST_OK);
      }
      for (int64_t j = 0; j < world.cube.vertex_count; ++j)
        values[j] = step >= 2 ? 1 - world.cube.values[j] : world.cube.values[j];
      if (fresh || step == 0 || step == 2)
        set_values(&world, values, TETCAST_POINT);
      if (fresh || step == 0 || step == 3)
        set_matter(&world, step >= 3 ? &thick : &thin);
      if (step >= 4 && (fresh || step == 4))
        assert_int_equal(tetcast_scene_set_clip(world.scene, &clip, 1), TETCAST_OK);
      shading.shadows = step >= 1;
      shading.occlusion_rays = step >= 5 ? 7 : 0;
      if (fresh || step == 0 || step == 1 || step == 5)
        assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
      if (step >= 6)
        assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, &surface, 1), TETCAST_OK);
      pictures[fresh] = shoot(&world, &camera, W, H, 0);
    }
    assert_true(largest_difference(pictures[0], pictures[1], 4 * PIXELS) == 0);
    if (before)
      assert_true(largest_difference(pictures[0], before, 4 * PIXELS) > 1e-3);
    free(before);
    before = pictures[0];
    free(pictures[1]);
  }
  shading.shade = TETCAST_SHADE_SURFACES; /* a surface in a shadow is darker than one without */
  set_matter(&world, &thin);
  double sum[2] = {0, 0};
  for (int shadows = 0; shadows < 2; ++shadows) {
    shading.shadows = shadows;
    shading.occlusion_rays = 0;
    assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
    double *pixels = shoot(&world, &camera, W, H, 0);
    for (int p = 0; p < PIXELS; ++p)
      sum[shadows] += pixels[4 * p];
    free(pixels);
  }
  assert_true(sum[1] < 0.95 * sum[0]);
  free(before);
  free(values);
  world_end(&world);
}

/* ── transfer functions of two dimensions ── */

/* Rows at values of |∇s|, or of a field of cells, some of which are NaN; one row alone; with light and surfaces. Rays
 * through cells of very different gradients cross knots where one row has nothing and the other much. */
static void two_dimensions_are_as_brute_force_has_them(void **state) {
  (void)state;
  static const Matter rows[] = {{.at = {0, 0.2, 0.45, 0.6, 1},
                                 .extinction = {0, 0, 0, 0, 0},
                                 .color = {{1, 0, 0.5}, {0, 1, 0.25}, {0.5, 0.5, 1}, {1, 0.75, 0}, {0, 0.25, 1}},
                                 .count = KNOTS},
                                {.at = {0, 0.2, 0.45, 0.6, 1},
                                 .extinction = {0, 5, 0, 1, 4},
                                 .color = {{0, 0, 1}, {1, 1, 0}, {1, 0.5, 0}, {0, 0.75, 1}, {1, 0, 0}},
                                 .count = KNOTS},
                                {.at = {0, 0.2, 0.45, 0.6, 1},
                                 .extinction = {40, 0, 0, 3, 0.5},
                                 .color = {{1, 1, 1}, {0, 0, 0.25}, {0.5, 0, 1}, {1, 0, 0}, {0, 1, 1}},
                                 .count = KNOTS}};
  static const double at[] = {0.5, 1.25, 4};
  static const TetcastLight light[] = {{.direction = {1, 2, 3}, .color = {1, 0.5, 0.25}}};
  static const TetcastIsosurface surface = {.value = 0.5, .color = {1, 0, 0.25}, .opacity = 0.25};
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), parallel(3, 2, 4, 1.6)};
  for (int i = 0; i < 12; ++i) {
    World world;
    world_begin(&world, 4, 0.6, 1, i % 5 == 4 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values),
           *second = malloc((size_t)world.cube.cell_count * sizeof *second);
    uint64_t seed = 7;
    for (int64_t j = 0; j < world.cube.vertex_count; ++j)
      values[j] = i % 6 == 5 ? along_x(&world.cube.vertices[3 * j]) : world.cube.values[j];
    for (int64_t j = 0; j < world.cube.cell_count; ++j)
      second[j] = j % 17 == 3 ? (double)NAN : 4.5 * uniform(&seed) - 0.1;
    set_values(&world, values, TETCAST_POINT);
    const bool lit = i % 6 == 5, of_cells = i & 1;
    TetcastShadingDesc shading = tetcast_shading_desc_default();
    shading.shade = lit ? TETCAST_SHADE_VOLUME : TETCAST_SHADE_NONE; /* the surface has its colour as it is */
    shading.lights = light;
    shading.light_count = 1;
    assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
    Reference r = {.cube = &world.cube,
                   .values = values,
                   .matter = rows,
                   .rows = i % 4 == 3 ? 1 : 3,
                   .row_at = at,
                   .second = of_cells ? second : NULL,
                   .shading = lit ? &shading : NULL};
    if (i % 3 == 0) {
      r.surface = &surface;
      assert_int_equal(tetcast_scene_set_isosurfaces(world.scene, &surface, 1), TETCAST_OK);
    }
    if (r.rows == 1)
      r.matter = rows + 1;
    TetcastTransferRow list[3];
    for (int j = 0; j < r.rows; ++j)
      list[j] = (TetcastTransferRow){.at = at[j], .transfer_function = transfer_of_matter(&world, &r.matter[j])};
    TetcastField *field =
        of_cells ? field_of(world.fixture.context, second, world.cube.cell_count, TETCAST_CELL) : NULL;
    assert_int_equal(tetcast_scene_set_transfer_rows(world.scene, list, r.rows, field), TETCAST_OK);
    tetcast_field_destroy(&field);
    r.gradients = vertex_gradients(r.cube, r.values);
    const TetcastCamera *camera = &cameras[i % 2];
    double(*lights)[6] = vertex_lights(&r, camera), *pixels = shoot(&world, camera, W, H, 0),
    *loose = shoot(&world, camera, W, H, 1e-3);
    int compared = 0;
    for (int p = 0; p < PIXELS; ++p) {
      Real wanted[4];
      if (!trace(&r, camera, p, (const double(*)[6])lights, wanted))
        continue;
      ++compared;
      for (int k = 0; k < 4; ++k) {
        const double got = pixels[4 * p + k];
        if (!(fabsl(got - wanted[k]) <= 1e-13))
          fail_msg("world %d, pixel %d, channel %d: %.17g, not %.17Lg", i, p, k, got, wanted[k]);
        if (!(fabsl(loose[4 * p + k] - wanted[k]) <= 1e-3))
          fail_msg("world %d, pixel %d, channel %d: %.17g within 1e-3, not %.17Lg", i, p, k, loose[4 * p + k],
                   wanted[k]);
      }
    }
    assert_true(compared > PIXELS * 9 / 10);
    for (int j = 0; j < r.rows; ++j)
      tetcast_transfer_function_destroy((TetcastTransferFunction **)(void *)&list[j].transfer_function);
    free(pixels);
    free(loose);
    free(lights);
    free(r.gradients);
    free(values);
    free(second);
    world_end(&world);
  }
}

/* ── what is refused ── */

static void what_can_not_be_lit_is_refused(void **state) {
  (void)state;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.occlusion_rays = 4097;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_ERROR_ARGUMENT);
  shading.occlusion_rays = 0;
  shading.shadows = 2;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_ERROR_ARGUMENT);
  shading.shadows = 0;
  shading.shade = (TetcastShade)4;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_ERROR_ARGUMENT);
  shading.shade = TETCAST_SHADE_VOLUME;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  double *values = calloc((size_t)world.cube.cell_count * 4, sizeof *values);
  static const struct {
    TetcastAssociation association;
    TetcastBlend blend;
    TetcastIntegrator integrator;
    uint32_t channels;
    const char *word;
  } cases[] = {{TETCAST_CELL, TETCAST_BLEND_COMPOSITE, TETCAST_INTEGRATOR_EXACT, 0, "a field of points"},
               {TETCAST_CORNER, TETCAST_BLEND_COMPOSITE, TETCAST_INTEGRATOR_EXACT, 0, "a field of points"},
               {TETCAST_POINT, TETCAST_BLEND_MAXIMUM, TETCAST_INTEGRATOR_EXACT, 0, "blend mode"},
               {TETCAST_POINT, TETCAST_BLEND_COMPOSITE, TETCAST_INTEGRATOR_GAUSS, 0, "exact integrator"},
               {TETCAST_POINT, TETCAST_BLEND_COMPOSITE, TETCAST_INTEGRATOR_EXACT, TETCAST_CHANNEL_ERROR, "error"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    set_values(&world, values, cases[i].association);
    set_matter(&world, &thin);
    assert_int_equal(tetcast_scene_set_blend(world.scene, cases[i].blend), TETCAST_OK);
    TetcastFrameDesc desc = tetcast_frame_desc_default();
    desc.width = desc.height = 4;
    desc.channels = cases[i].channels;
    TetcastFrame *frame = NULL;
    assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &frame), TETCAST_OK);
    TetcastRenderDesc render = render_desc();
    render.integrator = cases[i].integrator;
    render.integrator_n = 2;
    assert_int_equal(tetcast_scene_render(world.scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
    assert_non_null(strstr(world.fixture.message, cases[i].word));
    tetcast_frame_destroy(&frame);
  }
  free(values);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pictures_are_as_brute_force_has_them),
      cmocka_unit_test(plain_light_changes_nothing),
      cmocka_unit_test(shadows_are_of_second_order),
      cmocka_unit_test(ambient_light_comes_from_all_sides),
      cmocka_unit_test(shadows_are_made_anew),
      cmocka_unit_test(what_can_not_be_lit_is_refused),
      cmocka_unit_test(two_dimensions_are_as_brute_force_has_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
