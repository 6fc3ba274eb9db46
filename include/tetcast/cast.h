/* SPDX-License-Identifier: Apache-2.0 */
/* Rays as numbers: what any rays gather in a scene, and the cells that they cross in a volume. */
#ifndef TETCAST_CAST_H
#define TETCAST_CAST_H

#include <stdbool.h>
#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/context.h>
#include <tetcast/integrator.h>
#include <tetcast/scene.h>
#include <tetcast/status.h>
#include <tetcast/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Any n rays. A ray is the points origin + t · direction with t from begin to end. The arrays are referred to during
 * the call only. Numbers that are not finite, but for infinite ends, a direction of 0, 0, 0 and a begin above the end
 * are TETCAST_ERROR_ARGUMENT, and the message has the ray's number, from 0. */
typedef struct TetcastRays {
  /* Set by tetcast_rays_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* [n, 3] float32 or float64: where t is 0, in the mesh's unit of length. Default: none, n = 0. */
  TetcastArray origins;
  /* [n, 3] float32 or float64: the directions, of any length above 0; t is in units of that length. Default: none. */
  TetcastArray directions;
  /* [n] float32 or float64: the t from which on a ray counts; it may be negative, and −infinity. None (the default): 0
   * for all rays. */
  TetcastArray begins;
  /* [n] float32 or float64: the t up to which a ray counts, which may be infinity. None (the default): infinity for all
   * rays. What is met exactly where one ray ends and another one on the same line begins is in one of them, but for the
   * boundary's faces, which may be in both. */
  TetcastArray ends;
} TetcastRays;

/* Makes an empty list of rays. */
TETCAST_API TetcastRays tetcast_rays_default(void);

/* ── what rays gather ── */

/* Where the results go, each an array of the caller's own, of float64, rows next to each other. NULL: not wanted. What
 * is not wanted is not computed. */
typedef struct TetcastCastResult {
  /* [n][4]: red, green, blue, premultiplied, and alpha, as a pixel of a frame has them. */
  double *color;
  /* [n]: ∫ κ dt along all of the ray, however opaque it is. Of surfaces it knows nothing. With coefficients it is the
   * mean over the groups. Not in a blend mode other than composite (TETCAST_ERROR_ARGUMENT). */
  double *optical_depth;
  /* [n]: the length of the ray's parts in cells, in the mesh's unit. Where cells overlap, each of them counts. */
  double *length;
  /* [n]: a bound on the error of each of the four numbers of `color`, as TETCAST_CHANNEL_ERROR has it (frame.h), and of
   * the same scenes. It allows for origins as far away from the mesh as the farthest of all rays has. */
  double *error;
  /* [n]: in a blend mode other than composite, the value that it makes of the scalar, in the scalar's unit, or in that
   * times the mesh's unit of length; NaN: the ray meets nothing. Not in the blend mode composite. */
  double *value;
  /* [n][groups] of scenes with coefficients (scene.h), and of no others: the radiance of each group, in the emission's
   * unit times length. */
  double *radiance;
  /* [n][groups], as `radiance`: the optical depth of each group. */
  double *group_optical_depth;
  /* [n][groups], as `radiance`: exp(−optical depth) of each group. */
  double *transmittance;
} TetcastCastResult;

/* How rays are cast. */
typedef struct TetcastCastDesc {
  /* Set by tetcast_cast_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* The largest instruction set that may be used. All give the same results up to rounding. Default: TETCAST_ISA_AUTO,
   * the largest that the processor has. */
  TetcastIsa isa;
  /* Called while rays are cast (context.h). Default: not called. */
  TetcastProgress progress;
} TetcastCastDesc;

/* Makes a desc with every setting at its default. */
TETCAST_API TetcastCastDesc tetcast_cast_desc_default(void);

