/* SPDX-License-Identifier: Apache-2.0 */
/* The moments of a segment with an emission of its own against quadrature in extended precision, over the whole range
 * of extinctions: dense and thin, rising and falling, from nothing and to nothing, nearly constant, about the border
 * between the formulas. One segment at a time, and by the kernels' code for each kind of lanes. */
#include "support.h"

#include <float.h>

#include "base/cpu.h"
#include "psi.h"

static void one_by_one(const double *a, const double *a1, int64_t count, TcSegment *segments, TcMoments *moments) {
  (void)segments;
  for (int64_t i = 0; i < count; ++i)
    moments[i] = tc_segment_moments(a[i], a1[i]);
}

static const struct {
  const char *name;
  TetcastIsa isa;
  PsiLanes *evaluate;
  double transmittance; /* bound on its error, relative to 1 + depth */
} kernels[] = {
    {"segment.c", TETCAST_ISA_SCALAR, one_by_one, 4e-16},
    {"scalar", TETCAST_ISA_SCALAR, psi_one, 6e-16},
#ifdef TC_HAVE_X86
    {"avx2", TETCAST_ISA_AVX2, psi_avx2, 6e-16},
    {"avx512", TETCAST_ISA_AVX512, psi_avx512, 6e-16},
#endif
};
enum { KERNELS = sizeof kernels / sizeof *kernels };

enum { NODES = 24 };
static long double node[NODES], weight[NODES];

