/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurfaces: where they lie against the closed form of a linear field's; pictures against brute force over all cells
 * in extended precision, light included; that each crossing is found once and only once, with values that are those of
 * vertices; and what the library says where it can't. TETCAST_ISOSURFACE_RAYS sets how many rays are counted along
 * (default 400,000; the long run is 1e7). */
#include "brute.h"

enum { W = 41, H = 33, PIXELS = W * H };

static void set_surfaces(World *world, const TetcastIsosurface *list, int count) {
  assert_int_equal(tetcast_scene_set_isosurfaces(world->scene, list, count), TETCAST_OK);
}

static void set_shade(World *world, TetcastShade shade, TetcastNormals normals, const TetcastLight *lights, int count) {
  TetcastShadingDesc desc = tetcast_shading_desc_default();
  desc.shade = shade;
  desc.normals = normals;
  desc.lights = lights;
  desc.light_count = count;
  assert_int_equal(tetcast_scene_set_shading(world->scene, &desc), TETCAST_OK);
}

/* The extinction low at 0 and high at 1, linear between them and beyond, of one colour. */
static void set_fog(World *world, double low, double high, const double color[3]) {
  const double colors[4] = {0, color[0], color[1], color[2]}, extinction[4] = {0, low, 1, high};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = colors;
  desc.color_count = 1;
  desc.extinction = extinction;
  desc.extinction_count = 2;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(world->fixture.context, &desc, &transfer), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

static TetcastFrame *shoot(World *world, const TetcastCamera *camera, int width, int height, double tolerance) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.channels = TETCAST_CHANNEL_DEPTH;
  desc.width = width;
  desc.height = height;
  TetcastFrame *frame = NULL;
  TetcastRenderDesc render = render_desc();
  TetcastRenderStats stats;
  render.tolerance = tolerance;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, camera, &render, frame, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  return frame;
}

static const double *pixels_of(const TetcastFrame *frame) {
  return tetcast_frame_pixels(frame);
}

static double depth_of(const TetcastFrame *frame, int pixel) {
  return ((const double *)tetcast_frame_channel(frame, TETCAST_CHANNEL_DEPTH))[pixel];
}

static double by_x(const double p[3]) {
  return p[0];
}
static double slanted(const double p[3]) {
  return 0.3 + 0.7 * p[0] - 0.9 * p[1] + 0.4 * p[2];
}

static void set_function(World *world, double (*of)(const double p[3])) {
  double *values = malloc((size_t)world->cube.vertex_count * sizeof *values);
  for (int64_t i = 0; i < world->cube.vertex_count; ++i)
    values[i] = of(&world->cube.vertices[3 * i]);
  set_values(world, values, TETCAST_POINT);
  free(values);
}

/* ── closed forms ── */

/* The part of a ray in the unit cube, from the eye on; false: there is none. */
static bool chord(const double eye[3], const double direction[3], double *from, double *to) {
  *from = 0;
  *to = INFINITY;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (!(eye[k] > 0 && eye[k] < 1))
        return false;
      continue;
    }
    const double a = (0 - eye[k]) / direction[k], b = (1 - eye[k]) / direction[k];
    *from = fmax(*from, fmin(a, b));
    *to = fmin(*to, fmax(a, b));
  }
  return *to > *from;
}

/* In a linear field isosurfaces are planes, whatever the cells are: with a fog of one colour, how deep an opaque one
 * lies is −log of what the fog leaves of it. Values are those of vertices, and rays go through vertices, along edges
 * and within faces, outside and inside. */
static void planes_lie_where_they_should(void **state) {
  (void)state;
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0),
                                   parallel(3, 2, 4, 1.6), parallel(4, 0.5, 0.5, H / 32.0),
                                   parallel(-4, 0.5, 0.5, H / 32.0)};
  static const double fog[3] = {0.125, 0.5, 0.25}, value = 0.5;
  static const TetcastIsosurface surface = {.value = 0.5, .color = {1, 0, 0.25}, .opacity = 1};
  for (int i = 0; i < 8; ++i) {
    double (*const field)(const double p[3]) = i & 1 ? slanted : by_x;
    World world;
    world_begin(&world, 4, i & 2 ? 0.6 : 0, 1, i & 4 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    set_function(&world, field);
    set_fog(&world, 0.5, 0.5, fog);
    set_shade(&world, TETCAST_SHADE_NONE, TETCAST_NORMALS_SMOOTH, NULL, 0);
    set_surfaces(&world, &surface, 1);
    for (size_t c = 0; c < sizeof cameras / sizeof *cameras; ++c) {
      TetcastFrame *frame = shoot(&world, &cameras[c], W, H, 0);
      int met = 0;
      for (int p = 0; p < PIXELS; ++p) {
        double eye[3], direction[3], from, to;
        ray_of(&cameras[c], W, H, p, eye, direction);
        if (!chord(eye, direction, &from, &to) || to - from < 1e-9)
          continue;
        const double zero[3] = {0, 0, 0}, slope = field(direction) - field(zero);
        const double at = (value - field(eye)) / slope;
        if (fabs(slope) < 1e-9 || fabs(at - from) < 1e-9 || fabs(at - to) < 1e-9)
          continue;
        const bool meets = at > from && at < to;
        const double length = (meets ? at : to) - from, left = exp(-0.5 * length), *rgba = pixels_of(frame) + 4 * p;
        for (int k = 0; k < 3; ++k) {
          const double wanted = fog[k] * -expm1(-0.5 * length) + (meets ? left * surface.color[k] : 0);
          if (!(fabs(rgba[k] - wanted) <= 1e-13))
            fail_msg("camera %zu, field %d, pixel %d: %.17g, not %.17g", c, i, p, rgba[k], wanted);
        }
        const double fog_half = log(2) / 0.5, depth = depth_of(frame, p);
        const double half = fog_half < length ? from + fog_half : meets ? at : INFINITY;
        if (!(depth == half || fabs(depth - half) <= 4e-14) && fabs(fog_half - length) > 1e-12)
          fail_msg("camera %zu, field %d, pixel %d: depth %.17g, not %.17g", c, i, p, depth, half);
        assert_true(fabs(rgba[3] - (meets ? 1 : -expm1(-0.5 * length))) <= 1e-14);
        met += meets;
      }
      assert_true(met > PIXELS / 30);
      tetcast_frame_destroy(&frame);
    }
    world_end(&world);
  }
}

