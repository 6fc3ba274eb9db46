/* SPDX-License-Identifier: Apache-2.0 */
/* Hosts that are not ours: any floating-point environment, threads with small stacks, callbacks that must come from the
 * thread that called, and systems that let no further thread start. Each gets the same bits as an ordinary host. */
#define _GNU_SOURCE /* feenableexcept, RTLD_NEXT, MAP_ANONYMOUS */
#include "support.h"

#include <dlfcn.h>
#include <errno.h>
#include <fenv.h>
#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __x86_64__
#include <xmmintrin.h>
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED true
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED true
#endif
#endif
#ifndef SANITIZED
#define SANITIZED false
#endif

/* ── hosts' environments ── */

typedef struct Host {
  const char *name;
  int rounding;
  unsigned control;  /* bits of MXCSR to set: flush to zero, denormals are zero */
  bool traps, exact; /* traps; the x87 rounds to double, too */
} Host;

static const Host hosts[] = {
    {"ordinary", FE_TONEAREST, 0, false, false},     {"traps", FE_TONEAREST, 0, true, false},
    {"upward", FE_UPWARD, 0, false, false},          {"downward", FE_DOWNWARD, 0, false, false},
    {"toward zero", FE_TOWARDZERO, 0, false, false}, {"denormals are zero", FE_TONEAREST, 0x8040, false, false},
    {"all of it", FE_UPWARD, 0x8040, true, true},
};
enum { HOSTS = sizeof hosts / sizeof *hosts };

static const Host *current;
static int callbacks;

/* What of the environment has to be the same before and after a call. */
typedef struct Environment {
  unsigned mxcsr;
  unsigned short control, status;
  int rounding, traps, flags;
} Environment;

static Environment environment(void) {
  Environment e = {0};
#ifdef __x86_64__
  e.mxcsr = _mm_getcsr();
  __asm__ volatile("fnstcw %0" : "=m"(e.control));
  __asm__ volatile("fnstsw %0" : "=m"(e.status));
#endif
  e.rounding = fegetround();
  e.traps = fegetexcept();
  e.flags = fetestexcept(FE_ALL_EXCEPT);
  return e;
}

static Environment before;

/* Between these two nothing may be computed that a trap would notice. One flag is up already, and stays; the others
 * stay down. */
static void enter(void) {
  feclearexcept(FE_ALL_EXCEPT);
  fesetround(current->rounding);
#ifdef __x86_64__
  _mm_setcsr(_mm_getcsr() | current->control);
  if (current->exact) {
    unsigned short control;
    __asm__ volatile("fnstcw %0" : "=m"(control));
    control = (unsigned short)(control & ~0x100u);
    __asm__ volatile("fldcw %0" : : "m"(control));
  }
#endif
  if (current->traps)
    feenableexcept(FE_ALL_EXCEPT);
  else
    feraiseexcept(FE_OVERFLOW);
  before = environment();
}

static void leave(const char *call) {
  const Environment after = environment();
  fesetenv(FE_DFL_ENV);
  if (memcmp(&before, &after, sizeof after) != 0) {
    fail_msg("%s, %s: MXCSR %x, was %x; x87 %x %x, was %x %x; rounding %x, traps %x, flags %x", current->name, call,
             after.mxcsr, before.mxcsr, after.control, after.status, before.control, before.status,
             (unsigned)after.rounding, (unsigned)after.traps, (unsigned)after.flags);
  }
}

