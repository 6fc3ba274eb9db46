/* SPDX-License-Identifier: Apache-2.0 */
/* All gatherers, and a call of each function of the seam that takes the gatherer's number. That is a constant wherever
 * kernels call them, so that no choice is left in the compiled code. */
#ifndef TC_GATHER_GATHER_H
#define TC_GATHER_GATHER_H

#include "gather/emission.h"
#if !TC_SINGLE
#include "gather/coefficients.h"
#include "gather/count.h"
#include "gather/trace.h"
#include "gather/value.h"
#include "gather/visit.h"
#include "gather/visit_groups.h"
#endif
#if TC_LANES == 1
#include "gather/sampled.h"
#endif

/* The name of each gatherer, and the type of its state. */
#if TC_SINGLE
#define TC_GATHERERS(GATHERER) GATHERER(emission, TcEmission)
#elif TC_LANES > 1
#define TC_GATHERERS(GATHERER)                                                                                         \
  GATHERER(emission, TcEmission)                                                                                       \
  GATHERER(trace, TcTrace)                                                                                             \
  GATHERER(groups, TcGroups)                                                                                           \
  GATHERER(value, TcValue) GATHERER(count, TcCount) GATHERER(visit, TcVisit) GATHERER(visit_groups, TcVisitGroups)
#else
#define TC_GATHERERS(GATHERER)                                                                                         \
  GATHERER(emission, TcEmission)                                                                                       \
  GATHERER(trace, TcTrace)                                                                                             \
  GATHERER(groups, TcGroups)                                                                                           \
  GATHERER(value, TcValue)                                                                                             \
  GATHERER(count, TcCount)                                                                                             \
  GATHERER(visit, TcVisit) GATHERER(visit_groups, TcVisitGroups) GATHERER(sampled, TcSampled)
#endif

enum {
#define TC_GATHERER(name, type) TC_GATHER_##name,
  TC_GATHERERS(TC_GATHERER)
#undef TC_GATHERER
};

typedef union TcGather {
#define TC_GATHERER(name, type) type name;
  TC_GATHERERS(TC_GATHERER)
#undef TC_GATHERER
} TcGather;

TC_INLINE void tc_gather_begin(const int which, const TcGatherJob *job, TcGather *g) {
  switch (which) {
#define TC_GATHERER(name, type)                                                                                        \
  case TC_GATHER_##name:                                                                                               \
    tc_##name##_begin(job, &g->name);                                                                                  \
    break;
    TC_GATHERERS(TC_GATHERER)
#undef TC_GATHERER
  }
}

TC_INLINE void tc_gather_enter(const int which, const unsigned on, const TcGatherJob *job, TcGather *g, TcMask mask,
                               const TcPacket *walk) {
  (void)on, (void)job, (void)g, (void)mask, (void)walk; /* not all gatherers use these */
  switch (which) {
#define TC_GATHERER(name, type)                                                                                        \
  case TC_GATHER_##name:                                                                                               \
    tc_##name##_enter(on, job, &g->name, mask, walk);                                                                  \
    break;
    TC_GATHERERS(TC_GATHERER)
#undef TC_GATHERER
  }
}

TC_INLINE void tc_gather_segment(const int which, const unsigned on, const TcGatherJob *job, TcGather *g, TcMask mask,
                                 const TcPassage *passage) {
  switch (which) {
#define TC_GATHERER(name, type)                                                                                        \
  case TC_GATHER_##name:                                                                                               \
    tc_##name##_segment(on, job, &g->name, mask, passage);                                                             \
    break;
    TC_GATHERERS(TC_GATHERER)
#undef TC_GATHERER
  }
}

TC_INLINE TcMask tc_gather_complete(const int which, const unsigned on, const TcGatherJob *job, TcGather *g,
                                    TcMask active, int64_t steps) {
  switch (which) {
#define TC_GATHERER(name, type)                                                                                        \
  case TC_GATHER_##name:                                                                                               \
    return tc_##name##_complete(on, job, &g->name, active, steps);
    TC_GATHERERS(TC_GATHERER)
#undef TC_GATHERER
  }
  return tc_none();
}

TC_INLINE void tc_gather_end(const int which, const unsigned on, const TcGatherJob *job, TcGather *g,
                             const TcEnding *ending, double (*sums)[TC_LANES]) {
  switch (which) {
#define TC_GATHERER(name, type)                                                                                        \
  case TC_GATHER_##name:                                                                                               \
    tc_##name##_end(on, job, &g->name, ending, sums);                                                                  \
    break;
    TC_GATHERERS(TC_GATHERER)
#undef TC_GATHERER
  }
}

#endif
