/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/cut.h"

void tc_cut_destroy(TetcastCut *cut) {
  if (!cut)
    return;
  tc_cut_points_clear(&cut->points);
  tc_release(cut->context, cut->tetrahedra);
  tc_release(cut->context, cut->sources);
  tc_release(cut->context, cut);
}

TetcastArray tc_cut_tetrahedra(const TetcastCut *cut) {
  return (TetcastArray){.data = cut->tetrahedra, .type = TETCAST_TYPE_INT32, .count = cut->info.tetrahedra};
}

TetcastArray tc_cut_sources(const TetcastCut *cut) {
  return (TetcastArray){
      .data = cut->sources, .type = TETCAST_TYPE_INT32, .count = cut->sources ? cut->info.tetrahedra : 0};
}

const TetcastCutInfo *tc_cut_info(const TetcastCut *cut) {
  return &cut->info;
}

/* Differences to the first source are summed, so that what is constant stays so. */
bool tc_cut_interpolate(const TetcastCut *cut, const TetcastArray *values, int components, double *result) {
  if (values->count != cut->vertex_count || components < 1 || !tc_type_size(values->type))
    return false;
  const int64_t stride = tc_array_stride(values, components);
  const TcCutPoints *points = &cut->points;
  for (int64_t i = 0; i < points->count; ++i) {
    const int64_t begin = points->start[i], end = points->start[i + 1];
    for (int c = 0; c < components; ++c) {
      const double first = tc_array_double(values, stride, points->source[begin], c);
      double sum = 0;
      for (int64_t k = begin; k < end; ++k)
        sum += points->weight[k] * (tc_array_double(values, stride, points->source[k], c) - first);
      result[i * components + c] = first + sum;
    }
  }
  return true;
}