/* ── brute force ── */

/* What lies along a ray: a stretch of fog, or a surface if its length is 0. */
typedef struct Event {
  Real begin, length, depth, color[3], opacity;
  Real ends[2]; /* the extinction at both */
} Event;

static int by_begin(const void *a, const void *b) {
  const Event *x = a, *y = b;
  const Real s = x->begin + x->length / 2, t = y->begin + y->length / 2;
  return s < t ? -1 : s > t;
}

/* The scene that brute force is to make a picture of. */
typedef struct Reference {
  const Cube *cube;
  const double *values;
  const TetcastIsosurface *surfaces;
  int count;
  double low, high, fog[3];
  const TetcastSlice *slices;
  int slice_count;
  const TetcastBoundary *boundary; /* NULL: not seen */
  double colors[2][3];             /* of slices and of the boundary: at 0 and at 1, linear between them */
  const TetcastShadingDesc *shading;
  Real (*gradients)[3]; /* [vertices] */
} Reference;

/* The gradient at a point of a cell: its own, or those of its vertices weighted by the parts that the point cuts it
 * into. */
static void gradient_at(const Reference *r, int64_t cell, const Linear *linear, const Real point[3], Real g[3]) {
  if (r->shading->normals == TETCAST_NORMALS_FLAT) {
    memcpy(g, linear->gradient, 3 * sizeof *g);
    return;
  }
  const int64_t *id = &r->cube->cells[4 * cell];
  Real corner[4][3], part[4], all = 0;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 3; ++k)
        corner[i][k] = (i == j ? point[k] : (Real)r->cube->vertices[3 * id[i] + k]);
    }
    Real e[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k)
        e[i][k] = corner[i + 1][k] - corner[0][k];
    }
    part[j] = DET(e[0], e[1], e[2]);
    all += part[j];
  }
  for (int k = 0; k < 3; ++k) {
    g[k] = 0;
    for (int j = 0; j < 4; ++j)
      g[k] += part[j] / all * r->gradients[id[j]][k];
  }
}

static void color_at(const Reference *r, Real value, Real color[3]) {
  for (int k = 0; k < 3; ++k)
    color[k] = r->colors[0][k] + (r->colors[1][k] - r->colors[0][k]) * value;
}

/* The cube's faces where the ray enters and leaves it, with the linear field `slanted`. */
static int add_boundary(const Reference *r, const double eye[3], const double direction[3], Event *events, int count) {
  for (int end = 0; end < 2; ++end) {
    Real at = end ? INFINITY : 0, normal[3] = {0, 0, 0};
    int side = -1;
    for (int k = 0; k < 3; ++k) {
      const Real a = (0 - (Real)eye[k]) / direction[k], b = (1 - (Real)eye[k]) / direction[k];
      const Real t = end ? fmaxl(a, b) : fminl(a, b);
      if (end ? t < at : t > at)
        at = t, side = k;
    }
    if (side < 0)
      continue; /* the eye is inside */
    double point[3];
    for (int k = 0; k < 3; ++k)
      point[k] = (double)(eye[k] + at * direction[k]);
    normal[side] = direction[side] > 0 ? -1 : 1;
    Event *event = &events[count++];
    *event = (Event){.begin = at, .opacity = r->boundary->opacity};
    color_at(r, slanted(point), event->color);
    for (int k = 0; k < 3 && r->boundary->colored; ++k)
      event->color[k] = r->boundary->color[k];
    if (r->shading->shade)
      light_up(r->shading, normal, direction, event->color);
  }
  return count;
}

/* Where alpha exceeds one half in a stretch of fog, by bisection, or at a surface; infinite: it doesn't. `left` is the
 * transmittance before it. */
