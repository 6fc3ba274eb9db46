/* SPDX-License-Identifier: Apache-2.0 */
/* The simulation's process stays as it is: its floating-point environment, locale, signals, files, threads and memory.
 */
#include "simulation.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fenv.h>
#include <getopt.h>
#include <locale.h>
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#define SIZE "\"size\": [64, 48]"
static const int three[3] = {3, 2, 2};
static const double nowhere[3] = {0, 0, 0};

static int run_body(const Body *body, int64_t number) {
  conduit_node *step = simulation_step(number);
  body_describe(body, NULL, simulation_mesh(step));
  return simulation_run(step);
}

static int entries_of(const char *folder) {
  DIR *entries = opendir(folder);
  int count = 0;
  while (readdir(entries))
    count++;
  closedir(entries);
  return count;
}

static bool is_loaded(const char *library) {
  char line[1024];
  bool found = false;
  FILE *maps = fopen("/proc/self/maps", "r");
  while (fgets(line, sizeof line, maps))
    found = found || strstr(line, library);
  fclose(maps);
  return found;
}

/* Data in memory need no VTK, and the image library is loaded for the first picture. */
static void what_is_loaded(void **state) {
  (void)state;
  Body *body = body_create(BODY_HEX, three, nowhere, 0.1);
  assert_int_equal(simulation_begin("{" SIZE "}", "l.##.png"), 0);
  assert_true(is_loaded("libcatalyst-tetcast"));
  assert_false(is_loaded("libOpenImageIO"));
  assert_int_equal(run_body(body, 0), 0);
  assert_true(is_loaded("libOpenImageIO"));
  assert_false(is_loaded("libvtk"));
  const int threads = entries_of("/proc/self/task"), files = entries_of("/proc/self/fd");
  for (int i = 1; i < 5; i++)
    assert_int_equal(run_body(body, i), 0);
  assert_int_equal(simulation_end(), 0);
  assert_int_equal(entries_of("/proc/self/task"), threads); /* those of the image library */
  assert_int_equal(entries_of("/proc/self/fd"), files);
  body_destroy(body);
}

static void floating_point(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  body->cells -= 6; /* a corner is of no cell, so that its mean is 0 / 0 */
  assert_int_equal(simulation_begin("{" SIZE ", \"array\": \"C\", \"cell_to_point\": true}", "plain.##.exr"), 0);
  assert_int_equal(run_body(body, 0), 0);
  assert_int_equal(simulation_end(), 0);
  conduit_node *step = simulation_step(0),
               *params = simulation_params("{" SIZE ", \"array\": \"C\", \"cell_to_point\": true}", "odd.##.exr");
  body_describe(body, NULL, simulation_mesh(step));
  fenv_t before;
  fegetenv(&before);
  int codes[3], round, flags, traps;
#if defined(__x86_64__)
  _mm_setcsr(_mm_getcsr() | 0x8040); /* denormal numbers are zero */
  const unsigned csr = 0x8040;
#endif
  fesetround(FE_UPWARD);
  feclearexcept(FE_ALL_EXCEPT);
  feraiseexcept(FE_UNDERFLOW);
  feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
  codes[0] = catalyst_initialize(params);
  codes[1] = catalyst_execute(step);
  codes[2] = catalyst_finalize(params);
  round = fegetround();
  flags = fetestexcept(FE_ALL_EXCEPT) & ~FE_INEXACT;
  traps = fegetexcept();
#if defined(__x86_64__)
  const unsigned now = _mm_getcsr() & 0x8040;
#endif
  fesetenv(&before);
  for (int i = 0; i < 3; i++)
    assert_int_equal(codes[i], 0);
  assert_int_equal(round, FE_UPWARD);
  assert_int_equal(flags, FE_UNDERFLOW);
  assert_int_equal(traps, FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
#if defined(__x86_64__)
  assert_int_equal(now, csr);
#endif
  simulation_compare("odd.00.exr", "plain.00.exr");
  conduit_node_destroy(step);
  conduit_node_destroy(params);
  body_forget();
  body_destroy(body);
}

static void handler(int signal_number) {
  (void)signal_number;
}

/* Whether the C library has it for itself. */
static bool of_system(int signal_number) {
  return signal_number >= 32 && signal_number < SIGRTMIN;
}

static void signals_and_the_rest(void **state) {
  (void)state;
  static const int last = 64;
  struct sigaction before[65], after;
  sigset_t blocked, mask;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  signal(SIGUSR1, handler);
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGUSR2);
  sigprocmask(SIG_SETMASK, &blocked, NULL);
  for (int i = 1; i <= last; i++)
    if (!of_system(i))
      sigaction(i, NULL, &before[i]);
  const locale_t locale = newlocale(LC_ALL_MASK, "C.UTF-8", (locale_t)0);
  const locale_t former = uselocale(locale);
  char *name = strdup(setlocale(LC_ALL, NULL)), place[4096];
  optind = 3;
  opterr = 1;
  assert_int_equal(simulation_begin("{" SIZE "}", "s.##.png"), 0);
  conduit_node *step = simulation_step(0);
  body_describe(body, NULL, simulation_mesh(step));
  errno = EDOM;
  assert_int_equal(catalyst_execute(step), 0);
  assert_int_equal(errno, EDOM);
  conduit_node_destroy(step);
  assert_int_equal(simulation_end(), 0);
  assert_int_equal(optind, 3);
  assert_int_equal(opterr, 1);
  assert_ptr_equal(uselocale((locale_t)0), locale);
  assert_string_equal(setlocale(LC_ALL, NULL), name);
  assert_non_null(getcwd(place, sizeof place));
  assert_non_null(strstr(place, "tetcast-catalyst"));
  sigprocmask(SIG_SETMASK, NULL, &mask);
  for (int i = 1; i <= last; i++) {
    if (of_system(i))
      continue;
    sigaction(i, NULL, &after);
    if (after.sa_handler != before[i].sa_handler)
      fail_msg("signal %d has another handler", i);
    assert_int_equal(sigismember(&mask, i), i == SIGUSR2);
  }
  sigemptyset(&blocked);
  sigprocmask(SIG_SETMASK, &blocked, NULL);
  uselocale(former);
  freelocale(locale);
  free(name);
  body_forget();
  body_destroy(body);
}

