/* SPDX-License-Identifier: Apache-2.0 */
/* The one predicate of the traversal: exact signs, antisymmetric, and consistent where everything degenerates; by each
 * kind of lanes. */
#include "support.h"

#include <float.h>

#include "base/cpu.h"
#include "edge_lanes.h"

__extension__ typedef __int128 Wide;

static const struct {
  const char *name;
  TetcastIsa isa;
  EdgeLanes *edges;
  int digits; /* of coordinates */
} kernels[] = {
    {"scalar", TETCAST_ISA_SCALAR, edge_one, 53},
#ifdef TC_HAVE_X86
    {"avx2", TETCAST_ISA_AVX2, edge_avx2, 53},         {"avx512", TETCAST_ISA_AVX512, edge_avx512, 53},
    {"avx2_f32", TETCAST_ISA_AVX2, edge_avx2_f32, 24}, {"avx512_f32", TETCAST_ISA_AVX512, edge_avx512_f32, 24},
#endif
};
enum { KERNELS = sizeof kernels / sizeof *kernels };

static EdgePoint point(double x, double y, uint32_t id) {
  return (EdgePoint){.x = x, .y = y, .id = id};
}

static void sign_is_exact(void **state) {
  (void)state;
  for (int kernel = 0; kernel < KERNELS; ++kernel) {
    if (!tc_cpu_has(kernels[kernel].isa))
      continue;
    /* (1 + ε)(1 − ε) − 1 = −ε², lost in rounded products */
    const double e = kernels[kernel].digits > 24 ? 0x1p-40 : 0x1p-20;
    const EdgePoint a[2] = {point(1 + e, 1, 0), point(1, 1 - e, 1)}, b[2] = {a[1], a[0]};
    double edge[2];
    kernels[kernel].edges(a, b, 2, edge);
    assert_true(edge[0] < 0 && edge[1] > 0);
    if (kernels[kernel].digits <= 24)
      continue; /* whose coordinates are whole numbers */
    const EdgePoint c[2] = {point(0x1p-406 * 3, 0x1p-406, 0), point(0x1p-406 * 9, 0x1p-406 * 3, 1)},
                    d[2] = {c[1], c[0]};
    kernels[kernel].edges(c, d, 2, edge);
    assert_true(edge[0] == -edge[1] &&
                edge[0] != 0); /* collinear with the ray: decided, and the same from both sides */
  }
}

/* A random whole number of at most this many digits, most of them near the largest. */
static double whole(uint64_t *seed, int digits) {
  const double size = ldexp(1, digits - (uniform(seed) < 0.3 ? (int)(uniform(seed) * digits) : 0));
  return trunc((2 * uniform(seed) - 1) * size);
}

/* Points of which many are nearly, and some exactly, on a line with the ray: against integers of 128 bits. */
static void edges_are_accurate(void **state) {
  (void)state;
  enum { COUNT = 200000 };
  EdgePoint *a = malloc(COUNT * sizeof *a), *b = malloc(COUNT * sizeof *b);
  double *edge = malloc(COUNT * sizeof *edge), *back = malloc(COUNT * sizeof *back);
  for (int kernel = 0; kernel < KERNELS; ++kernel) {
    if (!tc_cpu_has(kernels[kernel].isa))
      continue;
    const int digits = kernels[kernel].digits;
    const double least = digits > 24 ? DBL_MIN : FLT_MIN;
    uint64_t seed = 8;
    int cancelled = 0, ties = 0;
    double worst = 0;
    for (int i = 0; i < COUNT; ++i) {
      a[i] = point(whole(&seed, digits), whole(&seed, digits), (uint32_t)(i & 1));
      b[i] = point(whole(&seed, digits), whole(&seed, digits), (uint32_t)(~i & 1));
      const double factor = uniform(&seed);
      if (i % 4 == 1)
        b[i].x = trunc(a[i].x * factor), b[i].y = trunc(a[i].y * factor); /* nearly on a line */
      if (i % 4 == 2) { /* one step beside a line through both: the products differ by few units or by nothing */
        const double x = trunc(whole(&seed, digits / 2)), y = trunc(whole(&seed, digits / 2)),
                     n = 1 + trunc(7 * uniform(&seed));
        a[i].x = x * n, a[i].y = y * n;
        b[i].x = x * (n + 1), b[i].y = y * (n + 1) + (i % 8 == 2);
      }
    }
    kernels[kernel].edges(a, b, COUNT, edge);
    kernels[kernel].edges(b, a, COUNT, back);
    for (int i = 0; i < COUNT; ++i) {
      const Wide exact = (Wide)a[i].x * (Wide)b[i].y - (Wide)a[i].y * (Wide)b[i].x;
      assert_true(edge[i] != 0 && (edge[i] > 0) == (back[i] < 0));
      if (exact == 0) {
        assert_true(fabs(edge[i]) == least);
        ++ties;
        continue;
      }
      assert_true((edge[i] > 0) == (exact > 0));
      const long double off = fabsl((long double)edge[i] / (long double)exact - 1);
      worst = fmax(worst, (double)ldexpl(off, digits));
      const double product = fabs(a[i].x * b[i].y);
      cancelled += fabs(edge[i]) < ldexp(product, 4 - digits);
    }
    printf("%-10s relative error up to %.2f · 2^-%d, %d of %d nearly cancelled, %d ties\n", kernels[kernel].name, worst,
           digits, cancelled, (int)COUNT, ties);
    assert_true(worst <= 4 && cancelled > COUNT / 50 && ties > COUNT / 50);
  }
  free(a), free(b), free(edge), free(back);
}

