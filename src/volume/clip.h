/* SPDX-License-Identifier: Apache-2.0 */
/* Half-spaces to which what is seen is clipped. */
#ifndef TC_VOLUME_CLIP_H
#define TC_VOLUME_CLIP_H

/* normal · (x − the volume's centre) + at_center ≥ 0, in scaled coordinates. */
typedef struct TcHalfSpace {
  double normal[3]; /* times a power of two: its largest component is in [1/2, 1) */
  double at_center; /* rounded once; ±infinity: too far away for a double */
  double length;    /* of the normal, at most √3 */
} TcHalfSpace;

#endif