#define IN_HOST(call)                                                                                                  \
  do {                                                                                                                 \
    enter();                                                                                                           \
    call;                                                                                                              \
    leave(#call);                                                                                                      \
  } while (0)

static pthread_t caller;
static bool elsewhere, other_environment;

static void look(void) {
  const Environment now = environment();
  other_environment |= memcmp(&before, &now, sizeof now) != 0;
  elsewhere |= !pthread_equal(pthread_self(), caller);
  ++callbacks;
}

static bool on_progress(void *user, double fraction) {
  (void)user, (void)fraction;
  look();
  return true;
}

static void on_message(void *user, TetcastSeverity severity, const char *text) {
  (void)user, (void)severity, (void)text;
  look();
}

/* ── everything that the library does ── */

static uint64_t sum;

static void note(const void *data, size_t bytes) {
  const unsigned char *byte = data;
  for (size_t i = 0; i < bytes; ++i)
    sum = (sum ^ byte[i]) * UINT64_C(1099511628211);
}

enum { W = 40, H = 30 };

static void render(TetcastContext *context, TetcastScene *scene, const TetcastRenderDesc *given, uint32_t channels) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = W;
  desc.height = H;
  desc.channels = channels;
  desc.type = channels ? TETCAST_TYPE_FLOAT64 : TETCAST_TYPE_FLOAT32;
  TetcastFrame *frame = NULL;
  TetcastStatus status;
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  TetcastRenderDesc render_desc = *given;
  render_desc.progress.function = on_progress;
  IN_HOST(status = tetcast_frame_create(context, &desc, &frame));
  assert_int_equal(status, TETCAST_OK);
  TetcastRenderStats stats;
  IN_HOST(status = tetcast_scene_render(scene, &camera, &render_desc, frame, &stats));
  assert_int_equal(status, TETCAST_OK);
  note(tetcast_frame_pixels(frame), W * H * 4 * (channels ? sizeof(double) : sizeof(float)));
  for (uint32_t c = 1; c <= channels; c <<= 1) {
    if (channels & c)
      note(tetcast_frame_channel(frame, (TetcastChannel)c), W * H * sizeof(double));
  }
  if (channels & TETCAST_CHANNEL_ERROR)
    note(&stats.error, sizeof stats.error);
  IN_HOST(tetcast_frame_destroy(&frame));
}

static void all_kernels(TetcastContext *context, TetcastScene *scene) {
  for (int isa = TETCAST_ISA_SCALAR; isa <= TETCAST_ISA_AVX512; ++isa) {
    TetcastRenderDesc desc = tetcast_render_desc_default();
    desc.isa = (TetcastIsa)isa;
    render(context, scene, &desc, TETCAST_CHANNEL_ERROR);
    desc.tolerance = 0.01;
    desc.samples = 4;
    render(context, scene, &desc, 0);
  }
  for (int i = TETCAST_INTEGRATOR_MIDPOINT; i <= TETCAST_INTEGRATOR_TABLE; ++i) {
    TetcastRenderDesc desc = tetcast_render_desc_default();
    desc.integrator = (TetcastIntegrator)i;
    desc.integrator_n = 5;
    render(context, scene, &desc, 0);
  }
}