/* A full disk ends no simulation, nor does a file that is larger than the process may write. */
static void no_room_for_files(void **state) {
  (void)state;
  Body *body = body_create(BODY_TET, three, nowhere, 0.1);
  assert_int_equal(simulation_begin("{" SIZE "}", "big.##.png"), 0);
  assert_int_equal(run_body(body, 0), 0);
  conduit_node *step = simulation_step(1);
  const int entries = entries_of(".");
  body_describe(body, NULL, simulation_mesh(step));
  struct rlimit limit, low;
  getrlimit(RLIMIT_FSIZE, &limit);
  low = limit;
  low.rlim_cur = 100;
  setrlimit(RLIMIT_FSIZE, &low);
  const int output = dup(2), nothing = open("/dev/null", O_WRONLY);
  dup2(nothing, 2);
  const int code = catalyst_execute(step);
  dup2(output, 2);
  close(output);
  close(nothing);
  setrlimit(RLIMIT_FSIZE, &limit);
  assert_int_equal(code, 102);
  sigset_t pending;
  sigpending(&pending);
  assert_int_equal(sigismember(&pending, SIGXFSZ), 0);
  conduit_node_destroy(step);
  body_forget();
  assert_int_equal(access("big.01.png", F_OK), -1);
  assert_int_equal(entries_of("."), entries); /* nothing half-written */
  assert_int_equal(run_body(body, 2), 0);
  assert_int_equal(simulation_end(), 0);
  body_destroy(body);
}

/* The bytes that are in use after so many steps, with another mesh every `each` steps. */
static size_t use_of(Body *const bodies[2], int from, int to, int each) {
  for (int i = from; i < to; i++) {
    Body *body = bodies[i / each % 2];
    for (int64_t k = 0; k < body->points; k++)
      body->t[k] = (double)((k * 31 + i * 17) % 101);
    assert_int_equal(run_body(body, i % 3), 0);
  }
  return mallinfo2().uordblks;
}

/* Only the volume is kept from step to step: nothing grows. The bytes in use are exact, as main() has seen to it that
 * malloc() keeps no freed memory for each thread, which it would count as used. A volume of another mesh takes the
 * place of the one before; Embree keeps a few hundred bytes for each thread that has ever built one. */
static void a_thousand_steps(void **state) {
  (void)state;
  Body *bodies[2] = {body_create(BODY_TET, three, nowhere, 0.1), body_create(BODY_HEX, three, nowhere, 0.1)};
  assert_int_equal(simulation_begin("{\"size\": [16, 12], \"array\": \"T\"}", "k.png"), 0);
  const size_t before = use_of(bodies, 0, 200, 1 << 30), after = use_of(bodies, 200, 1200, 1 << 30);
  if (after > before + 1000) /* the least that malloc() gives is 32 bytes: not one step in thirty kept any */
    fail_msg("%zu bytes in use after 200 steps, %zu after 1000 more", before, after);
  const size_t built = use_of(bodies, 0, 20, 1), again = use_of(bodies, 20, 120, 1);
  if (again > built + 100 * 1024)
    fail_msg("%zu bytes in use after 20 meshes, %zu after 100 more", built, again);
  assert_int_equal(simulation_end(), 0);
  body_destroy(bodies[0]);
  body_destroy(bodies[1]);
}

/* Where memory runs out, that is said once, and the simulation goes on without pictures. In a process of its own, in
 * which nothing has been loaded yet. */
static void no_memory(void **state) {
  (void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  skip(); /* which need more address space than there is here */
#endif
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    Body *body = body_create(BODY_HEX, three, nowhere, 0.1);
    if (simulation_begin("{" SIZE ", \"quiet\": true}", "m.##.png") != 0 || run_body(body, 0) != 0)
      _exit(2);
    conduit_node *step = simulation_step(1);
    body_describe_grid(body, "uniform", simulation_mesh(step));
    conduit_node_set_path_int64(simulation_mesh(step), "coordsets/coords/dims/i", 1200);
    conduit_node_set_path_int64(simulation_mesh(step), "coordsets/coords/dims/j", 1200);
    conduit_node_set_path_int64(simulation_mesh(step), "coordsets/coords/dims/k", 1200); /* 41 GB */
    const struct rlimit limit = {8ll << 30, RLIM_INFINITY};
    if (setrlimit(RLIMIT_AS, &limit) != 0 || simulation_run(step) != 102)
      _exit(3);
    if (strcmp(said, "tetcast: error: out of memory: no further pictures are made\n"))
      _exit(4);
    if (run_body(body, 2) != 102 || *said || simulation_end() != 102 || *said)
      _exit(5);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    fail_msg("the process ended with %x", (unsigned)status);
}

int main(int count, char **arguments) {
  /* The C library reads this when a process begins. */
  if (count == 1 && !getenv("GLIBC_TUNABLES") && setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0", 1) == 0)
    execv("/proc/self/exe", arguments);
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_memory),         cmocka_unit_test(what_is_loaded),
                                     cmocka_unit_test(floating_point),    cmocka_unit_test(signals_and_the_rest),
                                     cmocka_unit_test(no_room_for_files), cmocka_unit_test(a_thousand_steps)};
  return cmocka_run_group_tests(tests, simulation_enter, simulation_leave);
}
