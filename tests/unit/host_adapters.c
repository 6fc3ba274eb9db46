/* SPDX-License-Identifier: Apache-2.0 */
/* The adapters in hosts with floating-point environments of their own: host.c for what is below the line. */
#define _GNU_SOURCE /* feenableexcept */
#include "support.h"

#include <fenv.h>
#include <unistd.h>

#ifdef __x86_64__
#include <xmmintrin.h>
#endif

#include <tetcast/dataset.h>
#include <tetcast/image.h>
#include <tetcast/surface.h>
#include <tetcast/tetgen.h>

typedef struct Host {
  const char *name;
  int rounding;
  bool traps, flushes;
} Host;

static const Host hosts[] = {{"ordinary", FE_TONEAREST, false, false},
                             {"traps", FE_TONEAREST, true, false},
                             {"upward", FE_UPWARD, false, false},
                             {"toward zero", FE_TOWARDZERO, false, true},
                             {"all of it", FE_DOWNWARD, true, true}};
enum { HOSTS = sizeof hosts / sizeof *hosts };

static const Host *host;
static uint64_t sum;

static void enter(void) {
  feclearexcept(FE_ALL_EXCEPT);
  fesetround(host->rounding);
#ifdef __x86_64__
  if (host->flushes)
    _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
  if (host->traps)
    feenableexcept(FE_ALL_EXCEPT);
}

static void leave(const char *call) {
  const int rounding = fegetround(), traps = fegetexcept(), flags = fetestexcept(FE_ALL_EXCEPT);
  fesetenv(FE_DFL_ENV);
  if (rounding != host->rounding || traps != (host->traps ? FE_ALL_EXCEPT : 0) || flags != 0) {
    fail_msg("%s, %s: rounding %d, traps %x, flags %x", host->name, call, rounding, (unsigned)traps, (unsigned)flags);
  }
}

#define IN_HOST(call)                                                                                                  \
  do {                                                                                                                 \
    enter();                                                                                                           \
    call;                                                                                                              \
    leave(#call);                                                                                                      \
  } while (0)

static void note(const void *data, size_t bytes) {
  const unsigned char *byte = data;
  for (size_t i = 0; i < bytes; ++i)
    sum = (sum ^ byte[i]) * UINT64_C(1099511628211);
}

static void note_mesh(const TetcastMesh *mesh) {
  for (int64_t i = 0; i < tetcast_mesh_vertex_count(mesh); ++i) {
    double p[3];
    tetcast_mesh_vertex(mesh, i, p);
    note(p, sizeof p);
  }
  for (int64_t i = 0; i < tetcast_mesh_tetrahedron_count(mesh); ++i) {
    int64_t v[4];
    tetcast_mesh_tetrahedron(mesh, i, v);
    note(v, sizeof v);
  }
}

static void note_file(const char *path) {
  unsigned char bytes[4096];
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  for (size_t n; (n = fread(bytes, 1, sizeof bytes, file)) > 0;)
    note(bytes, n);
  fclose(file);
}

static void surface_to_mesh(TetcastContext *context, const char *folder, TetcastMesh **mesh) {
  char path[256];
  snprintf(path, sizeof path, "%s/surface.off", folder);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs("OFF\n4 4 0\n0 0 0\n1.1 0 1e-3\n0 1.3 3.3e-5\n0.1 0.2 1.7\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n", file);
  fclose(file);
  TetcastSurface surface;
  TetcastStatus status;
  IN_HOST(status = tetcast_surface_read(context, path, &surface));
  assert_int_equal(status, TETCAST_OK);
  TetcastTetgenDesc desc = tetcast_tetgen_desc_default();
  desc.max_volume = 0.01;
  IN_HOST(status = tetcast_tetgen_mesh(context, &surface, &desc, mesh));
  assert_int_equal(status, TETCAST_OK);
  note_mesh(*mesh);
  tetcast_surface_release(&surface);
  unlink(path);
}

static void write_and_read(TetcastContext *context, const char *folder, const TetcastMesh *mesh) {
  const int64_t count = tetcast_mesh_vertex_count(mesh);
  double *values = malloc((size_t)count * sizeof *values);
  for (int64_t i = 0; i < count; ++i)
    values[i] = i % 7 == 0 ? (double)NAN : i % 5 == 0 ? 5e-324 * (double)i : sin((double)i);
  TetcastField *field = field_of(context, values, count, TETCAST_POINT);
  const char *const name = "values";
  const TetcastField *const fields = field;
  char path[256];
  snprintf(path, sizeof path, "%s/mesh.vtu", folder);
  TetcastStatus status;
  IN_HOST(status = tetcast_dataset_write(context, path, mesh, 1, &name, &fields));
  assert_int_equal(status, TETCAST_OK);
  note_file(path);
  TetcastDataset *dataset = NULL;
  IN_HOST(status = tetcast_dataset_read(context, path, NULL, &dataset));
  assert_int_equal(status, TETCAST_OK);
  TetcastMesh *again = NULL;
  TetcastField *values_again = NULL;
  IN_HOST(status = tetcast_dataset_mesh(dataset, &again));
  assert_int_equal(status, TETCAST_OK);
  IN_HOST(status = tetcast_dataset_field(dataset, "values", &values_again, NULL));
  assert_int_equal(status, TETCAST_OK);
  note_mesh(again);
  for (int64_t i = 0; i < count; ++i) {
    const double value = tetcast_field_value(values_again, i);
    note(&value, sizeof value);
    assert_memory_equal(&value, &values[i], sizeof value);
  }
  tetcast_field_destroy(&values_again);
  tetcast_mesh_destroy(&again);
  IN_HOST(tetcast_dataset_destroy(&dataset));
  tetcast_field_destroy(&field);
  unlink(path);
  free(values);
}

static void write_pictures(TetcastContext *context, const char *folder) {
  double pixels[16][16][4];
  for (int i = 0; i < 16 * 16; ++i) {
    const double alpha = i / 255.0;
    const double pixel[4] = {alpha * 0.3, alpha * 0.777, alpha, alpha};
    memcpy(pixels[i / 16][i % 16], pixel, sizeof pixel);
  }
  pixels[3][3][0] = 1e-310;
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = desc.height = 16;
  desc.pixels = pixels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  static const char *const names[] = {"picture.png", "picture.jpg", "picture.exr", "picture.tif"};
  for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, names[i]);
    TetcastStatus status;
    IN_HOST(status = tetcast_image_write(context, path, frame, NULL));
    assert_int_equal(status, TETCAST_OK);
    if (strcmp(names[i], "picture.tif") != 0)
      note_file(path); /* which has the time in it */
    unlink(path);
  }
  tetcast_frame_destroy(&frame);
}

static void any_floating_point_environment(void **state) {
  (void)state;
  char folder[] = "/tmp/tetcast-host-XXXXXX";
  assert_non_null(mkdtemp(folder));
  uint64_t wanted = 0;
  for (int h = 0; h < HOSTS; ++h) {
    host = &hosts[h];
    sum = UINT64_C(1469598103934665603);
    Fixture fixture;
    assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
    TetcastMesh *mesh = NULL;
    surface_to_mesh(fixture.context, folder, &mesh);
    write_and_read(fixture.context, folder, mesh);
    write_pictures(fixture.context, folder);
    tetcast_mesh_destroy(&mesh);
    fixture_end(&fixture);
    if (h == 0)
      wanted = sum;
    if (sum != wanted)
      fail_msg("%s: not the same bytes", host->name);
  }
  rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(any_floating_point_environment)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
