/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a mesh with coefficients: their fragments, composited group by group, are what the whole has. */
#include "group_parts.h"
#include "world.h"

enum { WIDTH = 37, HEIGHT = 33, PIXELS = WIDTH * HEIGHT };

static TetcastFrame *frame_of(TetcastContext *context, uint32_t channels, int groups) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = WIDTH;
  desc.height = HEIGHT;
  desc.channels = channels;
  desc.groups = groups;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

static const double *channel(const TetcastFrame *frame, TetcastChannel which) {
  return tetcast_frame_channel(frame, which);
}

static TetcastFragments *fragments_of(TetcastContext *context, const TetcastScene *scene, const TetcastCamera *camera) {
  TetcastFragments *fragments = NULL;
  const TetcastRenderDesc desc = render_desc();
  TetcastRenderStats stats;
  assert_int_equal(tetcast_fragments_create(context, &fragments), TETCAST_OK);
  assert_int_equal(tetcast_scene_render_fragments(scene, camera, &desc, WIDTH, HEIGHT, fragments, &stats), TETCAST_OK);
  assert_int_equal(stats.lost, 0);
  assert_int_equal(stats.rays, PIXELS);
  return fragments;
}

static void render_whole(const TetcastScene *scene, const TetcastCamera *camera, TetcastFrame *frame) {
  const TetcastRenderDesc desc = render_desc();
  assert_int_equal(tetcast_scene_render(scene, camera, &desc, frame, NULL), TETCAST_OK);
}

static void assert_same(const TetcastFrame *a, const TetcastFrame *b, int groups) {
  assert_memory_equal(tetcast_frame_pixels(a), tetcast_frame_pixels(b), PIXELS * 4 * sizeof(double));
  for (uint32_t bit = TETCAST_CHANNEL_RADIANCE; bit <= TETCAST_CHANNEL_PATH_LENGTH; bit *= 2) {
    const size_t width = bit == TETCAST_CHANNEL_PATH_LENGTH ? 1 : (size_t)groups;
    assert_memory_equal(channel(a, (TetcastChannel)bit), channel(b, (TetcastChannel)bit),
                        PIXELS * width * sizeof(double));
  }
}

/* ── parts and the whole ── */

/* Pixel by pixel, those of a pixel one behind the other. Returns how many the pixel with most of them has. */
static int check_order(const TetcastFragmentList *list) {
  int most = 0, same = 0;
  for (int64_t i = 0; i < list->count; ++i) {
    const TetcastFragment *f = &list->data[i];
    assert_true(f->pixel >= 0 && f->pixel < PIXELS && f->begin <= f->end && f->optical_depth == 0);
    same = i && f[-1].pixel == f->pixel ? same + 1 : 1;
    assert_true(same > 1 ? f[-1].end <= f->begin + 1e-15 : !i || f[-1].pixel < f->pixel); /* up to rounding */
    most = same > most ? same : most;
  }
  return most;
}

/* A fragment's place, for sorting. */
static int compare_places(const void *left, const void *right) {
  const TetcastFragment *a = left, *b = right;
  if (a->pixel != b->pixel)
    return a->pixel < b->pixel ? -1 : 1;
  return a->begin < b->begin ? -1 : a->begin > b->begin;
}

/* All parts of a convex mesh: where a ray leaves one, it enters another, at the same place to the bit. */
static void check_places(const TetcastFragmentList *lists, int count) {
  int64_t all = 0;
  for (int i = 0; i < count; ++i)
    all += lists[i].count;
  TetcastFragment *fragments = malloc((size_t)all * sizeof *fragments), *next = fragments;
  for (int i = 0; i < count; ++i) {
    memcpy(next, lists[i].data, (size_t)lists[i].count * sizeof *next);
    next += lists[i].count;
  }
  qsort(fragments, (size_t)all, sizeof *fragments, compare_places);
  for (int64_t i = 1; i < all; ++i)
    assert_true(fragments[i].pixel != fragments[i - 1].pixel || fragments[i].begin == fragments[i - 1].end);
  free(fragments);
}

