/* SPDX-License-Identifier: Apache-2.0 */
/* The edges of the mesh's bounding box: where they are drawn, against their points projected one by one, and what hides
 * them, against the way from the eye to these points through the box; and the edges of the boundary's triangles,
 * against those of a face seen straight on. */
#include "world.h"

enum { W = 61, H = 43, PIXELS = W * H, POINTS = 100000 };

static TetcastFrame *shoot(const World *world, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                           TetcastType type) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  frame_desc.type = type;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, camera, desc, frame, NULL), TETCAST_OK);
  return frame;
}

static void set_transfer(World *world, double extinction) {
  TetcastTransferFunction *transfer = gray_of(world->fixture.context, extinction);
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

/* ── the box ── */

/* The nearest point of an edge to the middle of a pixel. */
typedef struct Near {
  double pixels, distance; /* how far away on the screen, and from where the ray starts */
  bool hidden;             /* the way there goes through the box */
} Near;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The place of a point on the screen in pixels, and how far it is from where its ray starts; false: not ahead. */
static bool project(const TetcastCamera *camera, const double point[3], double place[2], double start[3],
                    double *distance) {
  double forward[3], right[3], up[3], away[3];
  for (int k = 0; k < 3; ++k)
    forward[k] = camera->target[k] - camera->eye[k], away[k] = point[k] - camera->eye[k];
  const double length = sqrt(dot(forward, forward));
  for (int k = 0; k < 3; ++k)
    forward[k] /= length;
  for (int k = 0; k < 3; ++k)
    right[k] = forward[(k + 1) % 3] * camera->up[(k + 2) % 3] - forward[(k + 2) % 3] * camera->up[(k + 1) % 3];
  const double wide = sqrt(dot(right, right));
  for (int k = 0; k < 3; ++k)
    right[k] /= wide;
  for (int k = 0; k < 3; ++k)
    up[k] = right[(k + 1) % 3] * forward[(k + 2) % 3] - right[(k + 2) % 3] * forward[(k + 1) % 3];
  const double z = dot(away, forward);
  const bool ortho = camera->projection == TETCAST_ORTHOGRAPHIC;
  const double half = ortho ? camera->height / 2 : tan(camera->fovy * acos(-1) / 360) * z;
  if (z < (ortho ? 0 : 1e-3))
    return false;
  place[0] = (dot(away, right) / (half * W / H) + 1) / 2 * W;
  place[1] = (1 - dot(away, up) / half) / 2 * H;
  for (int k = 0; k < 3; ++k)
    start[k] = ortho ? point[k] - z * forward[k] : camera->eye[k];
  *distance = ortho ? z : sqrt(dot(away, away));
  return true;
}

/* Whether the way between two points goes through the inside of the unit cube. */
static bool through_box(const double a[3], const double b[3]) {
  double from = 0, to = 1;
  for (int k = 0; k < 3; ++k) {
    const double d = b[k] - a[k], low = 1e-7 - a[k], high = 1 - 1e-7 - a[k];
    if (d == 0 && (low > 0 || high < 0))
      return false;
    if (d != 0)
      from = fmax(from, fmin(low / d, high / d)), to = fmin(to, fmax(low / d, high / d));
  }
  return to > from + 1e-9;
}

/* For each pixel and edge the nearest point. */
static Near *find_near(const TetcastCamera *camera) {
  Near *near = malloc(sizeof *near * 12 * PIXELS);
  for (int i = 0; i < 12 * PIXELS; ++i)
    near[i] = (Near){.pixels = INFINITY};
  for (int edge = 0; edge < 12; ++edge) {
    for (int i = 0; i <= POINTS; ++i) {
      const int k = edge / 4;
      double point[3], place[2], start[3], distance;
      point[k] = (double)i / POINTS;
      point[(k + 1) % 3] = edge & 1;
      point[(k + 2) % 3] = edge >> 1 & 1;
      if (!project(camera, point, place, start, &distance))
        continue;
      const bool hidden = through_box(start, point);
      for (int y = (int)fmax(0, fmin(H, place[1] - 2)); y < H && y < place[1] + 2; ++y) {
        for (int x = (int)fmax(0, fmin(W, place[0] - 2)); x < W && x < place[0] + 2; ++x) {
          Near *n = &near[12 * (y * W + x) + edge];
          const double pixels = hypot(place[0] - x - 0.5, place[1] - y - 0.5);
          if (pixels < n->pixels)
            *n = (Near){pixels, distance, hidden};
        }
      }
    }
  }
  return near;
}

/* With one edge near by, a pixel has its colour over what was there, or under it. */
static int check_pixel(const double *before, const double *after, const Near near[12], const double color[3],
                       double stop) {
  int close = 0, edge = 0;
  for (int i = 0; i < 12; ++i) {
    if (near[i].pixels < 1.05)
      ++close, edge = i;
  }
  if (close > 1)
    return 0;
  double coverage = close && near[edge].pixels < 1 ? 1 - near[edge].pixels : 0;
  if (close && fabs(near[edge].distance - stop) < 0.02)
    return 0;
  if (close && near[edge].distance > stop)
    coverage = 0;
  for (int k = 0; k < 4; ++k) {
    const double share = near[edge].hidden ? coverage * (1 - before[3]) : coverage,
                 kept = near[edge].hidden ? 1 : 1 - coverage;
    const double wanted = kept * before[k] + share * (k < 3 ? color[k] : 1);
    if (!(fabs(after[k] - wanted) <= (close ? 2e-2 : 0)))
      fail_msg("channel %d is %g, not %g: an edge %g pixels away, %s", k, after[k], wanted, near[edge].pixels,
               near[edge].hidden ? "hidden" : "in front");
  }
  return close;
}

static void edges_of_the_box_lie_where_they_should(void **state) {
  (void)state;
  TetcastCamera cameras[] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5),
                             camera_of(0.45, 0.55, 4, 0.5, 0.5, 0.5),
                             camera_of(0.43, 0.52, 0.61, 1, 0.2, 0), /* inside */
                             camera_of(1.2, 0.6, 1.1, 0, 0.3, 0.4),  /* so near that edges go past the eye */
                             parallel(3, 2, 4, 1.9),
                             parallel(0.6, 0.45, 0.55, 2.5)}; /* which starts within the box */
  cameras[2].fovy = cameras[3].fovy = 100;
  static const double color[3] = {1, 0.25, 0};
  World world;
  world_begin(&world, 3, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  for (int i = 0; i < 18; ++i) {
    const TetcastCamera *camera = &cameras[i % 6];
    static const double extinctions[] = {0, 1, 1e4}, stops[] = {3.6, 3.6, 0.7, 1, 4.6, 0.3};
    double stop[PIXELS];
    for (int p = 0; p < PIXELS; ++p)
      stop[p] = stops[i % 6];
    const TetcastArray array = {stop, TETCAST_TYPE_FLOAT64, PIXELS, 0};
    TetcastRenderDesc desc = render_desc();
    desc.stop = i / 6 == 1 ? &array : NULL;
    set_transfer(&world, extinctions[i / 6]);
    TetcastFrame *plain = shoot(&world, camera, &desc, TETCAST_TYPE_FLOAT64);
    TetcastFrame *frame = shoot(&world, camera, &desc, TETCAST_TYPE_FLOAT64),
                 *floats = shoot(&world, camera, &desc, TETCAST_TYPE_FLOAT32);
    assert_int_equal(tetcast_scene_draw_outline(world.scene, camera, &desc, color, frame), TETCAST_OK);
    assert_int_equal(tetcast_scene_draw_outline(world.scene, camera, &desc, color, floats), TETCAST_OK);
    Near *near = find_near(camera);
    const double *before = tetcast_frame_pixels(plain), *after = tetcast_frame_pixels(frame);
    int met = 0;
    for (int p = 0; p < PIXELS; ++p)
      met += check_pixel(before + 4 * p, after + 4 * p, near + 12 * p, color, desc.stop ? stops[i % 6] : INFINITY);
    assert_true(met > 30);
    for (int p = 0; p < 4 * PIXELS; ++p)
      assert_true(fabs(after[p] - (double)((const float *)tetcast_frame_pixels(floats))[p]) < 1e-6);
    free(near);
    tetcast_frame_destroy(&plain);
    tetcast_frame_destroy(&frame);
    tetcast_frame_destroy(&floats);
  }
  world_end(&world);
}

