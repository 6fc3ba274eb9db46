/* SPDX-License-Identifier: Apache-2.0 */
/* Progress of work in several stages: each stage reports from 0 to 1, which becomes its share of the whole. */
#ifndef TC_MESH_STAGE_H
#define TC_MESH_STAGE_H

#include <tetcast/context.h>

typedef struct TcStage {
  TetcastProgress progress;
  const TetcastProgress *whole;
  double begin, end;
} TcStage;

static inline bool tc_stage_report(void *user, double fraction) {
  const TcStage *stage = user;
  return stage->whole->function(stage->whole->user, stage->begin + fraction * (stage->end - stage->begin));
}

/* Returns the progress to hand to a stage that takes the whole from `begin` to `end`; NULL if nobody is told. *stage
 * must outlive the stage. */
static inline const TetcastProgress *tc_stage(TcStage *stage, const TetcastProgress *whole, double begin, double end) {
  if (!whole || !whole->function)
    return NULL;
  *stage = (TcStage){.progress = {tc_stage_report, stage}, .whole = whole, .begin = begin, .end = end};
  return &stage->progress;
}

#endif
