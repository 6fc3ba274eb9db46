/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures by few rays: which pixels they go through, and what becomes of the others, against the rule written anew as
 * a recursion over the plain picture; that a difference of 0 gives the plain picture to the bit, that threads change no
 * bit, and what the library says where it can't. */
#include "world.h"

enum { W = 61, H = 43 };

typedef struct Shot {
  double *pixels; /* [height][width][4] */
  TetcastRenderStats stats;
} Shot;

static TetcastRenderDesc plain_desc(int samples) {
  TetcastRenderDesc desc = render_desc();
  desc.samples = samples;
  return desc;
}

static TetcastRenderDesc adaptive_desc(double epsilon, int coarse, int fine) {
  TetcastRenderDesc desc = render_desc();
  desc.adaptive_epsilon = epsilon;
  desc.adaptive_coarse = coarse;
  desc.adaptive_fine = fine;
  return desc;
}

static Shot shoot(const World *world, const TetcastCamera *camera, const TetcastRenderDesc *desc, int width,
                  int height) {
  Shot shot = {.pixels = malloc(sizeof(double) * 4 * (size_t)(width * height))};
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = width;
  frame_desc.height = height;
  frame_desc.pixels = shot.pixels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, camera, desc, frame, &shot.stats), TETCAST_OK);
  assert_int_equal(shot.stats.lost, 0);
  tetcast_frame_destroy(&frame);
  return shot;
}

static void begin(World *world, double factor, TetcastTraversal traversal) {
  world_begin(world, 6, 0.5, 1, traversal);
  set_values(world, world->cube.values, TETCAST_POINT);
  TetcastTransferFunction *transfer = transfer_of(world->fixture.context, factor);
  assert_int_equal(tetcast_scene_set_transfer_function(world->scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
}

/* ── the rule ── */

typedef struct Rule {
  const double *plain; /* what a ray through a pixel's centre gives */
  double *wanted;
  bool *cast;
  int width, height;
  double epsilon;
} Rule;

static bool differ_somewhere(const double *a, const double *b, double epsilon) {
  for (int k = 0; k < 4; ++k) {
    if (fabs(a[k] - b[k]) >= epsilon)
      return true;
  }
  return false;
}

/* The square with this first pixel, and all that it is cut into. */
static void follow(Rule *rule, int x0, int y0, int size) {
  const int x1 = x0 + size < rule->width ? x0 + size : rule->width - 1,
            y1 = y0 + size < rule->height ? y0 + size : rule->height - 1;
  const int corner[4] = {y0 * rule->width + x0, y0 * rule->width + x1, y1 * rule->width + x0, y1 * rule->width + x1};
  bool cut = false;
  for (int i = 0; i < 4; ++i) {
    rule->cast[corner[i]] = true;
    for (int j = 0; j < 4; ++j)
      cut = cut || differ_somewhere(rule->plain + 4 * corner[i], rule->plain + 4 * corner[j], rule->epsilon);
  }
  if (size == 1)
    return;
  if (cut) {
    for (int y = y0; y == y0 || (y < y1 && y < y0 + size); y += size / 2) {
      for (int x = x0; x == x0 || (x < x1 && x < x0 + size); x += size / 2)
        follow(rule, x, y, size / 2);
    }
    return;
  }
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      if ((x == x1 && x1 < rule->width - 1) || (y == y1 && y1 < rule->height - 1))
        continue; /* a neighbour's */
      const double u = x1 > x0 ? (x - x0) / (double)(x1 - x0) : 0, v = y1 > y0 ? (y - y0) / (double)(y1 - y0) : 0;
      for (int k = 0; k < 4; ++k) {
        const double top = rule->plain[4 * corner[0] + k] * (1 - u) + rule->plain[4 * corner[1] + k] * u,
                     bottom = rule->plain[4 * corner[2] + k] * (1 - u) + rule->plain[4 * corner[3] + k] * u;
        rule->wanted[4 * (y * rule->width + x) + k] = top * (1 - v) + bottom * v;
      }
    }
  }
}