/* Gauss–Legendre on [0, 1]. */
static void make_nodes(void) {
  const long double pi = 3.14159265358979323846264338327950288L;
  for (int i = 0; i < NODES; ++i) {
    long double x = cosl(pi * (i + 0.75L) / (NODES + 0.5L)), slope = 1;
    for (int step = 0; step < 60; ++step) {
      long double p0 = 1, p1 = x;
      for (int k = 2; k <= NODES; ++k) {
        const long double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = NODES * (x * p1 - p0) / (x * x - 1);
      x -= p1 / slope;
    }
    node[i] = (1 - x) / 2;
    weight[i] = 1 / ((1 - x * x) * slope * slope);
  }
}

/* Where the optical depth from the near end is `depth`. */
static long double place(long double a, long double b, long double depth) {
  const long double square = a * a + 2 * b * depth;
  const long double u = depth > 0 ? 2 * depth / (a + sqrtl(square > 0 ? square : 0)) : 0;
  return u < 1 ? u : 1;
}

/* ∫ (1 − u) e^−τ and ∫ u e^−τ, panel by panel of optical depth 1, up to where what is left is nothing beside them: they
 * are at least of the order of 1/(a + a1)². */
static void reference(double near, double far, long double m[2]) {
  const long double a = near, b = (long double)far - a, whole = ((long double)near + far) / 2;
  const long double stop = 60 + 2 * logl(1 + (long double)near + far);
  const int panels = (int)ceill(fminl(whole, stop)) + 1;
  const long double end = fminl(whole, stop);
  long double from = 0;
  m[0] = m[1] = 0;
  for (int i = 1; i <= panels; ++i) {
    const long double to = i == panels && end == whole ? 1 : place(a, b, end * i / panels), width = to - from;
    for (int k = 0; k < NODES; ++k) {
      const long double u = from + width * node[k], e = width * weight[k] * expl(-u * (a + b * u / 2));
      m[0] += (1 - u) * e;
      m[1] += u * e;
    }
    from = to;
  }
}

typedef struct Worst {
  double error, a, a1;
} Worst;

/* Below what a double can hold to full precision only the absolute error counts. */
static double relative(double value, long double wanted) {
  const long double size = wanted > DBL_MIN ? wanted : DBL_MIN;
  return (double)(fabsl((long double)value - wanted) / size);
}

enum { SAMPLES = 12000 };

typedef struct Sample {
  double a[SAMPLES], a1[SAMPLES];
  long double m[SAMPLES][2];
  TcMoments got[SAMPLES];
} Sample;

static void compare(const Sample *sample, int i, Worst worst[4]) {
  const double a = sample->a[i], a1 = sample->a1[i];
  const TcMoments got = sample->got[i];
  const long double depth = ((long double)a + a1) / 2;
  const double error[4] = {relative(got.m0, sample->m[i][0]), relative(got.m1, sample->m[i][1]),
                           relative(got.depth, depth),
                           relative(got.transmittance, expl(-depth)) / (1 + (double)fminl(depth, 1e4L))};
  for (int k = 0; k < 4; ++k) {
    if (!(error[k] <= worst[k].error))
      worst[k] = (Worst){error[k], a, a1};
  }
}

static void quadrature_agrees(void **state) {
  (void)state;
  static const double ratios[] = {0,   1e-300, 1e-30,    1e-8,     1e-3,      0.1,         0.5,
                                  0.9, 0.999,  1 - 1e-6, 1 - 1e-9, 1 - 1e-13, 1 - 0x1p-52, 1};
  static Sample sample;
  uint64_t seed = 5;
  make_nodes();
  long double half[2];
  reference(0, 0, half);
  assert_true(fabsl(half[0] - 0.5L) < 1e-18L && fabsl(half[1] - 0.5L) < 1e-18L);
  for (int i = 0; i < SAMPLES / 2; ++i) {
    /* A third about T = 1, where the formulas change, a third within what a double resolves, a third anywhere. */
    const double low = i % 3 == 0 ? -1 : i % 3 == 1 ? -17 : -323, high = i % 3 == 0 ? 1 : i % 3 == 1 ? 6 : 306.5;
    const double a = power(&seed, low, high);
    const size_t kind = (size_t)(uniform(&seed) * 20);
    const double a1 = kind < sizeof ratios / sizeof *ratios ? a * ratios[kind]
                      : kind < 17                           ? power(&seed, low, high)
                                                            : a * uniform(&seed);
    for (int turned = 0; turned < 2; ++turned) {
      const int at = 2 * i + turned;
      sample.a[at] = turned ? a1 : a;
      sample.a1[at] = turned ? a : a1;
      reference(sample.a[at], sample.a1[at], sample.m[at]);
    }
  }
  static const char *const name[4] = {"m0", "m1", "depth", "transmittance / (1 + depth)"};
  for (int kernel = 0; kernel < KERNELS; ++kernel) {
    if (!tc_cpu_has(kernels[kernel].isa))
      continue;
    Worst worst[4] = {{0, 0, 0}};
    kernels[kernel].evaluate(sample.a, sample.a1, SAMPLES, NULL, sample.got);
    for (int i = 0; i < SAMPLES; ++i)
      compare(&sample, i, worst);
    for (int k = 0; k < 4; ++k) {
      printf("%-10s %s: largest relative error %.2e at a = %a, a1 = %a\n", kernels[kernel].name, name[k],
             worst[k].error, worst[k].a, worst[k].a1);
    }
    assert_true(worst[0].error < 5e-15 && worst[1].error < 5e-15);
    assert_true(worst[2].error <= 0x1p-52 && worst[3].error < kernels[kernel].transmittance);
  }
}

static void without_extinction_it_is_the_mean(void **state) {
  (void)state;
  for (int kernel = 0; kernel < KERNELS; ++kernel) {
    if (!tc_cpu_has(kernels[kernel].isa))
      continue;
    const double zero = 0;
    TcMoments m;
    kernels[kernel].evaluate(&zero, &zero, 1, NULL, &m);
    assert_true(m.m0 == 0.5 && m.m1 == 0.5 && m.transmittance == 1 && m.depth == 0);
  }
}

/* Nothing is NaN, infinite or negative, and the two identities hold. */
static void extremes(void **state) {
  (void)state;
  static const double values[] = {0,   5e-324, 1e-308, 1e-300, 1e-160, 1e-20, 1e-8,  0.1,     0.5,
                                  1,   1.5,    2,      10,     700,    745,   746,   1500,    1e4,
                                  1e8, 1e16,   1e30,   1e154,  1e160,  1e300, 5e306, 1.7e308, INFINITY};
  enum { N = sizeof values / sizeof *values };
  double a[N * N], a1[N * N];
  TcMoments moments[N * N];
  for (int i = 0; i < N * N; ++i) {
    a[i] = values[i / N];
    a1[i] = values[i % N];
  }
  for (int kernel = 0; kernel < KERNELS; ++kernel) {
    if (!tc_cpu_has(kernels[kernel].isa))
      continue;
    kernels[kernel].evaluate(a, a1, N * N, NULL, moments);
    for (int i = 0; i < N * N; ++i) {
      const double near = fmin(a[i], TC_LARGEST_DENSITY), far = fmin(a1[i], TC_LARGEST_DENSITY);
      const TcMoments m = moments[i];
      const TcSegment s = tc_segment(fmin(near, 1e300), fmin(far, 1e300));
      assert_true(m.m0 >= 0 && m.m0 <= 0.5 && m.m1 >= 0 && m.m1 <= 0.5 && m.depth >= 0);
      if (kernel == 0)
        assert_true(isfinite(m.depth)); /* kernels cap densities themselves */
      assert_true(fabs(near * m.m0 + far * m.m1 - s.alpha) <= 4e-15 * s.alpha + DBL_MIN);
      assert_true(fabs(m.m0 + m.m1 - (s.w1 + s.transmittance)) <= 4e-15);
      assert_true(m.transmittance >= 0 && m.transmittance <= 1);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(quadrature_agrees),
                                     cmocka_unit_test(without_extinction_it_is_the_mean), cmocka_unit_test(extremes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