/* Cells of several kinds, and an array of what has to be looked up in them. */
static void cut(TetcastContext *context, const Cube *cube) {
  int64_t nodes[8 + 10 + 6] = {0, 1, 8, 7, 49, 50, 57, 56, 0, 2, 14, 98, 1, 8, 7, 49, 50, 56, 0, 1, 7, 49, 50, 56},
                         offsets[] = {0, 8, 18, 24};
  const uint8_t types[] = {TETCAST_CELL_HEXAHEDRON, TETCAST_CELL_QUADRATIC_TETRAHEDRON, TETCAST_CELL_WEDGE};
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices = (TetcastArray){cube->vertices, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  desc.connectivity = (TetcastArray){nodes, TETCAST_TYPE_INT64, 24, 0};
  desc.offsets = (TetcastArray){offsets, TETCAST_TYPE_INT64, 4, 0};
  desc.types = types;
  desc.subdivision = 3;
  TetcastCut *result = NULL;
  TetcastStatus status;
  IN_HOST(status = tetcast_cells_cut(context, &desc, &result));
  assert_int_equal(status, TETCAST_OK);
  TetcastCutInfo info;
  tetcast_cut_info(result, &info);
  note(&info, sizeof info);
  double *values = malloc((size_t)info.added_vertices * 3 * sizeof *values);
  bool ok;
  IN_HOST(ok = tetcast_cut_interpolate(result, &desc.vertices, 3, values));
  assert_true(ok && info.added_vertices > 0);
  note(values, (size_t)info.added_vertices * 3 * sizeof *values);
  free(values);
  IN_HOST(tetcast_cut_destroy(&result));
}

static void numbers(const TetcastMesh *mesh, const TetcastField *field) {
  double bounds[6], range[2], p[3], value;
  int64_t nonfinite;
  IN_HOST(tetcast_mesh_bounds(mesh, bounds));
  note(bounds, sizeof bounds);
  IN_HOST(tetcast_field_range(field, range, &nonfinite));
  note(range, sizeof range);
  note(&nonfinite, sizeof nonfinite);
  IN_HOST(tetcast_mesh_vertex(mesh, 77, p));
  note(p, sizeof p);
  for (int64_t i = 0; i < 4; ++i) {
    IN_HOST(value = tetcast_field_value(field, i));
    note(&value, sizeof value);
  }
  TetcastCamera camera;
  IN_HOST(camera = tetcast_camera_default(bounds, 0.7));
  note(camera.eye, sizeof camera.eye);
}

/* Integers that a double can't hold, and values that are no numbers: each is worth an exception. */
static void other_fields(TetcastContext *context, const TetcastMesh *mesh, const Cube *cube) {
  int64_t *integers = malloc((size_t)cube->cell_count * sizeof *integers);
  float *floats = malloc((size_t)cube->vertex_count * sizeof *floats);
  for (int64_t i = 0; i < cube->cell_count; ++i)
    integers[i] = (INT64_C(1) << 60) + i;
  for (int64_t i = 0; i < cube->vertex_count; ++i)
    floats[i] = i % 3 ? 1e-42F * (float)i : (float)i; /* denormal ones */
  uint32_t signalling = 0x7fa00000;
  memcpy(&floats[3], &signalling, sizeof signalling);
  TetcastFieldDesc desc = tetcast_field_desc_default();
  TetcastStatus status;
  for (int kind = 0; kind < 2; ++kind) {
    desc.values = kind ? (TetcastArray){floats, TETCAST_TYPE_FLOAT32, cube->vertex_count, 0}
                       : (TetcastArray){integers, TETCAST_TYPE_INT64, cube->cell_count, 0};
    desc.association = kind ? TETCAST_POINT : TETCAST_CELL;
    TetcastField *field = NULL;
    IN_HOST(status = tetcast_field_create(context, &desc, &field));
    assert_int_equal(status, TETCAST_OK);
    numbers(mesh, field);
    IN_HOST(tetcast_field_destroy(&field));
  }
  free(integers);
  free(floats);
}

static void everything(TetcastContext *context, const Cube *cube, TetcastTraversal traversal) {
  TetcastStatus status;
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){cube->vertices, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){cube->cells, TETCAST_TYPE_INT64, cube->cell_count, 0};
  TetcastMesh *mesh = NULL;
  IN_HOST(status = tetcast_mesh_create(context, &mesh_desc, &mesh));
  assert_int_equal(status, TETCAST_OK);
  TetcastMeshHealth health;
  IN_HOST(status = tetcast_mesh_health(context, mesh, &health));
  assert_int_equal(status, TETCAST_OK);
  note(&health, sizeof health);
  TetcastVolumeDesc volume_desc = tetcast_volume_desc_default();
  volume_desc.traversal = traversal;
  volume_desc.progress.function = on_progress;
  TetcastVolume *volume = NULL;
  IN_HOST(status = tetcast_volume_create(context, mesh, &volume_desc, &volume));
  assert_int_equal(status, TETCAST_OK);
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values = (TetcastArray){cube->values, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  TetcastField *field = NULL;
  IN_HOST(status = tetcast_field_create(context, &field_desc, &field));
  assert_int_equal(status, TETCAST_OK);
  TetcastScene *scene = NULL;
  IN_HOST(status = tetcast_scene_create(context, volume, &scene));
  assert_int_equal(status, TETCAST_OK);
  IN_HOST(status = tetcast_scene_set_field(scene, field));
  assert_int_equal(status, TETCAST_OK);
  numbers(mesh, field);
  other_fields(context, mesh, cube);
  cut(context, cube);
  TetcastTransferFunction *preset = NULL, *ramp = NULL;
  IN_HOST(status = tetcast_scene_create_preset(scene, "magma", 0, 1, &preset));
  assert_int_equal(status, TETCAST_OK);
  const double color[][4] = {{0, 1, 0.3, 0}, {0.4, 0, 1, 0}, {1, 0.5, 0.7, 1}},
               opacity[][2] = {{0.1, 0}, {0.45, 1e-3}, {0.5, 0.9}, {0.9, 1}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color[0];
  desc.opacity = opacity[0];
  desc.color_count = 3;
  desc.opacity_count = 4;
  desc.unit_distance = 0.3;
  IN_HOST(status = tetcast_transfer_function_create(context, &desc, &ramp));
  assert_int_equal(status, TETCAST_OK);
  IN_HOST(status = tetcast_scene_set_transfer_function(scene, preset));
  assert_int_equal(status, TETCAST_OK);
  all_kernels(context, scene);
  IN_HOST(status = tetcast_scene_set_transfer_function(scene, ramp));
  assert_int_equal(status, TETCAST_OK);
  all_kernels(context, scene);
  TetcastCoefficientsDesc coefficients = tetcast_coefficients_desc_default();
  coefficients.extinction = coefficients.emission = (const TetcastField *const *)&field;
  coefficients.extinction_count = coefficients.emission_count = 1;
  IN_HOST(status = tetcast_scene_set_coefficients(scene, &coefficients));
  assert_int_equal(status, TETCAST_OK);
  const TetcastRenderDesc defaults = tetcast_render_desc_default();
  render(context, scene, &defaults,
         TETCAST_CHANNEL_RADIANCE | TETCAST_CHANNEL_OPTICAL_DEPTH | TETCAST_CHANNEL_PATH_LENGTH);
  /* What is refused, with a message. */
  TetcastTransferFunction *none = NULL;
  desc.unit_distance = (double)NAN;
  IN_HOST(status = tetcast_transfer_function_create(context, &desc, &none));
  assert_int_equal(status, TETCAST_ERROR_ARGUMENT);
  IN_HOST(status = tetcast_scene_create_preset(scene, "magma", (double)NAN, 1, &none));
  assert_int_equal(status, TETCAST_ERROR_ARGUMENT);
  IN_HOST(tetcast_context_message(context, TETCAST_SEVERITY_INFO, "%s", "a message"));
  IN_HOST(tetcast_scene_destroy(&scene));
  IN_HOST(tetcast_transfer_function_destroy(&preset));
  IN_HOST(tetcast_transfer_function_destroy(&ramp));
  IN_HOST(tetcast_field_destroy(&field));
  IN_HOST(tetcast_volume_destroy(&volume));
  IN_HOST(tetcast_mesh_destroy(&mesh));
}

/* A cube with slivers, cells of no volume, one twice, and values that are not numbers. Embree builds on several threads
 * where there are many cells. */
static Cube bad_cube(int n) {
  Cube cube = cube_create(n, 0.9);
  cube.cells[0] = cube.cells[1];
  memcpy(&cube.cells[8], &cube.cells[12], 4 * sizeof *cube.cells);
  memcpy(&cube.vertices[3 * 60], &cube.vertices[3 * 61], 3 * sizeof *cube.vertices);
  cube.values[100] = (double)NAN;
  cube.values[101] = INFINITY;
  cube.values[102] = 5e-324;
  return cube;
}

static TetcastContext *context_with(int threads) {
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.threads = threads;
  desc.message = on_message;
  TetcastContext *context = NULL;
  TetcastStatus status;
  IN_HOST(status = tetcast_context_create(&desc, &context));
  assert_int_equal(status, TETCAST_OK);
  return context;
}

static uint64_t all_results(int threads, TetcastTraversal traversal, int n) {
  caller = pthread_self();
  sum = UINT64_C(1469598103934665603);
  Cube cube = bad_cube(n);
  TetcastContext *context = context_with(threads);
  everything(context, &cube, traversal);
  IN_HOST(tetcast_context_destroy(&context));
  cube_destroy(&cube);
  return sum;
}

static void any_floating_point_environment(void **state) {
  (void)state;
  for (int traversal = 0; traversal < 2; ++traversal) {
    current = &hosts[0];
    const uint64_t wanted = all_results(2, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 6);
    for (int h = 0; h < HOSTS; ++h) {
      current = &hosts[h];
      callbacks = 0;
      elsewhere = other_environment = false;
      const uint64_t got = all_results(1 + h % 3, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, 6);
      if (got != wanted)
        fail_msg("%s: not the same bits", current->name);
      assert_true(callbacks > 3);
      if (other_environment)
        fail_msg("%s: a callback was called in another environment than the host's", current->name);
      if (elsewhere)
        fail_msg("%s: a callback was called from another thread", current->name);
    }
  }
  current = &hosts[0];
}

/* ── threads that can't be started ── */

static atomic_long started, refused_from, of_others;
static bool counting;

/* In the place of the system's for the whole process: from some number on there is no thread to be had. */
__attribute__((visibility("default"))) int pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                                                          void *(*function)(void *), void *data) {
  static int (*real)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
  if (!real) {
    void *symbol = dlsym(RTLD_NEXT, "pthread_create");
    memcpy(&real, &symbol, sizeof real);
  }
  if (counting) {
    const long number = atomic_fetch_add(&started, 1);
    Dl_info info;
    if (dladdr(__builtin_return_address(0), &info) && info.dli_fname && !strstr(info.dli_fname, "tetcast"))
      atomic_fetch_add(&of_others, 1);
    if (number >= atomic_load(&refused_from))
      return EAGAIN;
  }
  return real(thread, attributes, function, data);
}

/* Many cells in Embree, which several threads build then, and a picture. */
static uint64_t one_picture(int threads, TetcastTraversal traversal, int n) {
  caller = pthread_self();
  sum = UINT64_C(1469598103934665603);
  TetcastContext *context = context_with(threads);
  Cube cube = cube_create(n, 0.5);
  Body body = cube_body(context, &cube, traversal);
  TetcastTransferFunction *transfer = transfer_of(context, 1);
  const TetcastCamera camera = camera_of(2.1, 1.7, 3.3, 0.5, 0.5, 0.5);
  double *pixels = picture(context, &body, transfer, &camera, W, H, NULL);
  note(pixels, W * H * 4 * sizeof *pixels);
  free(pixels);
  tetcast_transfer_function_destroy(&transfer);
  body_destroy(&body);
  cube_destroy(&cube);
  tetcast_context_destroy(&context);
  return sum;
}

typedef uint64_t Results(int threads, TetcastTraversal traversal, int n);

static void refuse_threads(Results *results, TetcastTraversal traversal, int n) {
  atomic_store(&refused_from, 1L << 60);
  atomic_store(&started, 0);
  counting = true;
  const uint64_t wanted = results(3, traversal, n);
  const long all = atomic_load(&started);
  assert_true(all > 10);
  for (long from = 0; from <= all + 1; from += from < 12 ? 1 : all / 5) {
    atomic_store(&refused_from, from);
    atomic_store(&started, 0);
    if (results(3, traversal, n) != wanted)
      fail_msg("another result where thread %ld of %ld can't be started", from, all);
  }
  counting = false;
}

static void threads_may_be_refused(void **state) {
  (void)state;
  current = &hosts[0];
  refuse_threads(all_results, TETCAST_TRAVERSAL_SHELL, 5);
  refuse_threads(one_picture, TETCAST_TRAVERSAL_FACES, 24);
  assert_int_equal(atomic_load(&of_others), 0); /* TBB starts none, in any case */
}

/* ── small stacks ── */

enum { STACK = 2 << 20, ALLOWED = 32 << 10, ALLOWED_ALONE = 256 << 10 };

static void *measured(void *data) {
  Cube cube = *(Cube *)data;
  TetcastContext *context = context_with(2);
  everything(context, &cube, TETCAST_TRAVERSAL_SHELL);
  everything(context, &cube, TETCAST_TRAVERSAL_FACES);
  tetcast_context_destroy(&context);
  return NULL;
}

static void *measured_alone(void *data) {
  atomic_store(&refused_from, 0);
  counting = true;
  measured(data);
  counting = false;
  return NULL;
}

/* Paints a stack, and looks how much of the paint is gone. The test's own functions are on it, too. */
static size_t stack_of(void *(*function)(void *)) {
  current = &hosts[0];
  Cube cube = bad_cube(6);
  unsigned char *stack = mmap(NULL, STACK, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  assert_true(stack != MAP_FAILED);
  memset(stack, 0xa5, STACK);
  pthread_attr_t attributes;
  pthread_t thread;
  pthread_attr_init(&attributes);
  assert_int_equal(pthread_attr_setstack(&attributes, stack, STACK), 0);
  assert_int_equal(pthread_create(&thread, &attributes, function, &cube), 0);
  pthread_join(thread, NULL);
  pthread_attr_destroy(&attributes);
  size_t free_bytes = 0;
  while (free_bytes < STACK && stack[free_bytes] == 0xa5)
    ++free_bytes;
  munmap(stack, STACK);
  cube_destroy(&cube);
  return STACK - free_bytes;
}

static void little_of_the_callers_stack(void **state) {
  (void)state;
  const size_t bytes = stack_of(measured), alone = stack_of(measured_alone);
  printf("%zu bytes of the caller's stack, %zu where no thread may start\n", bytes, alone);
  assert_true(bytes > 1024);
  if (!SANITIZED)
    assert_true(bytes < ALLOWED && alone < ALLOWED_ALONE);
}

/* ── memory that the system refuses beneath the library ── */

static atomic_long allocations, failing; /* number of the allocation that fails, 0: none … */
static atomic_bool all_from;             /* … and all after it */

#if !SANITIZED && defined(__GLIBC__)
#define REFUSES_MEMORY              true
#define IN_THE_PLACE_OF_THE_SYSTEMS __attribute__((visibility("default")))

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static bool refused(void) {
  const long number = atomic_load(&failing);
  if (number == 0)
    return false;
  const long mine = atomic_fetch_add(&allocations, 1) + 1;
  if (mine != number && !(mine > number && atomic_load(&all_from)))
    return false;
  errno = ENOMEM;
  return true;
}

IN_THE_PLACE_OF_THE_SYSTEMS void *malloc(size_t size) {
  return refused() ? NULL : __libc_malloc(size);
}
IN_THE_PLACE_OF_THE_SYSTEMS void *calloc(size_t count, size_t size) {
  return refused() ? NULL : __libc_calloc(count, size);
}
IN_THE_PLACE_OF_THE_SYSTEMS void *realloc(void *memory, size_t size) {
  return size && refused() ? NULL : __libc_realloc(memory, size);
}
IN_THE_PLACE_OF_THE_SYSTEMS void *memalign(size_t alignment, size_t size) {
  return refused() ? NULL : __libc_memalign(alignment, size);
}
IN_THE_PLACE_OF_THE_SYSTEMS void *aligned_alloc(size_t alignment, size_t size) {
  return memalign(alignment, size);
}
IN_THE_PLACE_OF_THE_SYSTEMS int posix_memalign(void **result, size_t alignment, size_t size) {
  void *memory = memalign(alignment, size);
  if (!memory)
    return ENOMEM;
  *result = memory;
  return 0;
}
#else
#define REFUSES_MEMORY false
#endif

static void *own_allocate(void *user, size_t size, size_t alignment) {
  (void)user, (void)alignment;
  return mmap(NULL, size + 64, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
              0); /* which is not refused here, or leaks as it likes */
}

static void own_release(void *user, void *memory) {
  (void)user, (void)memory;
}

/* Prepares a volume, once more if that fails, and renders it. The status of the first time. */
static TetcastStatus prepare_and_render(const Cube *cube, int threads, bool own_memory) {
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.threads = threads;
  if (own_memory)
    desc.allocate = own_allocate, desc.release = own_release;
  TetcastContext *context = NULL;
  TetcastMesh *mesh = NULL;
  TetcastVolume *volume = NULL;
  TetcastStatus status = tetcast_context_create(&desc, &context);
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices = (TetcastArray){cube->vertices, TETCAST_TYPE_FLOAT64, cube->vertex_count, 0};
  mesh_desc.tetrahedra = (TetcastArray){cube->cells, TETCAST_TYPE_INT64, cube->cell_count, 0};
  mesh_desc.ownership = TETCAST_BORROW;
  TetcastVolumeDesc volume_desc = tetcast_volume_desc_default();
  volume_desc.traversal = TETCAST_TRAVERSAL_FACES;
  if (!status)
    status = tetcast_mesh_create(context, &mesh_desc, &mesh);
  if (!status)
    status = tetcast_volume_create(context, mesh, &volume_desc, &volume);
  atomic_store(&failing, 0);
  if (status && own_memory && tetcast_volume_create(context, mesh, &volume_desc, &volume) != TETCAST_OK)
    status = TETCAST_STATUS_COUNT;
  tetcast_volume_destroy(&volume);
  tetcast_mesh_destroy(&mesh);
  tetcast_context_destroy(&context);
  return status;
}

/* In a child: its address space may grow by so much (0: without limit), and this allocation fails. Its status, or −1 if
 * it was ended by a signal. */
static int status_in_child(const Cube *cube, int threads, size_t room, long number, bool and_all_after) {
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    if (freopen("/dev/null", "w", stderr) == NULL)
      _exit(65); /* where terminate() would say why */
    if (room) {
      long pages = 0;
      FILE *file = fopen("/proc/self/statm", "r");
      if (!file || fscanf(file, "%ld", &pages) != 1)
        _exit(65);
      fclose(file);
      const rlim_t limit = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + room;
      setrlimit(RLIMIT_AS, &(struct rlimit){limit, limit});
    }
    atomic_store(&allocations, 0);
    atomic_store(&all_from, and_all_after);
    atomic_store(&failing, number);
    _exit((int)prepare_and_render(cube, threads, number > 0));
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void address_space_may_be_short(void **state) {
  (void)state;
  if (SANITIZED)
    skip(); /* which need an address space of their own */
  Cube cube = cube_create(20, 0.3);
  for (int threads = 1; threads <= 2; ++threads) {
    int refusals = 0;
    bool enough = false;
    for (size_t room = 1 << 20; !enough; room += room / 8) {
      const int status = status_in_child(&cube, threads, room, 0, false);
      if (status != TETCAST_OK && status != TETCAST_ERROR_MEMORY)
        fail_msg("with %zu bytes and %d threads: status %d", room, threads, status);
      refusals += status == TETCAST_ERROR_MEMORY;
      enough = status == TETCAST_OK;
      assert_true(room < (size_t)1 << 31);
    }
    assert_true(refusals > 8);
  }
  cube_destroy(&cube);
}

/* Every allocation of Embree's and of TBB's, but for those that TBB makes once in a process, which is done before.
 * Where all that come after fail as well, Embree may end the process in two calls, by what it notes a thread's errors
 * in (volume.h). */
static void allocations_beneath_may_fail(void **state) {
  (void)state;
  if (!REFUSES_MEMORY)
    skip();
  Cube cube = cube_create(4, 0.3);
  assert_int_equal(prepare_and_render(&cube, 1, true), TETCAST_OK);
  for (int and_all_after = 0; and_all_after < 2; ++and_all_after) {
    int ended = 0, refusals = 0, in_a_row = 0;
    long number = 0;
    while (in_a_row < 20) { /* beyond the last */
      const int status = status_in_child(&cube, 1, 0, ++number, and_all_after);
      ended += status == -1;
      refusals += status == TETCAST_ERROR_MEMORY;
      in_a_row = status == TETCAST_OK ? in_a_row + 1 : 0;
      if (status > 0 && status != TETCAST_ERROR_MEMORY)
        fail_msg("allocation %ld%s: status %d", number, and_all_after ? " and all after" : "", status);
    }
    printf("%ld allocations%s: %d refusals reported, %d times ended\n", number - 20,
           and_all_after ? " and all after" : "", refusals, ended);
    assert_true(refusals > 20);
    assert_true(ended <= 4 * and_all_after);
  }
  cube_destroy(&cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(address_space_may_be_short), cmocka_unit_test(allocations_beneath_may_fail),
      cmocka_unit_test(any_floating_point_environment), cmocka_unit_test(threads_may_be_refused),
      cmocka_unit_test(little_of_the_callers_stack)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