/* Applies the rule to a plain picture; returns how many rays it takes. */
static int64_t apply(Rule *rule, int coarse) {
  const int count = rule->width * rule->height;
  rule->wanted = calloc((size_t)count * 4, sizeof *rule->wanted);
  rule->cast = calloc((size_t)count, sizeof *rule->cast);
  for (int y = 0; y == 0 || y < rule->height - 1; y += coarse) {
    for (int x = 0; x == 0 || x < rule->width - 1; x += coarse)
      follow(rule, x, y, coarse);
  }
  int64_t rays = 0;
  for (int i = 0; i < count; ++i) {
    rays += rule->cast[i];
    if (rule->cast[i])
      memcpy(rule->wanted + 4 * i, rule->plain + 4 * i, 4 * sizeof *rule->wanted);
  }
  return rays;
}

/* What a ray gathers is rounded by what is cast beside and before it. */
static const double rounding = 1e-14;

static void check_pixels(const Shot *shot, const Rule *rule) {
  for (int i = 0; i < rule->width * rule->height; ++i) {
    const double difference = largest_difference(shot->pixels + 4 * i, rule->wanted + 4 * i, 4);
    if (difference > rounding)
      fail_msg("size %d %d eps %g pixel (%d, %d), %s, is off by %g", rule->width, rule->height, rule->epsilon,
               i % rule->width, i / rule->width, rule->cast[i] ? "cast" : "interpolated", difference);
  }
}

static const double cameras[][6] = {
    {2.1, 1.7, 3.3, 0.5, 0.5, 0.5}, {0.5, 0.5, 4, 0.5, 0.5, 0.5}, {0.43, 0.52, 0.61, 1, 0.2, 0}, /* inside */
};

static TetcastCamera camera_number(int i) {
  return camera_of(cameras[i][0], cameras[i][1], cameras[i][2], cameras[i][3], cameras[i][4], cameras[i][5]);
}

/* The pixels that the rule names are cast, as in the plain picture; the others are interpolated. */
static void rays_go_where_the_rule_says(void **state) {
  (void)state;
  static const double epsilons[] = {1e-3, 0.02, 0.3};
  static const int sizes[][2] = {{W, H}, {64, 33}, {65, 32}, {1, 17}, {23, 1}, {1, 1}, {2, 3}};
  World world;
  begin(&world, 0.5, TETCAST_TRAVERSAL_SHELL);
  int64_t all = 0, left = 0;
  for (int coarse = 1; coarse <= 64; coarse *= 2) {
    for (int i = 0; i < 3 * 7; ++i) {
      const int width = sizes[i % 7][0], height = sizes[i % 7][1];
      const TetcastCamera camera = camera_number(i / 7);
      const TetcastRenderDesc desc = adaptive_desc(epsilons[(i + coarse) % 3], coarse, 1), plain = plain_desc(1);
      const Shot whole = shoot(&world, &camera, &plain, width, height),
                 shot = shoot(&world, &camera, &desc, width, height);
      Rule rule = {.plain = whole.pixels, .width = width, .height = height, .epsilon = desc.adaptive_epsilon};
      assert_int_equal(whole.stats.rays, width * height);
      assert_int_equal(shot.stats.rays, apply(&rule, coarse));
      assert_true(isnan(shot.stats.error));
      check_pixels(&shot, &rule);
      all += width * height;
      left += width * height - shot.stats.rays;
      free(rule.wanted);
      free(rule.cast);
      free(whole.pixels);
      free(shot.pixels);
    }
  }
  assert_true(left > all / 4); /* it saves something */
  world_end(&world);
}

/* Whether a pixel differs from one of its four neighbours. */
static bool stands_out(const Rule *rule, int i) {
  const int x = i % rule->width, y = i / rule->width;
  const double *own = rule->wanted + 4 * i;
  return (x > 0 && differ_somewhere(own, own - 4, rule->epsilon)) ||
         (x < rule->width - 1 && differ_somewhere(own, own + 4, rule->epsilon)) ||
         (y > 0 && differ_somewhere(own, own - 4 * rule->width, rule->epsilon)) ||
         (y < rule->height - 1 && differ_somewhere(own, own + 4 * rule->width, rule->epsilon));
}