static int *owners_of(const Cube *cube, Cut cut, int count) {
  int *owner = malloc((size_t)cube->cell_count * sizeof *owner);
  uint64_t seed = 11 + (uint64_t)count;
  for (int64_t i = 0; i < cube->cell_count; ++i)
    owner[i] = owner_of(cube, i, cut, count, &seed);
  return owner;
}

/* Composites `count` parts, in two orders, and compares them with the whole's frame. `exact`: no ray meets a vertex or
 * an edge, where rounding decides in which order faces are crossed. */
static void check_parts(TetcastContext *context, const Cube *cube, Cut cut, int count, const Groups *groups,
                        const TetcastCamera *camera, const TetcastFrame *whole, bool exact) {
  TetcastFragments *made[MOST_PARTS];
  TetcastFragmentList lists[MOST_PARTS], reversed[MOST_PARTS];
  int *owner = owners_of(cube, cut, count), made_count = 0, most = 0;
  const int channels = group_count(groups);
  for (int i = 0; i < count; ++i) {
    uint64_t seed = 3 + (uint64_t)i;
    Part part = group_part(context, cube, owner, i, groups, &seed);
    if (part.scene) {
      made[made_count] = fragments_of(context, part.scene, camera);
      lists[made_count] = tetcast_fragments_list(made[made_count]);
      assert_int_equal(lists[made_count].group_count, channels);
      const int own = check_order(&lists[made_count++]);
      most = own > most ? own : most;
    }
    part_end(&part);
  }
  if (cut == CUT_SCATTER && count > 1)
    assert_true(most > 2);
  for (int i = 0; i < made_count; ++i)
    reversed[made_count - 1 - i] = lists[i];
  TetcastFrame *all = frame_of(context, group_channels, channels), *again = frame_of(context, group_channels, channels);
  double overlap = -1;
  assert_int_equal(tetcast_fragments_composite(context, lists, made_count, all, &overlap), TETCAST_OK);
  assert_int_equal(tetcast_fragments_composite(context, reversed, made_count, again, NULL), TETCAST_OK);
  assert_true(overlap >= 0 && overlap <= (exact ? 0 : 1e-15));
  assert_same(all, again, channels);
  if (exact)
    check_places(lists, made_count);
  check_groups(whole, all, groups->size);
  tetcast_frame_destroy(&all);
  tetcast_frame_destroy(&again);
  for (int i = 0; i < made_count; ++i)
    tetcast_fragments_destroy(&made[i]);
  free(owner);
}