enum { FACES = 4, EDGES = 3 };

static bool is_inside(const double edge[EDGES]) {
  return (edge[0] > 0) == (edge[1] > 0) && (edge[1] > 0) == (edge[2] > 0);
}

/* For any four points of a small integer grid — nearly all configurations are degenerate — the ray crosses none or
 * exactly two faces of the tetrahedron. */
static void every_tetrahedron_has_a_way_through(void **state) {
  (void)state;
  enum { COUNT = 100000, ALL = COUNT * FACES * EDGES };
  EdgePoint(*p)[4] = malloc(COUNT * sizeof *p), *a = malloc(ALL * sizeof *a), *b = malloc(ALL * sizeof *b);
  double *edge = malloc(ALL * sizeof *edge), *back = malloc(ALL * sizeof *back);
  uint64_t seed = 1;
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < COUNT; ++i) {
      for (int k = 0; k < 4; ++k)
        p[i][k] = point(floor(uniform(&seed) * 3) - 1, floor(uniform(&seed) * 3) - 1, (uint32_t)k);
      if (i & 1) { /* ids in another order */
        p[i][0].id = 3;
        p[i][3].id = 0;
      }
      for (int k = 0; k < FACES; ++k) {
        for (int j = 0; j < EDGES; ++j) {
          const int at = (i * FACES + k) * EDGES + j;
          a[at] = p[i][(k + j) & 3];
          b[at] = p[i][(k + (j + 1) % 3) & 3];
        }
      }
    }
    for (int kernel = 0; kernel < KERNELS; ++kernel) {
      if (!tc_cpu_has(kernels[kernel].isa))
        continue;
      int crossed = 0;
      kernels[kernel].edges(a, b, ALL, edge);
      kernels[kernel].edges(b, a, ALL, back);
      for (int i = 0; i < ALL; ++i)
        assert_true(edge[i] != 0 && edge[i] == -back[i]);
      for (int i = 0; i < COUNT; ++i) {
        int faces = 0;
        for (int k = 0; k < FACES; ++k) {
          const double *e = &edge[(i * FACES + k) * EDGES];
          if (!is_inside(e))
            continue;
          ++faces;
          assert_true(fabs(e[0] + e[1] + e[2]) >= 1); /* never a face seen edge-on: there is something to divide by */
        }
        if (faces != 0 && faces != 2) {
          fail_msg("%s: %d faces crossed: (%g,%g) (%g,%g) (%g,%g) (%g,%g)", kernels[kernel].name, faces, p[i][0].x,
                   p[i][0].y, p[i][1].x, p[i][1].y, p[i][2].x, p[i][2].y, p[i][3].x, p[i][3].y);
        }
        crossed += faces == 2;
      }
      assert_true(crossed > COUNT / 20);
    }
  }
  free(p), free(a), free(b), free(edge), free(back);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sign_is_exact),
      cmocka_unit_test(edges_are_accurate),
      cmocka_unit_test(every_tetrahedron_has_a_way_through),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
