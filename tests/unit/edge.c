/* SPDX-License-Identifier: Apache-2.0 */
/* The one predicate of the traversal: exact signs, antisymmetric, and consistent where everything degenerates. */
#include "support.h"

#include "traverse/rayspace.h"

static TcPoint point(double x, double y, uint32_t id) { return (TcPoint){.x = x, .y = y, .id = id}; }

static void sign_is_exact(void **state) {
  (void)state;
  /* (1 + ε)(1 − ε) − 1 = −ε², lost in rounded products */
  const double e = 0x1p-40;
  const TcPoint a = point(1 + e, 1, 0), b = point(1, 1 - e, 1);
  assert_true(tc_edge(&a, &b) < 0);
  assert_true(tc_edge(&b, &a) > 0);
  const TcPoint c = point(0x1p-406 * 3, 0x1p-406, 0), d = point(0x1p-406 * 9, 0x1p-406 * 3 - 0, 1);
  assert_true(tc_edge(&c, &d) == -tc_edge(&d, &c)); /* collinear with the ray: decided, and the same from both sides */
}

/* For any four points of a small integer grid — nearly all configurations are degenerate — the ray crosses none or exactly two faces of
 * the tetrahedron, and from the one it enters by, the signs name the other. */
static void every_tetrahedron_has_a_way_through(void **state) {
  (void)state;
  uint64_t seed = 1;
  int crossed = 0;
  for (int i = 0; i < 2000000; ++i) {
    TcPoint p[4];
    for (int k = 0; k < 4; ++k) p[k] = point(floor(uniform(&seed) * 3) - 1, floor(uniform(&seed) * 3) - 1, (uint32_t)k);
    if (i & 1) { /* ids in another order */
      p[0].id = 3;
      p[3].id = 0;
    }
    int faces = 0;
    for (int k = 0; k < 4; ++k) {
      const TcPoint *a = &p[k], *b = &p[(k + 1) & 3], *c = &p[(k + 2) & 3];
      const double ab = tc_edge(a, b), bc = tc_edge(b, c), ca = tc_edge(c, a);
      assert_true(ab != 0 && ab == -tc_edge(b, a));
      if (tc_inside(ab, bc, ca)) {
        ++faces;
        assert_true(fabs(ab + bc + ca) >= 1); /* never a face seen edge-on: there is something to divide by */
      }
    }
    if (faces != 0 && faces != 2) {
      fail_msg("%d faces crossed: (%g,%g) (%g,%g) (%g,%g) (%g,%g)", faces, p[0].x, p[0].y, p[1].x, p[1].y, p[2].x, p[2].y, p[3].x,
               p[3].y);
    }
    crossed += faces == 2;
  }
  assert_true(crossed > 100000);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(sign_is_exact),
    cmocka_unit_test(every_tetrahedron_has_a_way_through),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