static Real half_depth(const Event *event, Real left) {
  if (event->length == 0)
    return event->opacity >= 0.5L || left * (1 - event->opacity) < 0.5L ? event->begin : INFINITY;
  Real low = 0, high = 1;
  if (!(left * expl(-event->depth) < 0.5L))
    return INFINITY;
  for (int i = 0; i < 80; ++i) {
    const Real u = (low + high) / 2,
               depth = event->length * u * (event->ends[0] + (event->ends[1] - event->ends[0]) * u / 2);
    if (left * expl(-depth) < 0.5L)
      high = u;
    else
      low = u;
  }
  return event->begin + high * event->length;
}

/* The pixel; false: rounding decides what the ray meets. */
static bool trace(const Reference *r, const double eye[3], const double direction[3], Real rgba[4], Real *half) {
  Event events[4096];
  int count = 0;
  for (int64_t cell = 0; cell < r->cube->cell_count; ++cell) {
    Real from, to, volume;
    if (!cross_cell(r->cube, cell, eye, direction, &from, &to))
      continue;
    const Linear linear = linear_of(r->cube, cell, r->values, &volume);
    const Real a = value_at(&linear, eye, direction, from), b = value_at(&linear, eye, direction, to);
    if (isnan(a) || isnan(b))
      continue;
    if (to - from < 1e-10L)
      return false;
    Event cuts[32]; /* what is met in the cell */
    int cut_count = 0;
    for (int i = 0; i < r->count; ++i) {
      const TetcastIsosurface *surface = &r->surfaces[i];
      if (fabsl(a - surface->value) < 1e-12L || fabsl(b - surface->value) < 1e-12L)
        return false;
      if ((a >= surface->value) == (b >= surface->value))
        continue;
      Event *cut = &cuts[cut_count++];
      *cut = (Event){.begin = from + (to - from) * (surface->value - a) / (b - a), .opacity = surface->opacity};
      for (int k = 0; k < 3; ++k)
        cut->color[k] = surface->color[k];
      if (r->shading->shade) {
        Real point[3], normal[3];
        for (int k = 0; k < 3; ++k)
          point[k] = eye[k] + cut->begin * direction[k];
        gradient_at(r, cell, &linear, point, normal);
        for (int k = 0; k < 3 && a < b; ++k)
          normal[k] = -normal[k];
        light_up(r->shading, normal, direction, cut->color);
      }
    }
    for (int i = 0; i < r->slice_count; ++i) {
      const TetcastSlice *slice = &r->slices[i];
      Real along = 0, at = slice->offset;
      for (int k = 0; k < 3; ++k)
        at -= (Real)slice->normal[k] * eye[k], along += (Real)slice->normal[k] * direction[k];
      at /= along;
      if (fabsl(at - from) < 1e-12L || fabsl(at - to) < 1e-12L)
        return false;
      if (!(at > from && at < to))
        continue;
      Event *cut = &cuts[cut_count++];
      *cut = (Event){.begin = at, .opacity = slice->opacity};
      color_at(r, value_at(&linear, eye, direction, at), cut->color);
    }
    qsort(cuts, (size_t)cut_count, sizeof *cuts, by_begin);
    Real done = from;
    for (int i = 0; i <= cut_count; ++i) {
      const Real at = i < cut_count ? cuts[i].begin : to, middle = value_at(&linear, eye, direction, (done + at) / 2);
      const Real a_done = value_at(&linear, eye, direction, done), a_at = value_at(&linear, eye, direction, at);
      events[count++] = (Event){.begin = done,
                                .length = at - done,
                                .depth = (r->low + (r->high - r->low) * middle) * (at - done),
                                .ends = {r->low + (r->high - r->low) * a_done, r->low + (r->high - r->low) * a_at}};
      if (i < cut_count)
        events[count++] = cuts[i];
      done = at;
    }
    assert_true(count < 4000);
  }
  if (r->boundary)
    count = add_boundary(r, eye, direction, events, count);
  qsort(events, (size_t)count, sizeof *events, by_begin);
  Real left = 1;
  memset(rgba, 0, 4 * sizeof *rgba);
  *half = INFINITY;
  for (int i = 0; i < count; ++i) {
    if (isinf(*half))
      *half = half_depth(&events[i], left);
    const Real opacity = events[i].length > 0 ? -expm1l(-events[i].depth) : events[i].opacity;
    for (int k = 0; k < 3; ++k)
      rgba[k] += left * opacity * (events[i].length > 0 ? r->fog[k] : events[i].color[k]);
    left *= 1 - opacity;
  }
  rgba[3] = 1 - left;
  return true;
}

/* Several surfaces, half-transparent, lit in all ways, in a fog that is thicker here than there; cells with NaN among
 * them. Interpolated normals come from single precision, and highlights raise what they are off by to a power. */