/* Pixels that differ from a neighbour are those of a picture with several samples, the others stay. */
static void fine_pixels_have_several_samples(void **state) {
  (void)state;
  static const int fine[] = {2, 4, 9, 300};
  World world;
  begin(&world, 0.5, TETCAST_TRAVERSAL_SHELL);
  for (int i = 0; i < 4; ++i) {
    const TetcastCamera camera = camera_number(i % 3);
    const TetcastRenderDesc desc = adaptive_desc(0.05, 4, fine[i]), plain = plain_desc(1), many = plain_desc(fine[i]);
    const Shot whole = shoot(&world, &camera, &plain, W, H), smooth = shoot(&world, &camera, &many, W, H),
               shot = shoot(&world, &camera, &desc, W, H);
    Rule rule = {.plain = whole.pixels, .width = W, .height = H, .epsilon = desc.adaptive_epsilon};
    int64_t rays = apply(&rule, 4), count = 0;
    for (int p = 0; p < W * H; ++p) {
      const bool several = stands_out(&rule, p);
      const double *wanted = several ? smooth.pixels : rule.wanted;
      assert_true(largest_difference(shot.pixels + 4 * p, wanted + 4 * p, 4) <= 1e-13);
      count += several;
    }
    assert_true(count > 0 && count < W * H / 2);
    assert_int_equal(shot.stats.rays, rays + count * fine[i]);
    free(rule.wanted);
    free(rule.cast);
    free(whole.pixels);
    free(smooth.pixels);
    free(shot.pixels);
  }
  world_end(&world);
}

