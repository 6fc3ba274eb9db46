/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of one step from several places: --orbit and --dolly. */
#ifndef TETCAST_CLI_TOUR_H
#define TETCAST_CLI_TOUR_H

#include <tetcast/camera.h>

#include "render_options.h"

typedef struct Tour {
  int64_t count; /* of frames; 0: no tour */
  bool dolly;    /* else an orbit */
  double amount; /* the degrees, or the factor */
} Tour;

Tour tour_of(const RenderOptions *options);

/* What can't be with a tour; NULL: nothing. */
const char *tour_fault(const RenderOptions *options);

/* The camera of a frame, counted from 0; that of the first one is `base`. */
TetcastCamera tour_camera(const Tour *tour, const TetcastCamera *base, int64_t frame);

#endif