static void pictures_are_as_brute_force_has_them(void **state) {
  (void)state;
  static const TetcastIsosurface surfaces[] = {{.value = 0.2, .color = {1, 0, 0.25}, .opacity = 0.5},
                                               {.value = 0.45, .color = {0, 1, 0.5}, .opacity = 0.25},
                                               {.value = 0.45 + 0x1p-40, .color = {0.5, 0.5, 1}, .opacity = 0.125},
                                               {.value = 0.7, .color = {0.25, 0.25, 0.5}, .opacity = 1}};
  static const TetcastLight lights[] = {{.direction = {1, 2, 3}, .color = {1, 0.5, 0.25}},
                                        {.direction = {-40, 1, 0}, .color = {0.125, 0.25, 1}}};
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0),
                                   parallel(3, 2, 4, 1.6)};
  for (int i = 0; i < 12; ++i) {
    World world;
    world_begin(&world, 5, 0.6, 1, i % 2 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.vertex_count; ++j)
      values[j] = i / 4 == 1 && j % 40 == 3 ? (double)NAN : world.cube.values[j];
    set_values(&world, values, TETCAST_POINT);
    TetcastShadingDesc shading = tetcast_shading_desc_default();
    shading.shade = i % 3 ? TETCAST_SHADE_SURFACES : TETCAST_SHADE_NONE;
    shading.normals = i % 3 == 1 ? TETCAST_NORMALS_FLAT : TETCAST_NORMALS_SMOOTH;
    shading.lights = lights;
    shading.light_count = i / 4 == 2 ? 2 : 0;
    assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
    const double tolerance = i % 3 == 2 ? 2e-5 : 1e-13;
    Reference r = {.cube = &world.cube, .values = values, .surfaces = surfaces, .count = 4, .shading = &shading};
    if (i % 4 < 2) {
      r.low = 0.5, r.high = 1.5, r.fog[0] = 0.25, r.fog[1] = 0.5, r.fog[2] = 1;
      set_fog(&world, r.low, r.high, r.fog);
    } else {
      set_fog(&world, 0, 0, r.fog);
    }
    r.gradients = vertex_gradients(r.cube, r.values);
    set_surfaces(&world, surfaces, 4);
    const TetcastCamera *camera = &cameras[i % 3];
    TetcastFrame *frame = shoot(&world, camera, W, H, 0);
    int compared = 0, met = 0;
    for (int p = 0; p < PIXELS; ++p) {
      double eye[3], direction[3];
      Real wanted[4], half;
      ray_of(camera, W, H, p, eye, direction);
      if (!trace(&r, eye, direction, wanted, &half))
        continue;
      ++compared;
      const double seen = depth_of(frame, p);
      if (!(seen == half || fabsl(seen - half) <= 1e-12L))
        fail_msg("world %d, pixel %d: depth %.17g, not %.17Lg", i, p, seen, half);
      for (int k = 0; k < 4; ++k) {
        const double got = pixels_of(frame)[4 * p + k];
        if (!(fabsl(got - wanted[k]) <= (k == 3 ? 1e-13 : tolerance)))
          fail_msg("world %d, pixel %d, channel %d: %.17g, not %.17Lg", i, p, k, got, wanted[k]);
      }
      met += wanted[3] == 1;
    }
    assert_true(compared > PIXELS * 9 / 10 && met > PIXELS / 50);
    tetcast_frame_destroy(&frame);
    free(r.gradients);
    free(values);
    world_end(&world);
  }
}

/* Slices and the boundary in the colours of the scalar, with isosurfaces between them; the field is linear, so that the
 * boundary's values are known. A slice in one of the cube's sides is left to rounding. */
