/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_STATS_H
#define TETCAST_CLI_STATS_H

#include <stdbool.h>

#include <tetcast/scene.h>

typedef struct RunStats {
  double read_seconds, prepare_seconds, write_seconds;
  double tolerance;
  double *render_seconds; /* [repeats] */
  int repeats, threads;
  TetcastRenderStats render; /* of one frame */
  TetcastVolumeInfo volume;
} RunStats;

/* Writes the statistics as JSON. False after a message. */
bool stats_write(const char *path, const RunStats *stats);

#endif
