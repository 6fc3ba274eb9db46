/* SPDX-License-Identifier: Apache-2.0 */
/* The public boundary of statistics: as tetcast.c. */
#include <inttypes.h>
#include <math.h>

#include "base/boundary.h"
#include "mesh/mesh.h"
#include "volume/statistics.h"

TetcastStatisticsDesc tetcast_statistics_desc_default(void) {
  return (TetcastStatisticsDesc){.cookie = TC_COOKIE, .bins = 256};
}

static TetcastStatus check_count(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field) {
  const int64_t cells = mesh->tetrahedra.count, wanted = field->association == TETCAST_POINT  ? mesh->vertices.count
                                                         : field->association == TETCAST_CELL ? cells
                                                                                              : 4 * cells;
  if (field->values.count == wanted)
    return TETCAST_OK;
  return ARGUMENT(context, "statistics: the field has %" PRId64 " values, and the mesh needs %" PRId64,
                  field->values.count, wanted);
}

/* 0, 0 is the default, to be found; else the second is the larger. */
static bool is_range(const double range[2]) {
  return (range[0] == 0 && range[1] == 0) || (isfinite(range[0]) && isfinite(range[1]) && range[0] < range[1]);
}

typedef struct Create {
  TetcastContext *context;
  const TetcastMesh *mesh;
  const TetcastField *field;
  const TetcastStatisticsDesc *desc;
  TetcastStatistics **statistics;
} Create;

static TetcastStatus create(void *data) {
  const Create *c = data;
  return tc_statistics_create(c->context, c->mesh, c->field, c->desc, c->statistics);
}

TetcastStatus tetcast_statistics_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                        const TetcastStatisticsDesc *desc, TetcastStatistics **statistics) {
  TC_ENTRY;
  const TetcastStatisticsDesc defaults = tetcast_statistics_desc_default();
  CHECK_GIVEN(context, context);
  CHECK_OUT(context, statistics);
  CHECK_GIVEN(context, mesh);
  CHECK_GIVEN(context, field);
  if (!desc)
    desc = &defaults;
  CHECK_DESC(context, desc);
  if (desc->bins < 1 || desc->bins > TETCAST_MAX_BINS)
    return ARGUMENT(context, "statistics: %d bins, must be in [1, %d]", desc->bins, TETCAST_MAX_BINS);
  if (desc->gradient_bins < 0 || (int64_t)desc->bins * desc->gradient_bins > 1 << 20)
    return ARGUMENT(context, "statistics: %d × %d bins, at most 2^20 are possible", desc->gradient_bins, desc->bins);
  if (!is_range(desc->range) || !is_range(desc->gradient_range))
    return ARGUMENT(context, "statistics: a range is not one of finite numbers, the second above the first");
  const TetcastStatus status = check_count(context, mesh, field);
  return status ? status : tc_call(create, &(Create){context, mesh, field, desc, statistics}, NULL);
}

void tetcast_statistics_destroy(TetcastContext *context, TetcastStatistics **statistics) {
  TC_ENTRY;
  if (!statistics)
    return;
  tc_statistics_destroy(context, *statistics);
  *statistics = NULL;
}

typedef struct Quantiles {
  TetcastContext *context;
  const TetcastMesh *mesh;
  const TetcastField *field;
  const double *shares;
  int count;
  double *values;
} Quantiles;

static TetcastStatus quantiles(void *data) {
  const Quantiles *q = data;
  return tc_statistics_quantiles(q->context, q->mesh, q->field, q->shares, q->count, q->values);
}

TetcastStatus tetcast_statistics_quantiles(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                                           const double *shares, int count, double *values) {
  TC_ENTRY;
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, mesh);
  CHECK_GIVEN(context, field);
  CHECK_GIVEN(context, shares);
  CHECK_GIVEN(context, values);
  if (count < 1 || count > 64)
    return ARGUMENT(context, "statistics: %d quantiles, must be in [1, 64]", count);
  for (int i = 0; i < count; ++i) {
    if (!(shares[i] >= 0 && shares[i] <= 1) || (i > 0 && shares[i] < shares[i - 1]))
      return ARGUMENT(context, "statistics: share %d is %g; shares are in [0, 1] and ascend", i, shares[i]);
  }
  const TetcastStatus status = check_count(context, mesh, field);
  return status ? status : tc_call(quantiles, &(Quantiles){context, mesh, field, shares, count, values}, NULL);
}