static void slices_and_the_boundary_as_well(void **state) {
  (void)state;
  static const TetcastIsosurface surfaces[] = {{.value = 0.25, .color = {1, 0, 0.25}, .opacity = 0.5}};
  static const TetcastSlice slices[] = {{.normal = {0, 0, -3}, .offset = -0.9, .opacity = 0.5},
                                        {.normal = {1, 2, 0.5}, .offset = 1.6, .opacity = 0.75},
                                        {.normal = {1, 0, 0}, .offset = 7, .opacity = 1}};
  static const TetcastBoundary boundaries[] = {{.opacity = 0.25}, {.opacity = 0.5, .colored = 1, .color = {0, 0.5, 1}}};
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0),
                                   parallel(3, 2, 4, 1.6)};
  for (int i = 0; i < 12; ++i) {
    World world;
    world_begin(&world, 5, 0.6, 1, i % 4 == 3 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.vertex_count; ++j)
      values[j] = slanted(&world.cube.vertices[3 * j]);
    set_values(&world, values, TETCAST_POINT);
    TetcastShadingDesc shading = tetcast_shading_desc_default();
    shading.shade = i % 2 ? TETCAST_SHADE_SURFACES : TETCAST_SHADE_NONE;
    shading.normals = TETCAST_NORMALS_FLAT;
    assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
    Reference r = {.cube = &world.cube,
                   .values = values,
                   .surfaces = surfaces,
                   .count = i / 4 == 1 ? 0 : 1,
                   .shading = &shading,
                   .slices = slices,
                   .slice_count = i / 4 == 2 ? 0 : 3,
                   .boundary = i % 4 == 3 ? NULL : &boundaries[i % 2],
                   .colors = {{0.75, 0.25, 0.5}, {0.25, 0.5, 1}}};
    static const double fog[3] = {0.25, 0.5, 0.125};
    double knots[2][4] = {{-1, 0, 0, 0}, {2, 0, 0, 0}};
    for (int k = 0; k < 3; ++k) { /* linear over all values there are, and no less than 0 */
      r.colors[1][k] = r.colors[0][k] + 0.25 * (k - 1);
      knots[0][1 + k] = 2 * r.colors[0][k] - r.colors[1][k];
      knots[1][1 + k] = 2 * r.colors[1][k] - r.colors[0][k];
    }
    if (i >= 8) { /* a fog needs one colour */
      for (int k = 0; k < 3; ++k)
        r.fog[k] = r.colors[0][k] = r.colors[1][k] = knots[0][1 + k] = knots[1][1 + k] = fog[k];
      r.low = 0.5;
      r.high = 0.75;
    }
    const double extinction[2][2] = {{-1, 2 * r.low - r.high}, {2, 2 * r.high - r.low}};
    TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
    desc.color = knots[0];
    desc.color_count = 2;
    desc.extinction = extinction[0];
    desc.extinction_count = 2;
    TetcastTransferFunction *transfer = NULL;
    assert_int_equal(tetcast_transfer_function_create(world.fixture.context, &desc, &transfer), TETCAST_OK);
    assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
    tetcast_transfer_function_destroy(&transfer);
    set_surfaces(&world, surfaces, r.count);
    assert_int_equal(tetcast_scene_set_slices(world.scene, slices, r.slice_count), TETCAST_OK);
    assert_int_equal(tetcast_scene_set_boundary(world.scene, r.boundary), TETCAST_OK);
    const TetcastCamera *camera = &cameras[i % 3];
    TetcastFrame *frame = shoot(&world, camera, W, H, 0), *loose = shoot(&world, camera, W, H, 1e-3);
    for (int p = 0; p < 4 * PIXELS; ++p)
      assert_true(fabs(pixels_of(frame)[p] - pixels_of(loose)[p]) <= 1e-3);
    tetcast_frame_destroy(&loose);
    int compared = 0;
    for (int p = 0; p < PIXELS; ++p) {
      double eye[3], direction[3], begin, end;
      Real wanted[4], half;
      ray_of(camera, W, H, p, eye, direction);
      if (!chord(eye, direction, &begin, &end) || end - begin < 1e-9 || !trace(&r, eye, direction, wanted, &half))
        continue;
      ++compared;
      const double seen = depth_of(frame, p);
      if (!(seen == half || fabsl(seen - half) <= 1e-12L))
        fail_msg("world %d, pixel %d: depth %.17g, not %.17Lg", i, p, seen, half);
      for (int k = 0; k < 4; ++k) {
        const double got = pixels_of(frame)[4 * p + k];
        if (!(fabsl(got - wanted[k]) <= 1e-13))
          fail_msg("world %d, pixel %d, channel %d: %.17g, not %.17Lg", i, p, k, got, wanted[k]);
      }
    }
    assert_true(compared > PIXELS / 8);
    tetcast_frame_destroy(&frame);
    free(values);
    world_end(&world);
  }
}

/* A slice closes the clip that has its plane, to the last pixel: rays that begin there begin on it. Cells have their
 * own colours on it. */
static void a_slice_closes_a_clip(void **state) {
  (void)state;
  static const TetcastSlice slice = {.normal = {1, -2, 0.7}, .offset = -0.13, .opacity = 1};
  static const TetcastHalfSpace half_spaces[] = {{.normal = {1, -2, 0.7}, .offset = -0.13},
                                                 {.normal = {-1, 2, -0.7}, .offset = 0.13}};
  const TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), parallel(3, 2, 4, 1.6),
                                   camera_of(-2.1, -1.7, 0.5, 0.5, 0.5, 0.5)};
  for (int i = 0; i < 12; ++i) {
    World world;
    world_begin(&world, 5, 0.6, 1, i / 6 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    double *values = malloc((size_t)world.cube.cell_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.cell_count; ++j)
      values[j] = 0.25 * (double)(j % 5);
    set_values(&world, values, TETCAST_CELL);
    static const double knots[2][4] = {{0, 0, 1, 0.5}, {1, 1, 0, 0.5}}, nothing[2] = {0, 0};
    TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
    desc.color = knots[0];
    desc.color_count = 2;
    desc.extinction = nothing;
    desc.extinction_count = 1;
    TetcastTransferFunction *transfer = NULL;
    assert_int_equal(tetcast_transfer_function_create(world.fixture.context, &desc, &transfer), TETCAST_OK);
    assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
    tetcast_transfer_function_destroy(&transfer);
    assert_int_equal(tetcast_scene_set_slices(world.scene, &slice, 1), TETCAST_OK);
    const TetcastCamera *camera = &cameras[i % 3];
    TetcastFrame *whole = shoot(&world, camera, W, H, 0);
    assert_int_equal(tetcast_scene_set_clip(world.scene, &half_spaces[i / 3 % 2], 1), TETCAST_OK);
    TetcastFrame *clipped = shoot(&world, camera, W, H, 0);
    int met = 0;
    for (int p = 0; p < PIXELS; ++p) {
      const double *rgba = pixels_of(whole) + 4 * p;
      met += rgba[3] == 1;
      assert_true(rgba[3] == 0 || (rgba[3] == 1 && fabs(4 * rgba[0] - rint(4 * rgba[0])) < 1e-14));
      assert_memory_equal(rgba, pixels_of(clipped) + 4 * p, 4 * sizeof(double));
    }
    if (met <= PIXELS / 50)
      fail_msg("world %d: %d pixels", i, met);
    tetcast_frame_destroy(&whole);
    tetcast_frame_destroy(&clipped);
    free(values);
    world_end(&world);
  }
}