/* One group; more than fill the lanes of a vector; one extinction or emission for all; of points, of cells, of both. */
static const Groups kinds[] = {
    {1, 1, 0, 3},   {3, 3, 0, 0.5}, {17, 17, 0, 4}, {1, 11, 1, 6}, {9, 1, 2, 5},    {4, 4, 3, 2},    {8, 8, 1, 1},
    {40, 40, 0, 9}, {0, 5, 0, 2},   {20, 0, 0, 3},  {2, 2, 0, 60}, {12, 12, 3, 60}, {0, 1, 2, 1e-9}, {1, 0, 1, 1e-9},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static void groups_of_parts_are_those_of_the_whole(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(6, 0.5);
  int *all = calloc((size_t)cube.cell_count, sizeof *all);
  for (int i = 0; i < KINDS; ++i) {
    uint64_t seed = 1;
    Part whole = group_part(fixture.context, &cube, all, 0, &kinds[i], &seed);
    const TetcastCamera cameras[3] = {camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5), camera_of(0.43, 0.52, 0.61, 1, 0.2, 0),
                                      parallel(0.5, 0.5, 3, 1.25)};
    for (int cut = 0; cut < CUTS; ++cut) {
      const TetcastCamera *camera = &cameras[(i + cut) % 3];
      TetcastFrame *one = frame_of(fixture.context, group_channels | TETCAST_CHANNEL_ERROR, group_count(&kinds[i]));
      render_whole(whole.scene, camera, one);
      check_parts(fixture.context, &cube, (Cut)cut, 1, &kinds[i], camera, one, true);
      check_parts(fixture.context, &cube, (Cut)cut, 7, &kinds[i], camera, one, true);
      tetcast_frame_destroy(&one);
    }
    part_end(&whole);
  }
  free(all);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Rays that cross so many cells that sums are taken in blocks, and these are in several fragments. */
static void long_rays(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(34, 0.5);
  int *all = calloc((size_t)cube.cell_count, sizeof *all);
  for (int i = 0; i < 2; ++i) {
    const Groups groups = {i ? 3 : 17, i ? 3 : 17, 0, 20};
    uint64_t seed = 1;
    Part whole = group_part(fixture.context, &cube, all, 0, &groups, &seed);
    const TetcastCamera camera = camera_of(2.1, 1.7, 2.3, 0.5, 0.5, 0.5);
    TetcastFrame *one = frame_of(fixture.context, group_channels | TETCAST_CHANNEL_ERROR, group_count(&groups));
    render_whole(whole.scene, &camera, one);
    check_parts(fixture.context, &cube, CUT_SCATTER, 2, &groups, &camera, one, true);
    tetcast_frame_destroy(&one);
    part_end(&whole);
  }
  free(all);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* Rays through what parts share, along edges and through vertices: nothing is lost, or found twice. */
static void nothing_is_lost_between_parts(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  Cube cube = cube_create(4, 0);
  int *all = calloc((size_t)cube.cell_count, sizeof *all);
  const Groups groups = {2, 2, 2, 3};
  uint64_t seed = 1;
  Part whole = group_part(fixture.context, &cube, all, 0, &groups, &seed);
  for (int i = 0; i < repetitions(24); ++i) {
    const double *eye = cube.vertices + 3 * (i * 7 % cube.vertex_count),
                 *target = cube.vertices + 3 * (i * 31 % cube.vertex_count);
    TetcastCamera camera = i < 3 ? parallel(0.5, 0.5, 0.5, HEIGHT / 8.0)
                                 : camera_of(eye[0], eye[1], eye[2] + (i % 3 ? 2 : 0), target[0], target[1], target[2]);
    if (i < 3) {
      camera.eye[i] = 3;
      camera.up[0] = i == 1, camera.up[1] = i != 1;
    }
    TetcastFrame *one = frame_of(fixture.context, group_channels | TETCAST_CHANNEL_ERROR, 2);
    render_whole(whole.scene, &camera, one);
    check_parts(fixture.context, &cube, (Cut)(i % CUTS), 8, &groups, &camera, one, false);
    tetcast_frame_destroy(&one);
  }
  part_end(&whole);
  free(all);
  cube_destroy(&cube);
  fixture_end(&fixture);
}

/* ── one part ── */

static void set_world(World *world, const Groups *groups) {
  const int64_t most = world->cube.cell_count + world->cube.vertex_count;
  int64_t *ids = malloc((size_t)most * sizeof *ids);
  for (int64_t i = 0; i < most; ++i)
    ids[i] = i;
  set_groups(world->fixture.context, world->scene, groups, ids, world->cube.vertex_count, ids, world->cube.cell_count);
  free(ids);
}

/* In large and small units, emission as large and as small as numbers are, clipped, of rows of a larger picture: a
 * scene alone is its picture, channels as well; and others are left as they are. */
static void one_part_is_its_picture(void **state) {
  (void)state;
  static const struct {
    double unit;
    Groups groups;
  } cases[] = {{1000, {3, 3, 0, 2e-3}}, {1e-9, {10, 10, 2, 3e9}},    {1e9, {2, 2, 1, 1e-9}},     {1, {0, 3, 0, 1e307}},
               {1, {0, 9, 3, 1e-290}},  {0x1p-300, {1, 1, 0, 1e90}}, {0x1p300, {5, 5, 0, 1e-90}}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const double unit = cases[i].unit;
    const Groups *groups = &cases[i].groups;
    const int count = group_count(groups);
    World world;
    world_begin(&world, 4, 0.5, unit, TETCAST_TRAVERSAL_SHELL);
    TetcastContext *context = world.fixture.context;
    const TetcastHalfSpace plane = {{1, 0.3, 0.2}, 0.35 * unit};
    assert_int_equal(tetcast_scene_set_clip(world.scene, &plane, 1), TETCAST_OK);
    set_world(&world, groups);
    const TetcastCamera camera = camera_of(2.1 * unit, 1.7 * unit, 3.3 * unit, 0.5 * unit, 0.5 * unit, 0.5 * unit);
    TetcastRenderDesc desc = render_desc();
    desc.picture_height = 2 * HEIGHT;
    desc.first_row = HEIGHT / 2 + 3;
    TetcastFragments *fragments = NULL;
    TetcastFrame *one = frame_of(context, group_channels | TETCAST_CHANNEL_ERROR, count),
                 *all = frame_of(context, group_channels | TETCAST_CHANNEL_ERROR | TETCAST_CHANNEL_CELLS, count);
    assert_int_equal(tetcast_fragments_create(context, &fragments), TETCAST_OK);
    for (int twice = 0; twice < 2; ++twice)
      assert_int_equal(tetcast_scene_render_fragments(world.scene, &camera, &desc, WIDTH, HEIGHT, fragments, NULL),
                       TETCAST_OK);
    const TetcastFragmentList list = tetcast_fragments_list(fragments);
    assert_true(list.count > PIXELS / 4);
    assert_int_equal(tetcast_scene_render(world.scene, &camera, &desc, one, NULL), TETCAST_OK);
    assert_int_equal(tetcast_fragments_composite(context, &list, 1, all, NULL), TETCAST_OK);
    check_groups(one, all, groups->size * unit);
    for (int p = 0; p < PIXELS; ++p)
      assert_true(channel(all, TETCAST_CHANNEL_ERROR)[p] == 0 && channel(all, TETCAST_CHANNEL_CELLS)[p] == 0);
    tetcast_fragments_destroy(&fragments);
    tetcast_frame_destroy(&one);
    tetcast_frame_destroy(&all);
    world_end(&world);
  }
}

/* What lies behind an opaque part counts for the optical depth and the length, and for nothing else. */
static void opaque_parts_hide_and_count(void **state) {
  (void)state;
  World world;
  world_begin(&world, 5, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  const Groups groups = {2, 2, 0, 1e6};
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  set_world(&world, &groups);
  TetcastContext *context = world.fixture.context;
  TetcastFrame *one = frame_of(context, group_channels | TETCAST_CHANNEL_ERROR, 2),
               *all = frame_of(context, group_channels, 2);
  TetcastFragments *fragments = fragments_of(context, world.scene, &camera);
  const TetcastFragmentList list = tetcast_fragments_list(fragments);
  render_whole(world.scene, &camera, one);
  assert_int_equal(tetcast_fragments_composite(context, &list, 1, all, NULL), TETCAST_OK);
  check_groups(one, all, groups.size);
  tetcast_fragments_destroy(&fragments);
  tetcast_frame_destroy(&one);
  tetcast_frame_destroy(&all);
  world_end(&world);
}

/* The eye is in each of several tetrahedra, one in the other: all of its rays' fragments begin there, and the smaller
 * ones end first, though they were entered later. Extinction, 1 in group 0, keeps to its fragment. */
static void fragments_that_overlap_are_sorted(void **state) {
  (void)state;
  enum { NESTED = 24 };
  static const double corners[4][3] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  double vertices[4 * NESTED][3], ones[4 * NESTED], twos[4 * NESTED];
  int32_t cells[NESTED][4];
  for (int i = 0; i < 4 * NESTED; ++i) {
    for (int k = 0; k < 3; ++k)
      vertices[i][k] = corners[i % 4][k] * (NESTED - i / 4 * 0.9);
    cells[i / 4][i % 4] = i;
    ones[i] = 1;
    twos[i] = 2;
  }
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastContext *context = fixture.context;
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){vertices, TETCAST_TYPE_FLOAT64, 4 * NESTED, 0};
  desc.tetrahedra = (TetcastArray){cells, TETCAST_TYPE_INT32, NESTED, 0};
  TetcastMesh *mesh = NULL;
  Part part = {NULL, NULL};
  assert_int_equal(tetcast_mesh_create(context, &desc, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_volume_create(context, mesh, NULL, &part.volume), TETCAST_OK);
  assert_int_equal(tetcast_scene_create(context, part.volume, &part.scene), TETCAST_OK);
  TetcastField *fields[2] = {field_of(context, ones, 4 * NESTED, TETCAST_POINT),
                             field_of(context, twos, 4 * NESTED, TETCAST_POINT)};
  TetcastCoefficientsDesc coefficients = tetcast_coefficients_desc_default();
  coefficients.extinction = (const TetcastField *const *)fields;
  coefficients.extinction_count = 2;
  assert_int_equal(tetcast_scene_set_coefficients(part.scene, &coefficients), TETCAST_OK);
  const TetcastCamera camera = camera_of(0, 0, 0, 1, 0.2, 0.1);
  TetcastFragments *fragments = fragments_of(context, part.scene, &camera);
  const TetcastFragmentList list = tetcast_fragments_list(fragments);
  assert_int_equal(list.count, NESTED * PIXELS);
  for (int64_t i = 0; i < list.count; ++i) {
    const TetcastFragment *f = &list.data[i];
    const double length = f->end - f->begin;
    assert_int_equal(f->pixel, i / NESTED);
    if (i % NESTED)
      assert_true(f->begin == f[-1].begin && f->end > f[-1].end);
    assert_true(fabs(list.groups[4 * i + 1] - length) <= 5e-15 * NESTED);
    assert_true(fabs(list.groups[4 * i + 3] - 2 * length) <= 1e-14 * NESTED);
  }
  tetcast_fragments_destroy(&fragments);
  tetcast_field_destroy(&fields[0]);
  tetcast_field_destroy(&fields[1]);
  part_end(&part);
  tetcast_mesh_destroy(&mesh);
  fixture_end(&fixture);
}

/* ── compositing ── */

/* Fragments at one place, which their groups alone tell apart: whatever list they come in, and in which order. */
static void groups_decide_the_order(void **state) {
  (void)state;
  enum { SAME = 40, GROUPS = 3 };
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastFragment data[2][SAME];
  double groups[2][SAME][GROUPS][2];
  uint64_t seed = 5;
  for (int i = 0; i < SAME; ++i) {
    data[0][i] = data[1][SAME - 1 - i] = (TetcastFragment){.pixel = 3, .begin = 1, .end = 2};
    for (int k = 0; k < 2 * GROUPS; ++k) {
      const double value = k < 2 ? 0.25 : uniform(&seed); /* the first group doesn't */
      groups[0][i][k / 2][k % 2] = groups[1][SAME - 1 - i][k / 2][k % 2] = value;
    }
  }
  TetcastFrame *one = frame_of(fixture.context, group_channels, GROUPS),
               *other = frame_of(fixture.context, group_channels, GROUPS);
  for (int split = 0; split <= SAME; ++split) {
    const TetcastFragmentList whole = {data[0], SAME, &groups[0][0][0][0], GROUPS},
                              shared[3] = {{NULL, 0, NULL, 0},
                                           {data[1] + split, SAME - split, &groups[1][split % SAME][0][0], GROUPS},
                                           {data[1], split, &groups[1][0][0][0], GROUPS}};
    double overlap;
    assert_int_equal(tetcast_fragments_composite(fixture.context, &whole, 1, one, NULL), TETCAST_OK);
    assert_int_equal(tetcast_fragments_composite(fixture.context, shared, 3, other, &overlap), TETCAST_OK);
    assert_same(one, other, GROUPS);
    assert_true(overlap == 1 && channel(one, TETCAST_CHANNEL_PATH_LENGTH)[3] == SAME);
  }
  tetcast_frame_destroy(&one);
  tetcast_frame_destroy(&other);
  fixture_end(&fixture);
}

/* Two fragments by hand, in frames of both types; and none. */
static void composited_by_hand(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  static const TetcastFragment data[2] = {{.pixel = 7, .begin = -1, .end = 2}, {.pixel = 7, .begin = 3, .end = 4}};
  const double groups[2][3][2] = {{{1, 0.5}, {-2, 0}, {3, 1e4}}, {{10, 1}, {1, 2}, {(double)INFINITY, 5}}};
  const TetcastFragmentList list = {data, 2, &groups[0][0][0], 3};
  const double radiance[3] = {1 + 10 * exp(-0.5), -1, 3}, depth[3] = {1.5, 2, 1e4 + 5};
  for (int single = 0; single < 2; ++single) {
    TetcastFrameDesc desc = tetcast_frame_desc_default();
    desc.width = desc.height = 4;
    desc.channels = group_channels;
    desc.groups = 3;
    desc.type = single ? TETCAST_TYPE_FLOAT32 : TETCAST_TYPE_FLOAT64;
    TetcastFrame *frame = NULL;
    assert_int_equal(tetcast_frame_create(fixture.context, &desc, &frame), TETCAST_OK);
    for (int none = 0; none < 2; ++none) {
      double opacity = 0;
      assert_int_equal(tetcast_fragments_composite(fixture.context, &list, none ? 0 : 1, frame, NULL), TETCAST_OK);
      for (int g = 0; g < 3; ++g) {
        const TetcastArray of[3] = {{tetcast_frame_channel(frame, TETCAST_CHANNEL_RADIANCE), desc.type, 48, 0},
                                    {tetcast_frame_channel(frame, TETCAST_CHANNEL_OPTICAL_DEPTH), desc.type, 48, 0},
                                    {tetcast_frame_channel(frame, TETCAST_CHANNEL_TRANSMITTANCE), desc.type, 48, 0}};
        const double wanted[3] = {none ? 0 : radiance[g], none ? 0 : depth[g], none ? 1 : exp(-depth[g])};
        for (int k = 0; k < 3; ++k) {
          for (int p = 6; p < 8; ++p) { /* there is nothing in pixel 6 */
            const double value =
                single ? (double)((const float *)of[k].data)[3 * p + g] : ((const double *)of[k].data)[3 * p + g];
            const double expected = p == 7 ? wanted[k] : k == 2;
            assert_true(fabs(value - expected) <= (single ? 1e-7 : 1e-15) * fabs(expected));
          }
        }
        opacity += (1 - wanted[2]) / 3;
      }
      const double alpha = single ? (double)((const float *)tetcast_frame_pixels(frame))[31]
                                  : ((const double *)tetcast_frame_pixels(frame))[31];
      assert_true(fabs(alpha - opacity) < (single ? 1e-7 : 1e-15));
    }
    tetcast_frame_destroy(&frame);
  }
  fixture_end(&fixture);
}

static void refuse(Fixture *fixture, const TetcastFragmentList *lists, int64_t count, TetcastFrame *frame,
                   TetcastStatus status, const char *message) {
  assert_int_equal(tetcast_fragments_composite(fixture->context, lists, count, frame, NULL), status);
  assert_string_equal(fixture->message, message);
}

static void wrong_groups_are_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastFrame *frame = frame_of(fixture.context, group_channels, 2),
               *plain = frame_of(fixture.context, TETCAST_CHANNEL_PATH_LENGTH, 7);
  static const TetcastFragment data[2] = {{.pixel = 3, .begin = 1, .end = 2}, {.pixel = 4, .begin = 1, .end = 2}};
  double groups[2][2][2] = {{{1, 1}, {1, 1}}, {{1, 1}, {1, 1}}};
  TetcastFragmentList lists[2] = {{data, 2, &groups[0][0][0], 2}, {data, 2, &groups[0][0][0], 2}};
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 2, frame, NULL), TETCAST_OK);
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 2, plain, NULL), TETCAST_OK);
  lists[1].group_count = 1;
  refuse(&fixture, lists, 2, frame, TETCAST_ERROR_ARGUMENT, "fragments: list 0 has 2 groups, and list 1 has 1");
  lists[1].group_count = 0;
  refuse(&fixture, lists, 2, frame, TETCAST_ERROR_ARGUMENT, "fragments: list 0 has 2 groups, and list 1 has 0");
  lists[1].count = 0;
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 2, frame, NULL), TETCAST_OK);
  lists[0].group_count = 1;
  refuse(&fixture, lists, 1, frame, TETCAST_ERROR_ARGUMENT, "a frame of 2 groups, but the fragments have 1");
  lists[0].group_count = -1;
  refuse(&fixture, lists, 1, frame, TETCAST_ERROR_ARGUMENT, "fragments: list 0 has -1 groups");
  lists[0].group_count = TETCAST_MAX_GROUPS + 1;
  refuse(&fixture, lists, 1, frame, TETCAST_ERROR_ARGUMENT, "fragments: list 0 has 257 groups");
  lists[0].group_count = 2;
  lists[0].groups = NULL;
  refuse(&fixture, lists, 1, frame, TETCAST_ERROR_ARGUMENT, "fragments: list 0 has 2 groups, and no numbers of theirs");
  lists[0].groups = &groups[0][0][0];
  groups[1][1][0] = (double)NAN;
  refuse(&fixture, lists, 1, frame, TETCAST_ERROR_DATA,
         "fragment 1 of list 0: group 1 has radiance nan, optical depth 1");
  groups[1][1][0] = (double)INFINITY;
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 1, frame, NULL), TETCAST_OK);
  groups[1][0][1] = -1;
  refuse(&fixture, lists, 1, frame, TETCAST_ERROR_DATA,
         "fragment 1 of list 0: group 0 has radiance 1, optical depth -1");
  groups[1][0][1] = (double)NAN;
  assert_int_equal(tetcast_fragments_composite(fixture.context, lists, 1, frame, NULL), TETCAST_ERROR_DATA);
  tetcast_frame_destroy(&frame);
  tetcast_frame_destroy(&plain);
  fixture_end(&fixture);
}

