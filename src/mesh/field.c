/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "mesh/mesh.h"

static atomic_llong fields; /* made so far */

TetcastStatus tc_field_create(TetcastContext *context, const TetcastFieldDesc *desc, TetcastField **out) {
  TetcastField *field;
  if (!tc_allocate_array(context, (void **)&field, 1, sizeof *field, "field"))
    return TETCAST_ERROR_MEMORY;
  memset(field, 0, sizeof *field);
  field->context = context;
  field->association = desc->association;
  field->serial = atomic_fetch_add(&fields, 1) + 1;
  const TetcastStatus status =
      tc_array_keep(context, &desc->values, 1, desc->ownership, "field values", &field->values, &field->memory);
  if (status) {
    tc_field_destroy(field);
    return status;
  }
  *out = field;
  return TETCAST_OK;
}

void tc_field_destroy(TetcastField *field) {
  if (!field)
    return;
  tc_release(field->context, field->memory);
  tc_release(field->context, field);
}

enum { PIECES = 64 };

/* The range of a piece of the values. Pieces are put together in their order, so that the result is that of one loop
 * over all values. */
typedef struct Range {
  double low, high;
  int64_t nonfinite;
} Range;

typedef struct Ranges {
  const TetcastField *field;
  int64_t piece;
  Range of[PIECES];
} Ranges;

static bool take_range(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Ranges *ranges = data;
  Range range = {INFINITY, -INFINITY, 0};
  for (int64_t i = begin; i < end; ++i) {
    const double s = tc_field_at(ranges->field, i);
    if (!isfinite(s)) {
      ++range.nonfinite;
      continue;
    }
    range.low = s < range.low ? s : range.low;
    range.high = s > range.high ? s : range.high;
  }
  ranges->of[begin / ranges->piece] = range;
  return true;
}

void tc_field_range(const TetcastField *field, double range[2], int64_t *nonfinite_count) {
  const int64_t count = field->values.count, least = 1 << 14;
  Ranges ranges = {.field = field, .piece = count / PIECES + 1 < least ? least : count / PIECES + 1};
  tc_parallel_for(field->context, count, ranges.piece, take_range, &ranges, NULL);
  Range all = {INFINITY, -INFINITY, 0};
  for (int64_t i = 0; i * ranges.piece < count; ++i) {
    const Range *part = &ranges.of[i];
    all.low = part->low < all.low ? part->low : all.low;
    all.high = part->high > all.high ? part->high : all.high;
    all.nonfinite += part->nonfinite;
  }
  if (range) {
    range[0] = all.low <= all.high ? all.low : 0;
    range[1] = all.low <= all.high ? all.high : 0;
  }
  if (nonfinite_count)
    *nonfinite_count = all.nonfinite;
}
