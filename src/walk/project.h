/* SPDX-License-Identifier: Apache-2.0 */
/* Projects vertices onto the screen (screen.h). Sums and quotients are computed to twice the precision and rounded
 * once, so that the error of a coordinate is at most 2⁻⁵³ of its magnitude plus 2⁻¹⁰⁰ of the eye's distance. */
#ifndef TC_WALK_PROJECT_H
#define TC_WALK_PROJECT_H

#include "base/exact.h"
#include "walk/points.h"

/* How many vertices are projected at once, so that the compiler makes vectors of loops over them. */
enum { TC_PROJECTED = 8 };

/* Numbers to twice the precision: high + low. */
typedef struct TcPairs {
  double high[TC_PROJECTED], low[TC_PROJECTED];
} TcPairs;

#define TC_EACH_PROJECTED for (int i = 0; i < TC_PROJECTED; ++i)

/* The products dual · a. */
TC_INLINE void tc_project_dot(const TcDual *dual, const TcPairs a[3], TcPairs *result) {
  TC_EACH_PROJECTED {
    const double p = a[0].high[i] * dual->high[0], q = a[1].high[i] * dual->high[1], r = a[2].high[i] * dual->high[2];
    const double pq = p + q, sum = pq + r;
    const double errors =
        tc_product_error(a[0].high[i], dual->high[0], p) + tc_product_error(a[1].high[i], dual->high[1], q) +
        tc_product_error(a[2].high[i], dual->high[2], r) + tc_sum_error(p, q, pq) + tc_sum_error(pq, r, sum);
    double small = 0;
    for (int k = 0; k < 3; ++k)
      small += a[k].low[i] * dual->high[k] + a[k].high[i] * dual->low[k];
    result->high[i] = sum;
    result->low[i] = errors + small;
  }
}

/* Computes numerator / z + offset, rounded once. */
TC_INLINE void tc_project_divide(const TcPairs *numerator, const TcPairs *z, double offset,
                                 double result[TC_PROJECTED]) {
  TC_EACH_PROJECTED {
    const double q = numerator->high[i] / z->high[i], p = q * z->high[i], sum = q + offset;
    const double rest =
        ((numerator->high[i] - p) - tc_product_error(q, z->high[i], p) + numerator->low[i] - q * z->low[i]) /
        z->high[i];
    result[i] = sum + (tc_sum_error(q, offset, sum) + rest);
  }
}

/* Computes value + offset, rounded once. */
TC_INLINE void tc_project_add(const TcPairs *value, double offset, double result[TC_PROJECTED]) {
  TC_EACH_PROJECTED {
    const double sum = value->high[i] + offset;
    result[i] = sum + (tc_sum_error(value->high[i], offset, sum) + value->low[i]);
  }
}

/* Projects `count` ≤ TC_PROJECTED vertices from `begin` on, in the format of TcScreen.vertices. */
static void tc_project_some(const TetcastVolume *volume, const TcRows *values, const TcView *view, TcScreen *screen,
                            int64_t begin, int count) {
  TcPairs a[3], x, y, z;
  double position[3][TC_PROJECTED] = {{0}}, s[TC_PROJECTED] = {0}, px[TC_PROJECTED], py[TC_PROJECTED], d[TC_PROJECTED];
  for (int i = 0; i < count; ++i) {
    double p[3];
    tc_volume_vertex(volume, (uint32_t)(begin + i), p);
    for (int k = 0; k < 3; ++k)
      position[k][i] = p[k];
    if (values && values->association == TETCAST_POINT)
      s[i] = tc_rows_value(values, begin + i, 0);
  }
  for (int k = 0; k < 3; ++k) {
    TC_EACH_PROJECTED {
      const double difference = position[k][i] - view->eye[k];
      a[k].high[i] = difference;
      a[k].low[i] = tc_sum_error(position[k][i], -view->eye[k], difference);
    }
  }
  tc_project_dot(&screen->to_x, a, &x);
  tc_project_dot(&screen->to_y, a, &y);
  tc_project_dot(&screen->to_z, a, &z);
  if (screen->perspective) {
    tc_project_divide(&x, &z, screen->offset_x, px);
    tc_project_divide(&y, &z, screen->offset_y, py);
    TC_EACH_PROJECTED {
      const double beyond = screen->distance - z.high[i],
                   rest = tc_sum_error(screen->distance, -z.high[i], beyond) - z.low[i];
      d[i] = (beyond + rest) / (z.high[i] + z.low[i]);
    }
  } else {
    tc_project_add(&x, screen->offset_x, px);
    tc_project_add(&y, screen->offset_y, py);
    tc_project_add(&z, -screen->distance, d);
  }
  for (int i = 0; i < count; ++i) {
    TcReal *to = (TcReal *)screen->vertices + 4 * (begin + i);
#if TC_SINGLE
    const int32_t fixed[2] = {(int32_t)nearbyint(px[i] * screen->unit), (int32_t)nearbyint(py[i] * screen->unit)};
    memcpy(to, fixed, sizeof fixed);
#else
    to[0] = tc_without_tiny(px[i]);
    to[1] = tc_without_tiny(py[i]);
#endif
    to[2] = (TcReal)d[i];
    to[3] = (TcReal)s[i];
  }
}

#endif