/* ── memory ── */

/* The same object for one scene after the other, of other numbers of groups and with a transfer function: each time it
 * is as if it were new. */
static void fragments_are_used_again(void **state) {
  (void)state;
  World world;
  world_begin(&world, 4, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  TetcastContext *context = world.fixture.context;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  const TetcastRenderDesc desc = render_desc();
  TetcastTransferFunction *transfer = gray_of(context, 1);
  TetcastFragments *kept = NULL;
  assert_int_equal(tetcast_fragments_create(context, &kept), TETCAST_OK);
  set_values(&world, world.cube.values, TETCAST_POINT);
  static const int counts[] = {2, 9, 1, 0, 3, 3, 0, 20};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; ++i) {
    const Groups groups = {counts[i], counts[i], 0, 2};
    if (counts[i])
      set_world(&world, &groups);
    else
      assert_int_equal(tetcast_scene_set_transfer_function(world.scene, transfer), TETCAST_OK);
    assert_int_equal(tetcast_scene_render_fragments(world.scene, &camera, &desc, WIDTH, HEIGHT, kept, NULL),
                     TETCAST_OK);
    TetcastFragments *fresh = fragments_of(context, world.scene, &camera);
    const TetcastFragmentList a = tetcast_fragments_list(kept), b = tetcast_fragments_list(fresh);
    assert_true(a.count == b.count && a.count > PIXELS / 8 && a.group_count == counts[i] && !a.groups == !counts[i]);
    for (int64_t k = 0; k < a.count; ++k)
      assert_true(a.data[k].pixel == b.data[k].pixel && a.data[k].begin == b.data[k].begin);
    if (counts[i])
      assert_memory_equal(a.groups, b.groups, (size_t)(2 * counts[i] * a.count) * sizeof *a.groups);
    tetcast_fragments_destroy(&fresh);
  }
  tetcast_fragments_destroy(&kept);
  tetcast_transfer_function_destroy(&transfer);
  world_end(&world);
}