/* Over pixels of which no two are alike, nor two numbers of one, in rows of the caller's own with room between them. */
static void an_outline_keeps_the_colours_that_are_there(void **state) {
  (void)state;
  enum { ROW = 4 * W + 3 };
  static const double color[3] = {1, 0.25, 0};
  static double before[H * ROW], after[H * ROW];
  static float single[H * ROW];
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  uint32_t random = 1;
  for (int i = 0; i < H * ROW; ++i) {
    random = random * 1664525u + 1013904223u;
    single[i] = (float)(random >> 8) / 0x1p24f;
    before[i] = after[i] = (double)single[i];
  }
  for (int wide = 0; wide < 2; ++wide) {
    TetcastFrameDesc desc = tetcast_frame_desc_default();
    desc.width = W;
    desc.height = H;
    desc.type = wide ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32;
    desc.pixels = wide ? (void *)after : (void *)single;
    desc.row_stride = ROW * (int64_t)(wide ? sizeof *after : sizeof *single);
    TetcastFrame *frame = NULL;
    assert_int_equal(tetcast_frame_create(world.fixture.context, &desc, &frame), TETCAST_OK);
    assert_int_equal(tetcast_scene_draw_outline(world.scene, &camera, NULL, color, frame), TETCAST_OK);
    tetcast_frame_destroy(&frame);
  }
  Near *near = find_near(&camera);
  int met = 0;
  for (int p = 0; p < PIXELS; ++p) {
    const int at = p / W * ROW + 4 * (p % W);
    met += check_pixel(before + at, after + at, near + 12 * p, color, INFINITY);
  }
  assert_true(met > 100);
  for (int i = 0; i < H * ROW; ++i) {
    assert_true(fabs(after[i] - (double)single[i]) < 1e-6);
    if (i % ROW >= 4 * W)
      assert_true(after[i] == before[i]); /* nothing is drawn between rows */
  }
  free(near);
  world_end(&world);
}

