/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_BLEND_H
#define TETCAST_BLEND_H

#ifdef __cplusplus
extern "C" {
#endif

/* Which value is made of the scalar s along a ray, t being the length along it. All are exact up to rounding, as a
 * scalar of points is linear in each tetrahedron, and one of cells constant. All but the first use the parts of a ray,
 * from the eye on, that lie in cells whose values are all finite; a ray without such parts has no value. */
typedef enum TetcastBlend {
  TETCAST_BLEND_COMPOSITE = 0, /* emission and absorption through a transfer function, or by coefficients */
  TETCAST_BLEND_MAXIMUM,       /* the largest value */
  TETCAST_BLEND_MINIMUM,       /* the smallest value */
  TETCAST_BLEND_AVERAGE,       /* ∫ s dt / ∫ dt */
  TETCAST_BLEND_ADDITIVE       /* ∫ s dt, in the scalar's unit times the mesh's unit of length */
} TetcastBlend;

#ifdef __cplusplus
}
#endif

#endif
