/* SPDX-License-Identifier: Apache-2.0 */
/* A scene's clip: the half-spaces as its volume's rays need them. */
#ifndef TC_RENDER_CLIP_H
#define TC_RENDER_CLIP_H

#include <tetcast/clip.h>

#include "volume/clip.h"
#include "volume/volume.h"

/* A plane or half-space in the volume's units. */
TcHalfSpace tc_half_space_scale(const TetcastVolume *volume, const TetcastHalfSpace *source);

/* *clip: [*kept] of them, NULL if there are none. Those that hold the whole volume are left out: they change nothing.
 */
TetcastStatus tc_clip_create(const TetcastVolume *volume, const TetcastHalfSpace *half_spaces, int count,
                             TcHalfSpace **clip, int *kept);

/* The error of an interval's end at a plane that a ray meets at right angles (walk/interval.h); the volume's centre is
 * this far from the eye. */
double tc_clip_error(const TetcastVolume *volume, double eye_distance);

#endif