static void an_outline_goes_with_other_kinds_of_scene(void **state) {
  (void)state;
  static const double color[3] = {0, 0, 1};
  const TetcastCamera camera = camera_of(0.5, 0.5, 4, 0.5, 0.5, 0.5);
  World world;
  world_begin(&world, 2, 0, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_MAXIMUM), TETCAST_OK);
  const TetcastRenderDesc desc = render_desc();
  TetcastFrame *frame = shoot(&world, &camera, &desc, TETCAST_TYPE_FLOAT64);
  assert_int_equal(tetcast_scene_draw_outline(world.scene, &camera, NULL, color, frame), TETCAST_OK);
  const double *pixels = tetcast_frame_pixels(frame);
  int blue = 0;
  for (int p = 0; p < PIXELS; ++p)
    blue += pixels[4 * p + 2] > pixels[4 * p];
  assert_true(blue > 40);
  const double bad[3] = {0, -1, 0};
  assert_int_equal(tetcast_scene_draw_outline(world.scene, &camera, NULL, bad, frame), TETCAST_ERROR_ARGUMENT);
  const TetcastCamera nowhere = camera_of(0.5, 0.5, 4, 0.5, 0.5, 4);
  assert_int_equal(tetcast_scene_draw_outline(world.scene, &nowhere, NULL, color, frame), TETCAST_ERROR_ARGUMENT);
  const double near = 1;
  const TetcastArray few = {&near, TETCAST_TYPE_FLOAT64, 1, 0};
  TetcastRenderDesc stopping = render_desc();
  stopping.stop = &few;
  assert_int_equal(tetcast_scene_draw_outline(world.scene, &camera, &stopping, color, frame), TETCAST_ERROR_ARGUMENT);
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

/* ── the boundary's triangles ── */

