/* SPDX-License-Identifier: Apache-2.0 */
/* Finds candidates with Embree: everything whose bounding box a line may meet. Embree works in single precision, and
 * the boxes are widened to make up for that. The caller decides in double precision whether a line really crosses. */
#ifndef TC_VOLUME_EMBREE_H
#define TC_VOLUME_EMBREE_H

#include "base/base.h"

typedef struct TcEmbree TcEmbree;

/* Computes the bounds of primitive i in scaled coordinates. */
typedef void TcBoundsFunction(const void *user, uint32_t i, double low[3], double high[3]);
/* Is called once for every primitive whose box the line may meet, and for some others, in any order. */
typedef void TcCandidateFunction(void *query, uint32_t i);

/* Builds the hierarchy over `count` primitives inside the sphere (center, radius). `user` must outlive it. */
TetcastStatus tc_embree_create(TetcastContext *context, int64_t count, const double center[3], double radius,
                               TcBoundsFunction *bounds, const void *user, TcEmbree **embree);
void tc_embree_destroy(TcEmbree *embree);
size_t tc_embree_bytes(const TcEmbree *embree);

/* Calls `candidate` for all candidates along the whole line through center + from_center along the unit vector
 * `direction`. */
void tc_embree_query(const TcEmbree *embree, const double from_center[3], const double direction[3],
                     TcCandidateFunction *candidate, void *query);

/* Is called for every primitive that any of several lines may meet, with the bits of these lines. */
typedef void TcPacketCandidateFunction(void *query, uint32_t i, unsigned lanes);
/* The same for several lines at once, those whose bits are set in `lanes`. `width` is 8 or 16; the components of
 * from_center and direction are [3][width]. */
void tc_embree_query_packet(const TcEmbree *embree, int width, unsigned lanes, const double *from_center,
                            const double *direction, TcPacketCandidateFunction *candidate, void *query);

#endif
