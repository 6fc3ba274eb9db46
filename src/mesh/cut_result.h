/* SPDX-License-Identifier: Apache-2.0 */
/* What cutting makes (cut.c), and what is asked of it (cut_result.c). */
#ifndef TC_MESH_CUT_RESULT_H
#define TC_MESH_CUT_RESULT_H

#include "mesh/cut.h"

struct TetcastCut {
  TetcastContext *context;
  int64_t vertex_count; /* of the input */
  int32_t (*tetrahedra)[4];
  int32_t *sources; /* NULL if not wanted */
  TcPoints points;
  TetcastCutInfo info;
};

#endif
