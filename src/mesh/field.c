/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "mesh/mesh.h"

TetcastStatus tc_field_create(TetcastContext *context, const TetcastFieldDesc *desc, TetcastField **out) {
  TetcastField *field;
  if (!tc_allocate_array(context, (void **)&field, 1, sizeof *field, "field")) return TETCAST_ERROR_MEMORY;
  memset(field, 0, sizeof *field);
  field->context = context;
  field->association = desc->association;
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
  if (!field) return;
  tc_release(field->context, field->memory);
  tc_release(field->context, field);
}

void tc_field_range(const TetcastField *field, double range[2], int64_t *nonfinite_count) {
  double low = INFINITY, high = -INFINITY;
  int64_t nonfinite = 0;
  for (int64_t i = 0; i < field->values.count; ++i) {
    const double s = tc_array_double(&field->values, field->values.stride, i, 0);
    if (!isfinite(s)) {
      ++nonfinite;
      continue;
    }
    low = s < low ? s : low;
    high = s > high ? s : high;
  }
  if (range) {
    range[0] = low <= high ? low : 0;
    range[1] = low <= high ? high : 0;
  }
  if (nonfinite_count) *nonfinite_count = nonfinite;
}
