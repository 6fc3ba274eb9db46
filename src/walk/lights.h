/* SPDX-License-Identifier: Apache-2.0 */
/* Light in the volume, as kernels are given it. It is known at the vertices, for one camera, and is linear in a cell.
 */
#ifndef TC_WALK_LIGHTS_H
#define TC_WALK_LIGHTS_H

#include <stdbool.h>

typedef struct TcLights {
  /* [vertices of the volume][records], `width` numbers for each vertex in one record or two: what its colour is
   * multiplied by and what is added to the product (light.h), of all three components alike, or each of red, green,
   * blue. NULL: 1 and 0 everywhere, which only kernels with TC_TINTED know. */
  double (*at)[4];
  int width;
  /* What neither of the two exceeds anywhere. */
  double factor, highlight;
} TcLights;

enum { TC_LIGHT_GRAY = 2, TC_LIGHT_TINTED = 6 };

static inline int tc_light_records(int width) {
  return (width + 3) / 4;
}

#endif