/* ── each crossing once ── */

/* How many half-transparent surfaces a pixel has, exactly. */
static int crossings(double alpha) {
  const double count = -log2(1 - alpha);
  assert_true(count == rint(count) && count < 50);
  return (int)count;
}

/* A field that is 0, V or 2 V at vertices, at random, V being the isosurface's, and the same everywhere at the
 * boundary: from outside to outside each ray crosses it an even number of times. Rays hit vertices, edges and faces. */
static void crossings_are_even_from_outside(void **state) {
  (void)state;
  const char *wanted = getenv("TETCAST_ISOSURFACE_RAYS");
  const int64_t all = wanted ? atoll(wanted) : 400000;
  const TetcastCamera cameras[] = {parallel(0.5, 0.5, 4, 1),
                                   parallel(4, 0.5, 0.5, 1),
                                   parallel(3.5, 3.5, 3.5, 1.6),
                                   parallel(0.5, 3.5, 3.5, 1.3),
                                   camera_of(0.5, 0.5, 3, 0.5, 0.5, 0.5),
                                   camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5)};
  enum { SIDE = 129, CAMERAS = sizeof cameras / sizeof *cameras };
  static const TetcastIsosurface surface = {.value = 0.25, .color = {1, 1, 1}, .opacity = 0.5};
  uint64_t seed = 11;
  int64_t rays = 0, met = 0;
  for (int i = 0; rays < all; ++i) {
    World world;
    const int n = 8;
    world_begin(&world, n, i % 4 == 3 ? 0.6 : 0, 1, i % 8 == 5 ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    const double boundary = 0.25 * (i % 3);
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.vertex_count; ++j) {
      const double *p = &world.cube.vertices[3 * j];
      bool inside = true;
      for (int k = 0; k < 3; ++k)
        inside = inside && p[k] > 0 && p[k] < 1;
      values[j] = inside ? 0.25 * floor(3 * uniform(&seed)) : boundary;
    }
    set_values(&world, values, TETCAST_POINT);
    set_shade(&world, TETCAST_SHADE_NONE, TETCAST_NORMALS_FLAT, NULL, 0);
    set_surfaces(&world, &surface, 1);
    for (int c = 0; c < CAMERAS; ++c) {
      TetcastFrame *frame = shoot(&world, &cameras[c], SIDE, SIDE, 0);
      for (int p = 0; p < SIDE * SIDE; ++p) {
        const int count = crossings(pixels_of(frame)[4 * p + 3]);
        if (count % 2 != 0)
          fail_msg("world %d, camera %d, pixel %d: %d crossings", i, c, p, count);
        met += count > 0;
      }
      rays += SIDE * SIDE;
      tetcast_frame_destroy(&frame);
    }
    free(values);
    world_end(&world);
  }
  assert_true(met > rays / 20);
}

/* ── the rest ── */

/* Where all of it has the value there is no surface; the sides of one that has it in one layer of vertices are one and
 * the same, seen from either side. */
static void constant_cells_are_no_surface(void **state) {
  (void)state;
  static const TetcastIsosurface surface = {.value = 0.5, .color = {1, 1, 1}, .opacity = 0.5};
  const TetcastCamera cameras[] = {parallel(4, 0.5, 0.5, 1.07), parallel(-4, 0.5, 0.5, 1.07)};
  World world;
  world_begin(&world, 4, 0, 1, TETCAST_TRAVERSAL_SHELL);
  double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
  for (int way = 0; way < 4; ++way) { /* all of it, a slab, a layer above others, a layer below others */
    for (int64_t j = 0; j < world.cube.vertex_count; ++j) {
      const double x = world.cube.vertices[3 * j], step = way == 1 ? x >= 0.25 && x <= 0.75 : x == 0.5;
      values[j] = way == 0 ? 0.5 : way == 3 ? 1 - 0.5 * step : 0.5 * step;
    }
    set_values(&world, values, TETCAST_POINT);
    set_surfaces(&world, &surface, 1);
    for (int c = 0; c < 2; ++c) {
      TetcastFrame *frame = shoot(&world, &cameras[c], W, H, 0);
      for (int p = 0; p < PIXELS; ++p) {
        double eye[3], direction[3], from, to;
        ray_of(&cameras[c], W, H, p, eye, direction);
        const double alpha = pixels_of(frame)[4 * p + 3];
        if (chord(eye, direction, &from, &to))
          assert_int_equal(crossings(alpha), way == 1 || way == 2 ? 2 : 0);
        else
          assert_true(alpha == 0);
      }
      tetcast_frame_destroy(&frame);
    }
  }
  free(values);
  world_end(&world);
}