static void a_difference_of_zero_is_the_plain_picture(void **state) {
  (void)state;
  static const int coarse[] = {1, 4, 64}, fine[] = {1, 1, 4};
  for (int faces = 0; faces < 2; ++faces) {
    World world;
    begin(&world, 0.5, faces ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    for (int i = 0; i < 3; ++i) {
      const TetcastCamera camera = camera_number(i);
      const TetcastRenderDesc desc = adaptive_desc(0, coarse[i], fine[i]), plain = plain_desc(fine[i]);
      const Shot whole = shoot(&world, &camera, &plain, W, H), shot = shoot(&world, &camera, &desc, W, H);
      assert_memory_equal(whole.pixels, shot.pixels, sizeof(double) * 4 * W * H);
      assert_int_equal(shot.stats.rays, W * H * fine[i]);
      free(whole.pixels);
      free(shot.pixels);
    }
    world_end(&world);
  }
}

static void threads_change_no_bit(void **state) {
  (void)state;
  World world;
  begin(&world, 0.5, TETCAST_TRAVERSAL_SHELL);
  const TetcastCamera camera = camera_number(0);
  for (int i = 0; i < 4; ++i) {
    TetcastRenderDesc desc = adaptive_desc(0.01, i & 1 ? 8 : 4, i & 1 ? 4 : 1);
    desc.tolerance = i & 2 ? 0.01 : 0;
    Shot first = {0};
    for (int threads = 1; threads <= 5; threads += 2) {
      assert_int_equal(tetcast_context_set_threads(world.fixture.context, threads), TETCAST_OK);
      const Shot shot = shoot(&world, &camera, &desc, 4 * W, 4 * H);
      if (first.pixels) {
        assert_memory_equal(first.pixels, shot.pixels, sizeof(double) * 4 * 16 * W * H);
        assert_int_equal(first.stats.rays, shot.stats.rays);
        free(shot.pixels);
      } else {
        first = shot;
      }
    }
    free(first.pixels);
  }
  world_end(&world);
}

/* With next to no difference allowed, what the picture shows is all cast, and keeps the tolerance. Where there is
 * single precision, rays through the regular mesh's edges are walked again in double. */
static void pixels_that_are_cast_keep_the_tolerance(void **state) {
  (void)state;
  static const double color[2][4] = {{0, 1, 0.2, 0}, {1, 0.1, 0.5, 1}}, extinction[2][2] = {{0, 0.5}, {1, 4}};
  World world;
  world_begin(&world, 6, 0, 1, TETCAST_TRAVERSAL_SHELL);
  set_values(&world, world.cube.values, TETCAST_POINT);
  TetcastTransferFunctionDesc transfer_desc = tetcast_transfer_function_desc_default();
  transfer_desc.color = color[0];
  transfer_desc.extinction = extinction[0];
  transfer_desc.color_count = transfer_desc.extinction_count = 2;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(world.fixture.context, &transfer_desc, &transfer), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
  tetcast_transfer_function_destroy(&transfer);
  int singles = 0;
  for (int i = 0; i < 3; ++i) {
    const TetcastCamera camera = camera_number(i);
    TetcastRenderDesc desc = adaptive_desc(1e-300, 4, 1), plain = plain_desc(1);
    desc.tolerance = 1e-2;
    const Shot whole = shoot(&world, &camera, &plain, W, H), shot = shoot(&world, &camera, &desc, W, H);
    assert_true(largest_difference(whole.pixels, shot.pixels, 4 * W * H) <= desc.tolerance);
    plain.tolerance = desc.tolerance;
    const Shot loose = shoot(&world, &camera, &plain, W, H);
    assert_string_equal(loose.stats.precision, shot.stats.precision);
    singles += strcmp(shot.stats.precision, "single") == 0;
    assert_true(singles > 0 || strcmp(shot.stats.isa, "scalar") == 0);
    free(whole.pixels);
    free(shot.pixels);
    free(loose.pixels);
  }
  world_end(&world);
}

/* Coefficients of three groups, in a frame of floats. */
static void coefficients_and_floats_are_possible(void **state) {
  (void)state;
  World world;
  begin(&world, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastContext *context = world.fixture.context;
  TetcastField *field = field_of(context, world.cube.values, world.cube.vertex_count, TETCAST_POINT);
  const TetcastField *fields[3] = {field, field, field};
  TetcastCoefficientsDesc coefficients = tetcast_coefficients_desc_default();
  coefficients.extinction = coefficients.emission = fields;
  coefficients.extinction_count = coefficients.emission_count = 3;
  assert_int_equal(tetcast_scene_set_coefficients(world.scene, &coefficients), TETCAST_OK);
  const TetcastCamera camera = camera_number(0);
  const TetcastRenderDesc desc = adaptive_desc(1e-3, 8, 1), plain = plain_desc(1);
  const Shot whole = shoot(&world, &camera, &plain, W, H), shot = shoot(&world, &camera, &desc, W, H);
  Rule rule = {.plain = whole.pixels, .width = W, .height = H, .epsilon = desc.adaptive_epsilon};
  assert_int_equal(shot.stats.rays, apply(&rule, 8));
  assert_true(shot.stats.rays < W * H / 2);
  check_pixels(&shot, &rule);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  frame_desc.type = TETCAST_TYPE_FLOAT32;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world.scene, &camera, &desc, frame, NULL), TETCAST_OK);
  for (int i = 0; i < 4 * W * H; ++i)
    assert_true(((const float *)tetcast_frame_pixels(frame))[i] == (float)shot.pixels[i]);
  tetcast_frame_destroy(&frame);
  tetcast_field_destroy(&field);
  free(rule.wanted);
  free(rule.cast);
  free(whole.pixels);
  free(shot.pixels);
  world_end(&world);
}

typedef struct Watch {
  double last;
  int calls, most;
  bool forward;
} Watch;

static bool watch(void *user, double fraction) {
  Watch *w = user;
  w->forward = w->forward && fraction >= w->last && fraction <= 1;
  w->last = fraction;
  return ++w->calls < w->most;
}

static void progress_goes_forward_and_stops(void **state) {
  (void)state;
  World world;
  begin(&world, 0.5, TETCAST_TRAVERSAL_SHELL);
  const TetcastCamera camera = camera_number(0);
  Watch all = {.most = 1 << 30, .forward = true}, few = {.most = 3, .forward = true};
  TetcastRenderDesc desc = adaptive_desc(0.01, 8, 4);
  desc.progress = (TetcastProgress){watch, &all};
  const Shot shot = shoot(&world, &camera, &desc, 4 * W, 4 * H);
  assert_true(all.forward && all.calls > 5 && all.last > 0.6);
  free(shot.pixels);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = 4 * W;
  frame_desc.height = 4 * H;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world.fixture.context, &frame_desc, &frame), TETCAST_OK);
  desc.progress.user = &few;
  assert_int_equal(tetcast_scene_render(world.scene, &camera, &desc, frame, NULL), TETCAST_ERROR_CANCELLED);
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