/* How far a point of a face of the cube in n × n squares, cut along their diagonals, is from the nearest edge. */
static double from_edges(double x, double y, int n) {
  const double u = x * n - floor(x * n), v = y * n - floor(y * n);
  return fmin(fmin(fmin(u, 1 - u), fmin(v, 1 - v)), fabs(u - v) / sqrt(2)) / n;
}

/* A face seen straight on, from outside and from within, at a distance or in parallel. */
static void edges_of_triangles_are_a_pixel_wide(void **state) {
  (void)state;
  static const int n = 3;
  World world;
  world_begin(&world, n, 0, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastShadingDesc shading = tetcast_shading_desc_default();
  shading.shade = TETCAST_SHADE_NONE;
  assert_int_equal(tetcast_scene_set_shading(world.scene, &shading), TETCAST_OK);
  const TetcastBoundary boundary = {
      .opacity = 1, .colored = 1, .color = {1, 1, 1}, .edges = 1, .edge_color = {0, 0.5, 0.25}};
  assert_int_equal(tetcast_scene_set_boundary(world.scene, &boundary), TETCAST_OK);
  for (int i = 0; i < 4; ++i) {
    TetcastCamera camera = parallel(0.51, 0.47, i & 1 ? 0.3 : 5, 1.1);
    camera.target[0] = camera.eye[0];
    camera.target[1] = camera.eye[1];
    camera.target[2] = i & 1 ? -1 : 0;
    camera.projection = i & 2 ? TETCAST_PERSPECTIVE : TETCAST_ORTHOGRAPHIC;
    camera.fovy = i & 1 ? 100 : 14;
    const TetcastRenderDesc desc = render_desc();
    TetcastFrame *frame = shoot(&world, &camera, &desc, TETCAST_TYPE_FLOAT64);
    const double face = i & 1 ? 0 : 1, *pixels = tetcast_frame_pixels(frame);
    int covered = 0, clear = 0;
    for (int p = 0; p < PIXELS; ++p) {
      double eye[3], direction[3], distance;
      ray_of(&camera, W, H, p, eye, direction);
      distance = (face - eye[2]) / direction[2];
      const double x = eye[0] + distance * direction[0], y = eye[1] + distance * direction[1];
      if (!(x > 1e-9 && x < 1 - 1e-9 && y > 1e-9 && y < 1 - 1e-9))
        continue;
      /* A pixel of the face; where it is seen at an angle, as seen along the ray. */
      const double size = (i & 2 ? 2 * tan(camera.fovy * acos(-1) / 360) * fabs(face - eye[2]) : 1.1) / H;
      const double straight = -direction[2], near = from_edges(x, y, n) / size;
      /* The nearest line may go any way, so that its distance is seen shortened by up to `straight`. */
      const double least = near * straight < 1 ? 1 - near : 0, most = near * straight < 1 ? 1 - near * straight : 0;
      const double got = 1 - pixels[4 * p];
      if (!(got >= fmax(0, least) - 1e-9 && got <= most + 1e-9))
        fail_msg("view %d, pixel %d: covered by %g, not %g to %g", i, p, got, least, most);
      for (int k = 0; k < 3; ++k)
        assert_true(fabs(pixels[4 * p + k] - (1 - got + got * boundary.edge_color[k])) < 1e-12);
      covered += got > 0.3;
      clear += got == 0;
    }
    assert_true(covered > 50 && clear > 100);
    tetcast_frame_destroy(&frame);
  }
  TetcastBoundary bad = boundary;
  bad.edge_color[1] = NAN;
  assert_int_equal(tetcast_scene_set_boundary(world.scene, &bad), TETCAST_ERROR_ARGUMENT);
  assert_non_null(strstr(world.fixture.message, "the colour of edges"));
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edges_of_the_box_lie_where_they_should),
      cmocka_unit_test(an_outline_keeps_the_colours_that_are_there),
      cmocka_unit_test(an_outline_goes_with_other_kinds_of_scene),
      cmocka_unit_test(edges_of_triangles_are_a_pixel_wide),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