/* Cells in which no surface lies are passed; that they are changes nothing but the time. */
static void what_is_passed_is_empty(void **state) {
  (void)state;
  static const double none[3] = {0, 0, 0};
  static const TetcastIsosurface surfaces[] = {{.value = 0.1, .color = {1, 0.5, 0.25}, .opacity = 0.5},
                                               {.value = 0.9, .color = {0.25, 0.5, 1}, .opacity = 0.5}};
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 24, 0.6, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  set_surfaces(&world, surfaces, 2);
  TetcastFrame *alone = shoot(&world, &camera, W, H, 0), *loose = shoot(&world, &camera, W, H, 0.01);
  set_fog(&world, 0x1p-1000, 0x1p-1000, none);
  TetcastFrame *all = shoot(&world, &camera, W, H, 0);
  int seen = 0;
  for (int i = 0; i < 4 * PIXELS; ++i) {
    seen += pixels_of(alone)[i] > 0;
    assert_true(fabs(pixels_of(alone)[i] - pixels_of(all)[i]) <= 1e-13);
    assert_true(fabs(pixels_of(alone)[i] - pixels_of(loose)[i]) <= 0.01);
  }
  assert_true(seen > PIXELS / 20);
  tetcast_frame_destroy(&alone);
  tetcast_frame_destroy(&loose);
  tetcast_frame_destroy(&all);
  world_end(&world);
}

/* Fields of corners have surfaces in their cells; what jumps over the value from cell to cell is none. */
static void jumps_are_no_surface(void **state) {
  (void)state;
  static const TetcastIsosurface surface = {.value = 0.5, .color = {1, 1, 1}, .opacity = 0.5};
  const TetcastCamera camera = parallel(3, 2, 4, 1.6);
  for (int traversal = 0; traversal < 2; ++traversal) {
    World world;
    world_begin(&world, 4, 0.6, 1, (TetcastTraversal)traversal);
    set_surfaces(&world, &surface, 1);
    set_shade(&world, TETCAST_SHADE_SURFACES, TETCAST_NORMALS_FLAT, NULL, 0);
    set_function(&world, slanted);
    TetcastFrame *points = shoot(&world, &camera, W, H, 0);
    double *values = malloc(4 * (size_t)world.cube.cell_count * sizeof *values);
    for (int64_t j = 0; j < 4 * world.cube.cell_count; ++j)
      values[j] = slanted(&world.cube.vertices[3 * world.cube.cells[j]]);
    set_values(&world, values, TETCAST_CORNER);
    TetcastFrame *corners = shoot(&world, &camera, W, H, 0);
    for (int p = 0; p < 4 * PIXELS; ++p)
      assert_true(fabs(pixels_of(points)[p] - pixels_of(corners)[p]) <= 1e-13);
    for (int64_t j = 0; j < 4 * world.cube.cell_count; ++j)
      values[j] = (double)(j / 4 % 2);
    set_values(&world, values, TETCAST_CORNER);
    TetcastFrame *jumps = shoot(&world, &camera, W, H, 0);
    for (int p = 0; p < PIXELS; ++p)
      assert_true(pixels_of(jumps)[4 * p + 3] == 0);
    free(values);
    tetcast_frame_destroy(&points);
    tetcast_frame_destroy(&corners);
    tetcast_frame_destroy(&jumps);
    world_end(&world);
  }
}

/* Powers of two as units of length and of values change no bit of the picture. */
static void units_change_no_bit(void **state) {
  (void)state;
  static const int lengths[] = {0, 40, -300, 480}, units[] = {0, -700, 900, 3};
  double *first = NULL;
  for (int i = 0; i < 4; ++i) {
    World world;
    const double scale = ldexp(1, lengths[i]);
    world_begin(&world, 4, 0.6, scale, TETCAST_TRAVERSAL_SHELL);
    const TetcastIsosurface surface = {.value = ldexp(0.5, units[i]), .color = {1, 0.5, 0.25}, .opacity = 0.75};
    double *values = malloc((size_t)world.cube.vertex_count * sizeof *values);
    for (int64_t j = 0; j < world.cube.vertex_count; ++j)
      values[j] = ldexp(world.cube.values[j], units[i]);
    set_values(&world, values, TETCAST_POINT);
    set_surfaces(&world, &surface, 1);
    TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
    for (int k = 0; k < 3; ++k)
      camera.eye[k] *= scale, camera.target[k] *= scale;
    TetcastFrame *frame = shoot(&world, &camera, W, H, 0);
    if (!first) {
      first = malloc(4 * PIXELS * sizeof *first);
      memcpy(first, pixels_of(frame), 4 * PIXELS * sizeof *first);
    }
    for (int p = 0; p < 4 * PIXELS; ++p)
      assert_true(fabs(pixels_of(frame)[p] - first[p]) <= 1e-6 * (p % 4 != 3));
    tetcast_frame_destroy(&frame);
    free(values);
    world_end(&world);
  }
  free(first);
}

