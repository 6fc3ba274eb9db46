/* SPDX-License-Identifier: Apache-2.0 */
/* How a field's values are distributed over its mesh (tetcast/statistics.h). */
#ifndef TC_VOLUME_STATISTICS_H
#define TC_VOLUME_STATISTICS_H

#include <tetcast/statistics.h>

#include "mesh/mesh.h"

TetcastStatus tc_statistics_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                   const TetcastStatisticsDesc *desc, TetcastStatistics **statistics);
void tc_statistics_destroy(TetcastContext *context, TetcastStatistics *statistics);
TetcastStatus tc_statistics_quantiles(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                      const double *shares, int count, double *values);

#endif
