/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_STATS_H
#define TETCAST_CLI_STATS_H

#include <stdbool.h>

#include <jansson.h>

#include <tetcast/scene.h>

typedef struct RunStats {
  double read_seconds, prepare_seconds, write_seconds;
  double tolerance;
  const char *blend;
  double *render_seconds; /* [repeats] */
  int repeats, threads;
  TetcastRenderStats render; /* of one frame */
  TetcastVolumeInfo volume;
} RunStats;

/* The statistics as JSON, for cli_json_write(). */
json_t *stats_object(const RunStats *stats);

#endif