static void refuses(World *world, const TetcastIsosurface *list, int count, const char *word) {
  assert_int_equal(tetcast_scene_set_isosurfaces(world->scene, list, count), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, word))
    fail_msg("no '%s' in: %s", word, world->fixture.message);
}

static void refuses_to_render(World *world, uint32_t channels, TetcastIntegrator integrator, const char *word) {
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = 4;
  desc.channels = channels;
  TetcastFrame *frame = NULL;
  TetcastRenderDesc render = render_desc();
  render.integrator = integrator;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, &camera, &render, frame, NULL), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, word))
    fail_msg("no '%s' in: %s", word, world->fixture.message);
  tetcast_frame_destroy(&frame);
}

static void refuses_shading(World *world, const TetcastShadingDesc *desc, const char *word) {
  assert_int_equal(tetcast_scene_set_shading(world->scene, desc), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, word))
    fail_msg("no '%s' in: %s", word, world->fixture.message);
}

static void what_is_not_possible_is_refused(void **state) {
  (void)state;
  const TetcastIntegrator exact = TETCAST_INTEGRATOR_EXACT;
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastIsosurface list[2] = {{.value = 0.5, .color = {1, 1, 1}, .opacity = 1},
                               {.value = 0.5, .color = {1, 1, 1}, .opacity = 1}};
  refuses(&world, list, 2, "two isosurfaces");
  refuses(&world, list, -1, "-1");
  refuses(&world, list, 257, "257");
  refuses(&world, NULL, 1, "NULL");
  list[1].value = NAN;
  refuses(&world, list, 2, "finite");
  list[1].value = 0.25;
  list[1].color[2] = -1;
  refuses(&world, list, 2, "colour");
  list[1].color[2] = 1;
  list[1].opacity = 1.5;
  refuses(&world, list, 2, "opacity");
  assert_int_equal(tetcast_scene_set_isosurfaces(NULL, list, 1), TETCAST_ERROR_ARGUMENT);
  set_surfaces(&world, list, 1);
  refuses_to_render(&world, 0, exact, "no field");
  double *cells = calloc((size_t)world.cube.cell_count, sizeof *cells);
  set_values(&world, cells, TETCAST_CELL);
  free(cells);
  refuses_to_render(&world, 0, exact, "points");
  set_values(&world, world.cube.values, TETCAST_POINT);
  refuses_to_render(&world, TETCAST_CHANNEL_ERROR, exact, "error");
  set_surfaces(&world, list, 0);
  refuses_to_render(&world, TETCAST_CHANNEL_DEPTH | TETCAST_CHANNEL_ERROR, exact, "depth");
  set_surfaces(&world, list, 1);
  refuses_to_render(&world, 0, TETCAST_INTEGRATOR_MIDPOINT, "exact");
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_MAXIMUM), TETCAST_OK);
  refuses_to_render(&world, 0, exact, "composite");
  refuses_to_render(&world, TETCAST_CHANNEL_DEPTH, exact, "depth");
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  TetcastLight light = {.direction = {0, 0, 0}, .color = {1, 1, 1}};
  shading.lights = &light;
  shading.light_count = 1;
  refuses_shading(&world, &shading, "0, 0, 0");
  light.direction[0] = 1;
  light.color[1] = INFINITY;
  refuses_shading(&world, &shading, "colour");
  light.color[1] = 1;
  shading.light_count = 17;
  refuses_shading(&world, &shading, "17");
  shading.light_count = 0;
  shading.exponent = 0;
  refuses_shading(&world, &shading, "exponent");
  shading.exponent = 1;
  shading.ambient = -1;
  refuses_shading(&world, &shading, "ambient");
  shading = (TetcastShadingDesc){0};
  refuses_shading(&world, &shading, "default");
  assert_int_equal(tetcast_scene_set_shading(world.scene, NULL), TETCAST_OK);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(planes_lie_where_they_should),
                                     cmocka_unit_test(pictures_are_as_brute_force_has_them),
                                     cmocka_unit_test(slices_and_the_boundary_as_well),
                                     cmocka_unit_test(a_slice_closes_a_clip),
                                     cmocka_unit_test(crossings_are_even_from_outside),
                                     cmocka_unit_test(constant_cells_are_no_surface),
                                     cmocka_unit_test(what_is_passed_is_empty),
                                     cmocka_unit_test(jumps_are_no_surface),
                                     cmocka_unit_test(units_change_no_bit),
                                     cmocka_unit_test(what_is_not_possible_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