/* Whichever allocation fails, that is said, and the next picture is whole. */
static void memory_may_run_out(void **state) {
  (void)state;
  World world;
  begin(&world, 0.5, TETCAST_TRAVERSAL_SHELL);
  Fixture *fixture = &world.fixture;
  assert_int_equal(tetcast_context_set_threads(fixture->context, 1), TETCAST_OK);
  const TetcastCamera camera = camera_number(0);
  const TetcastRenderDesc desc = adaptive_desc(0.05, 4, 4);
  const Shot whole = shoot(&world, &camera, &desc, W, H);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(fixture->context, &frame_desc, &frame), TETCAST_OK);
  int failed = 0;
  for (long n = 1; n < 1000; ++n) {
    const long before = fixture->live;
    fixture->fail_at = fixture->allocations + n;
    const TetcastStatus status = tetcast_scene_render(world.scene, &camera, &desc, frame, NULL);
    const bool reached = fixture->allocations >= fixture->fail_at;
    fixture->fail_at = 0;
    if (!reached) {
      assert_int_equal(status, TETCAST_OK);
      break;
    }
    assert_true(status == TETCAST_ERROR_MEMORY && fixture->live <= before);
    ++failed;
  }
  assert_true(failed > 8);
  assert_memory_equal(whole.pixels, tetcast_frame_pixels(frame), sizeof(double) * 4 * W * H);
  tetcast_frame_destroy(&frame);
  free(whole.pixels);
  world_end(&world);
}

static void refuse(World *world, const TetcastRenderDesc *desc, uint32_t channels, const char *text) {
  const TetcastCamera camera = camera_number(0);
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = W;
  frame_desc.height = H;
  frame_desc.channels = channels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(world->fixture.context, &frame_desc, &frame), TETCAST_OK);
  assert_int_equal(tetcast_scene_render(world->scene, &camera, desc, frame, NULL), TETCAST_ERROR_ARGUMENT);
  if (!strstr(world->fixture.message, text))
    fail_msg("'%s' is missing in '%s'", text, world->fixture.message);
  tetcast_frame_destroy(&frame);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  World world;
  begin(&world, 0.5, TETCAST_TRAVERSAL_SHELL);
  static const int coarse[] = {-1, 3, 65, 128};
  for (int i = 0; i < 4; ++i) {
    const TetcastRenderDesc desc = adaptive_desc(0.1, coarse[i], 1);
    refuse(&world, &desc, 0, "a power of two up to 64");
  }
  const double epsilons[] = {-1, NAN, INFINITY};
  for (int i = 0; i < 3; ++i) {
    const TetcastRenderDesc desc = adaptive_desc(epsilons[i], 4, 1);
    refuse(&world, &desc, 0, "must be 0 or a positive number");
  }
  TetcastRenderDesc desc = adaptive_desc(0.1, 4, 0);
  refuse(&world, &desc, 0, "0 samples in fine pixels");
  desc.adaptive_fine = 65537;
  refuse(&world, &desc, 0, "65537 samples in fine pixels");
  desc.adaptive_fine = 1;
  refuse(&world, &desc, TETCAST_CHANNEL_DEPTH, "the channel depth can't be interpolated");
  refuse(&world, &desc, TETCAST_CHANNEL_ERROR, "the channel error can't be interpolated");
  desc.samples = 4;
  refuse(&world, &desc, 0, "not possible with 4 samples");
  desc.samples = 1;
  assert_int_equal(tetcast_scene_set_blend(world.scene, TETCAST_BLEND_MAXIMUM), TETCAST_OK);
  refuse(&world, &desc, 0, "only possible in the blend mode composite");
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rays_go_where_the_rule_says),
      cmocka_unit_test(fine_pixels_have_several_samples),
      cmocka_unit_test(a_difference_of_zero_is_the_plain_picture),
      cmocka_unit_test(threads_change_no_bit),
      cmocka_unit_test(pixels_that_are_cast_keep_the_tolerance),
      cmocka_unit_test(coefficients_and_floats_are_possible),
      cmocka_unit_test(progress_goes_forward_and_stops),
      cmocka_unit_test(memory_may_run_out),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