/* Casts rays, in any order, through a scene: each gathers what the ray of a pixel does in tetcast_scene_render() with
 * the exact integrator and no tolerance, up to rounding. Light in the volume and the boundary's edges depend on a
 * camera: a scene with either of them is TETCAST_ERROR_ARGUMENT. The light that comes from a camera's eye, on surfaces,
 * comes along each ray.
 *
 * `desc` and `stats` may be NULL. Of the stats, `segments` counts the cells of each walk: those for the length and for
 * the optical depth through a transfer function are further ones. An empty list of rays is TETCAST_OK. For many rays
 * the scene keeps 32 bytes per vertex of the volume, in the place of what it keeps for pictures.
 *
 * With one instruction set the results have the same bits for any number of threads. After an error or a cancelled call
 * they are unspecified. Calls may run at the same time, also on one scene, and beside tetcast_scene_render(). */
TETCAST_API TetcastStatus tetcast_scene_cast(const TetcastScene *scene, const TetcastRays *rays,
                                             const TetcastCastDesc *desc, const TetcastCastResult *result,
                                             TetcastRenderStats *stats);

/* ── the walk itself ── */

/* A cell that a ray crosses over a length above 0. */
typedef struct TetcastCrossing {
  /* The mesh's tetrahedron, from 0. */
  uint32_t cell;
  /* The mesh's vertices of the tetrahedron, from 0, in no particular order. 0 unless weights were asked for. */
  uint32_t vertex[4];
  /* The t at which the ray enters the cell, or begins. */
  double begin;
  /* The t at which the ray leaves the cell, or ends. */
  double end;
  /* The length of the part from begin to end, in the mesh's unit. It is exact to rounding even if t has few digits left
   * for it, as the origin is far away. */
  double length;
  /* The barycentric weights of `vertex` at begin, then those at end: each ≥ 0 to rounding, their sum 1. What is linear
   * in the cell has its values there by them, and its integral as length times the mean of both. 0 unless they were
   * asked for. */
  double weight[2][4];
} TetcastCrossing;

/* What several rays, one after the other, cross. Valid during the call of the function that is given it. */
typedef struct TetcastTrace {
  /* The number of the first of these rays. */
  int64_t first;
  /* The number of rays, ≥ 1. */
  int64_t count;
  /* [count + 1]: what ray first + i crosses is crossings[offsets[i]] to crossings[offsets[i + 1] − 1]. */
  const int64_t *offsets;
  /* [offsets[count]]: the crossings of one ray after the other, each ray's in the order in which it crosses them. Where
   * cells overlap, so may their parts of the ray. */
  const TetcastCrossing *crossings;
} TetcastTrace;

/* Is called for all rays, one or several at a time, in their order and never at the same time, on the thread that
 * called tetcast_volume_trace(). False: that call is to end (TETCAST_ERROR_CANCELLED). */
typedef bool TetcastTraceFunction(void *user, const TetcastTrace *trace);

/* How rays are traced. */
typedef struct TetcastTraceDesc {
  /* Set by tetcast_trace_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* Not 0: vertices and weights of crossings are wanted. Default: 1. */
  int weights;
  /* The largest instruction set that may be used. All give the same results up to rounding. Default: TETCAST_ISA_AUTO,
   * the largest that the processor has. */
  TetcastIsa isa;
  /* Called while rays are traced (context.h). Default: not called. */
  TetcastProgress progress;
} TetcastTraceDesc;

/* Makes a desc with every setting at its default. */
TETCAST_API TetcastTraceDesc tetcast_trace_desc_default(void);

/* Finds the cells that rays cross, each with the lengths that pictures are made from. Crossings are handed to
 * `function`, with `user`, and kept in memory for some hundreds of rays per thread only. So that they need not be moved
 * once they have been written, that is mostly one ray at a time. Calls of many rays take another 32 bytes per vertex of
 * the volume while they last. Neighbours in the list that go nearly the same way are traced faster than rays in random
 * order, for the same result. `desc` may be NULL. What is handed out has the same bits for any number of threads, but
 * how many rays come at a time may differ. An empty list of rays is TETCAST_OK. Calls may run at the same time, also on
 * one volume. */
TETCAST_API TetcastStatus tetcast_volume_trace(const TetcastVolume *volume, const TetcastRays *rays,
                                               const TetcastTraceDesc *desc, TetcastTraceFunction *function,
                                               void *user);

#ifdef __cplusplus
}
#endif

#endif
