/* SPDX-License-Identifier: Apache-2.0 */
/* What --extinction, --emission and --groups ask for, read and set. */
#ifndef TETCAST_CLI_COEFFICIENTS_H
#define TETCAST_CLI_COEFFICIENTS_H

#include <tetcast/tetcast.h>

#include "render_options.h"

typedef struct Coefficients {
  TetcastField *extinction[TETCAST_MAX_GROUPS], *emission[TETCAST_MAX_GROUPS];
  int extinction_count, emission_count;
} Coefficients;

/* The fields of the two arrays' components, warned about where values are not finite; false after a message. */
bool coefficients_read(const TetcastDataset *dataset, const RenderOptions *options, Coefficients *coefficients);

TetcastStatus coefficients_set(TetcastScene *scene, const RenderOptions *options, const Coefficients *coefficients);

void coefficients_release(Coefficients *coefficients);

#endif
