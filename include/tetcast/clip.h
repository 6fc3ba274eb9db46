/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLIP_H
#define TETCAST_CLIP_H

#ifdef __cplusplus
extern "C" {
#endif

/* The points x with normal · x ≥ offset, in the mesh's coordinates: what lies on a plane belongs to it. */
typedef struct TetcastHalfSpace {
  /* Points to what is kept; of any length above 0, finite. */
  double normal[3];
  /* Finite, in the unit of the coordinates times that of `normal`. */
  double offset;
} TetcastHalfSpace;

#ifdef __cplusplus
}
#endif

#endif