/* Wherever memory ends, the call says so, and nothing is lost. */
static void memory_may_end_anywhere(void **state) {
  (void)state;
  World world;
  world_begin(&world, 3, 0.5, 1, TETCAST_TRAVERSAL_SHELL);
  const Groups groups = {5, 5, 0, 2};
  const TetcastCamera camera = camera_of(2, 2, 3, 0.5, 0.5, 0.5);
  set_world(&world, &groups);
  TetcastFrame *frame = frame_of(world.fixture.context, group_channels, 5);
  run_out_of_memory(&world, &camera, WIDTH, HEIGHT, frame);
  tetcast_frame_destroy(&frame);
  world_end(&world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(groups_of_parts_are_those_of_the_whole),
      cmocka_unit_test(long_rays),
      cmocka_unit_test(nothing_is_lost_between_parts),
      cmocka_unit_test(one_part_is_its_picture),
      cmocka_unit_test(opaque_parts_hide_and_count),
      cmocka_unit_test(fragments_that_overlap_are_sorted),
      cmocka_unit_test(groups_decide_the_order),
      cmocka_unit_test(composited_by_hand),
      cmocka_unit_test(wrong_groups_are_refused),
      cmocka_unit_test(fragments_are_used_again),
      cmocka_unit_test(memory_may_end_anywhere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
