/* SPDX-License-Identifier: Apache-2.0 */
/* Embree as a finder of candidates: everything whose box a line may meet. Embree works in single precision and its
 * boxes are widened to make up for that; whether a line really crosses is decided by the caller, in double precision.
 */
#ifndef TC_VOLUME_EMBREE_H
#define TC_VOLUME_EMBREE_H

#include "base/base.h"

typedef struct TcEmbree TcEmbree;

/* Bounds of primitive i, scaled coordinates. */
typedef void TcBoundsFunction(const void *user, uint32_t i, double low[3], double high[3]);
/* Called for every primitive whose box the line may meet, and for some others, in any order, each once. */
typedef void TcCandidateFunction(void *query, uint32_t i);

/* Builds the hierarchy over `count` primitives inside the sphere (center, radius). `user` must outlive it. */
TetcastStatus tc_embree_create(TetcastContext *context, int64_t count, const double center[3], double radius,
                               TcBoundsFunction *bounds, const void *user, TcEmbree **embree);
void tc_embree_destroy(TcEmbree *embree);
size_t tc_embree_bytes(const TcEmbree *embree);

/* All candidates along the whole line through the centre + `from_center`, with unit `direction`. */
void tc_embree_query(const TcEmbree *embree, const double from_center[3], const double direction[3],
                     TcCandidateFunction *candidate, void *query);

/* The same for `width` (8 or 16) lines at once, those of the bits of `lanes`: the components of from_center and
 * direction are [3][width]. Called for every primitive that any may meet, with the bits of those. */
typedef void TcPacketCandidateFunction(void *query, uint32_t i, unsigned lanes);
void tc_embree_query_packet(const TcEmbree *embree, int width, unsigned lanes, const double *from_center,
                            const double *direction, TcPacketCandidateFunction *candidate, void *query);

#endif
