/* SPDX-License-Identifier: Apache-2.0 */
/* Transfer functions for a mesh in parts: how deep rays are in the whole is summed up over the parts. */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "communicator.h"

/* As the core has it: pictures of 48 × 36 rays, or three of 24 × 24 along the axes. */
enum { GRID = 24, RAYS = 3 * GRID * GRID };

/* What is wanted, by rank 0. */
typedef struct Wish {
  double bounds[6], opacity, low, high;
  TetcastCamera camera;
  int fit; /* not 0: to fit a shape over [low, high], by rays along the axes; 0: to scale it, by the camera's */
  int64_t color_count, extinction_count;
  double radius;
} Wish;

/* The scenes of this rank, and what all ranks have of the wish. */
typedef struct Work {
  TetcastMpi *mpi;
  TetcastScene *const *scenes;
  int64_t count;
  Wish wish;
  TetcastTransferFunction *shape;
  double largest; /* of the extinctions that the probe has been made from */
  double probed;  /* what it has become in the probe */
} Work;

/* ── the wish ── */

static TetcastStatus check(const Work *work, TetcastTransferFunction **result) {
  const TetcastMpi *mpi = work->mpi;
  if (!result)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "transfer_function is NULL");
  if (work->count < 0 || (work->count > 0 && !work->scenes))
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "%" PRId64 " scenes%s", work->count,
                                 work->scenes ? "" : " that are NULL");
  for (int64_t i = 0; i < work->count; ++i) {
    if (!work->scenes[i])
      return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "scene %" PRId64 " of rank %d is NULL", i,
                                   mpi->rank);
  }
  return TETCAST_OK;
}

static TetcastStatus check_wish(const TetcastMpi *mpi, const Wish *wish) {
  for (int k = 0; k < 3; ++k) {
    if (!(wish->bounds[2 * k] <= wish->bounds[2 * k + 1] && wish->bounds[2 * k] >= -1e300 &&
          wish->bounds[2 * k + 1] <= 1e300))
      return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "bounds from %g to %g in %c: must ascend, within 1e300", wish->bounds[2 * k],
                                   wish->bounds[2 * k + 1], 'x' + k);
  }
  if (wish->fit && !(isfinite(wish->low) && isfinite(wish->high) && wish->low <= wish->high))
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "range %g to %g of a transfer function",
                                 wish->low, wish->high);
  if (!(wish->opacity > 0 && wish->opacity < 1))
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "opacity %g is not between 0 and 1",
                                 wish->opacity);
  return TETCAST_OK;
}

/* Half of the bounds' diagonal. */
static double radius_of(const double bounds[6]) {
  double length = 0;
  for (int k = 0; k < 3; ++k)
    length = hypot(length, 0.5 * bounds[2 * k + 1] - 0.5 * bounds[2 * k]);
  return length;
}

/* Brings the wish and the shape to all. */
static TetcastStatus share(Work *work, TetcastStatus status, const TetcastTransferFunction *shape) {
  TetcastMpi *mpi = work->mpi;
  Wish *wish = &work->wish;
  const double *color = NULL, *extinction = NULL;
  if (!status && mpi->rank == 0)
    status = check_wish(mpi, wish);
  if (!status && mpi->rank == 0) {
    color = tetcast_transfer_function_color(shape, &wish->color_count);
    extinction = tetcast_transfer_function_extinction(shape, &wish->extinction_count);
    wish->radius = radius_of(wish->bounds);
  }
  status = tc_mpi_agree(mpi, status, NULL, 0);
  if (!status)
    status = tc_mpi_broadcast(mpi, 0, wish, sizeof *wish);
  if (status)
    return status;
  const int64_t size = 4 * wish->color_count + 2 * wish->extinction_count;
  double *knots = malloc((size_t)size * sizeof *knots);
  if (!knots)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory", mpi->rank);
  status = tc_mpi_agree(mpi, status, NULL, 0);
  if (!status && mpi->rank == 0) {
    memcpy(knots, color, (size_t)(4 * wish->color_count) * sizeof *knots);
    memcpy(knots + 4 * wish->color_count, extinction, (size_t)(2 * wish->extinction_count) * sizeof *knots);
  }
  if (!status)
    status = tc_mpi_broadcast(mpi, 0, knots, size * (int64_t)sizeof *knots);
  if (!status) {
    TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
    desc.color = knots;
    desc.color_count = wish->color_count;
    desc.extinction = knots + 4 * wish->color_count;
    desc.extinction_count = wish->extinction_count;
    status = tetcast_transfer_function_create(mpi->context, &desc, &work->shape);
  }
  free(knots);
  return status;
}

/* ── the probe ── */

/* The transfer function with its largest extinction, if it has any, replaced by another, and the others with it. */
static TetcastStatus rescale(Work *work, const TetcastTransferFunction *given, double extinction,
                             TetcastTransferFunction **result) {
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  const double *knots = tetcast_transfer_function_extinction(given, &desc.extinction_count);
  double *scaled = malloc((size_t)(2 * desc.extinction_count) * sizeof *scaled), largest = 0;
  if (!scaled)
    return tetcast_context_error(work->mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory", work->mpi->rank);
  for (int64_t i = 0; i < desc.extinction_count; ++i)
    largest = fmax(largest, knots[2 * i + 1]);
  for (int64_t i = 0; i < desc.extinction_count; ++i) {
    scaled[2 * i] = knots[2 * i];
    scaled[2 * i + 1] = largest > 0 ? fmin(knots[2 * i + 1] / largest * extinction, DBL_MAX) : 0;
  }
  desc.color = tetcast_transfer_function_color(given, &desc.color_count);
  desc.extinction = scaled;
  work->largest = largest;
  const TetcastStatus status = tetcast_transfer_function_create(work->mpi->context, &desc, result);
  free(scaled);
  return status;
}

/* The transfer function by which depths are measured. Its largest extinction is such that no ray has a depth above 1,
 * so that nothing hides anything. */
static TetcastStatus create_probe(Work *work, TetcastTransferFunction **probe) {
  int exponent;
  const Wish *wish = &work->wish;
  TetcastTransferFunction *unit = NULL;
  frexp(wish->radius, &exponent);
  work->probed = ldexp(1, exponent > -1000 ? -exponent - 1 : 1000);
  if (!wish->fit)
    return rescale(work, work->shape, work->probed, probe);
  TetcastStatus status =
      tetcast_transfer_function_stretch(work->mpi->context, work->shape, wish->low, wish->high, 1, &unit);
  if (!status)
    status = rescale(work, unit, work->probed, probe);
  tetcast_transfer_function_destroy(&unit);
  return status;
}

/* ── depths ── */

static TetcastCamera camera_along(const Wish *wish, int axis) {
  TetcastCamera camera = {.projection = TETCAST_ORTHOGRAPHIC, .fovy = 30, .height = 2 * wish->radius};
  for (int k = 0; k < 3; ++k)
    camera.eye[k] = camera.target[k] = 0.5 * wish->bounds[2 * k] + 0.5 * wish->bounds[2 * k + 1];
  camera.eye[axis] -= 2 * wish->radius;
  camera.up[(axis + 2) % 3] = 1;
  return camera;
}

/* Adds the depths of a picture of one scene to `depths`. */
static TetcastStatus measure_picture(Work *work, const TetcastScene *scene, const TetcastCamera *camera, int64_t width,
                                     int64_t height, double *depths, TetcastRenderStats *stats) {
  TetcastMpi *mpi = work->mpi;
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.isa = mpi->isa;
  TetcastStatus status = mpi->fragments ? TETCAST_OK : tetcast_fragments_create(mpi->context, &mpi->fragments);
  if (!status)
    status = tetcast_scene_render_fragments(scene, camera, &desc, width, height, mpi->fragments, stats);
  if (status)
    return status;
  const TetcastFragmentList list = tetcast_fragments_list(mpi->fragments);
  for (int64_t i = 0; i < list.count; ++i)
    depths[list.data[i].pixel] += list.data[i].optical_depth;
  return TETCAST_OK;
}

static TetcastStatus measure_scene(Work *work, const TetcastScene *scene, double depths[RAYS],
                                   TetcastRenderStats *stats) {
  memset(depths, 0, RAYS * sizeof *depths);
  if (!work->wish.fit)
    return measure_picture(work, scene, &work->wish.camera, 2 * GRID, 3 * GRID / 2, depths, stats);
  TetcastStatus status = TETCAST_OK;
  for (int axis = 0; !status && axis < 3; ++axis) {
    const TetcastCamera camera = camera_along(&work->wish, axis);
    status = measure_picture(work, scene, &camera, GRID, GRID, depths + axis * GRID * GRID, stats);
  }
  return status;
}

/* The depths of all scenes [count][RAYS], by one instruction set on all ranks. */
static TetcastStatus measure_scenes(Work *work, const TetcastTransferFunction *probe, double *depths) {
  TetcastMpi *mpi = work->mpi;
  for (;;) {
    TetcastRenderStats stats;
    TetcastStatus status = depths ? TETCAST_OK
                                  : tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY,
                                                          "rank %d: out of memory: optical depths", mpi->rank);
    int64_t isa[2] = {INT64_MIN, INT64_MIN};
    for (int64_t i = 0; !status && i < work->count; ++i) {
      status = tetcast_scene_set_transfer_function(work->scenes[i], probe);
      if (!status)
        status = measure_scene(work, work->scenes[i], depths + i * RAYS, &stats);
      if (!status)
        tc_mpi_note_isa(stats.isa, isa);
    }
    status = tc_mpi_agree(mpi, status, isa, 2);
    if (status || tc_mpi_one_isa(mpi, isa))
      return status;
  }
}

/* The depths that rays have in the whole; returns how many rays have any. */
static TetcastStatus measure(Work *work, const TetcastTransferFunction *probe, double depths[RAYS], int64_t *count) {
  const int64_t most = INT64_MAX / RAYS / (int64_t)sizeof(double) - 1;
  double *own = work->count < most ? malloc((size_t)(work->count + 1) * RAYS * sizeof *own) : NULL;
  TetcastStatus status = measure_scenes(work, probe, own);
  if (!status)
    status = tetcast_mpi_sum(work->mpi, own, work->count, RAYS, depths);
  free(own);
  *count = 0;
  for (int i = 0; !status && i < RAYS; ++i) {
    if (depths[i] > 0)
      depths[(*count)++] = depths[i];
  }
  return status;
}

/* ── the result ── */

static TetcastStatus create_result(Work *work, double factor, TetcastTransferFunction **result) {
  const double extinction = fmin(factor, DBL_MAX);
  if (work->wish.fit)
    return tetcast_transfer_function_stretch(work->mpi->context, work->shape, work->wish.low, work->wish.high,
                                             extinction, result);
  return rescale(work, work->shape, extinction, result);
}

/* From the wish that all ranks have. Rank 0 finds the factor for all. */
static TetcastStatus fulfil(Work *work, TetcastStatus status, TetcastTransferFunction **result) {
  TetcastMpi *mpi = work->mpi;
  TetcastTransferFunction *probe = NULL;
  double *depths = malloc(RAYS * sizeof *depths), extinction = 0;
  int64_t count;
  if (!status && !depths)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory", mpi->rank);
  if (!status)
    status = create_probe(work, &probe);
  status = tc_mpi_agree(mpi, status, NULL, 0);
  if (!status)
    status = measure(work, probe, depths, &count);
  tetcast_transfer_function_destroy(&probe);
  if (!status) {
    extinction = work->largest > 0 ? 1 / work->wish.radius : 0;
    if (mpi->rank == 0 && count > 0) {
      status = tetcast_opacity_factor(mpi->context, depths, count, work->wish.opacity, !work->wish.fit, &extinction);
      extinction *= work->probed;
    }
    status = tc_mpi_agree(mpi, status, NULL, 0);
  }
  free(depths);
  if (!status)
    status = tc_mpi_broadcast(mpi, 0, &extinction, sizeof extinction);
  if (status)
    return status;
  status = tc_mpi_agree(mpi, create_result(work, extinction, result), NULL, 0);
  if (status)
    tetcast_transfer_function_destroy(result);
  return status;
}

static TetcastStatus make(Work *work, const double bounds[6], const TetcastTransferFunction *shape,
                          const TetcastCamera *camera, TetcastTransferFunction **result) {
  TetcastMpi *mpi = work->mpi;
  if (result)
    *result = NULL;
  TetcastStatus status = check(work, result);
  if (!status && mpi->rank == 0 && (!bounds || !shape || !(camera || work->wish.fit)))
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "bounds, shape or camera is NULL at rank 0");
  if (!status && mpi->rank == 0) {
    memcpy(work->wish.bounds, bounds, sizeof work->wish.bounds);
    if (camera)
      work->wish.camera = *camera;
  }
  status = share(work, status, shape);
  /* All ranks have come to the end of share(), or none: from there on a rank may have failed alone. */
  status = tc_mpi_agree(mpi, status, NULL, 0);
  if (!status)
    status = fulfil(work, status, result);
  tetcast_transfer_function_destroy(&work->shape);
  return status;
}

TetcastStatus tetcast_mpi_scale_transfer_function(TetcastMpi *mpi, TetcastScene *const *scenes, int64_t count,
                                                  const double bounds[6], const TetcastTransferFunction *shape,
                                                  const TetcastCamera *camera, double opacity,
                                                  TetcastTransferFunction **transfer_function) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  Work work = {.mpi = mpi, .scenes = scenes, .count = count, .wish = {.opacity = opacity}};
  return make(&work, bounds, shape, camera, transfer_function);
}

TetcastStatus tetcast_mpi_fit_transfer_function(TetcastMpi *mpi, TetcastScene *const *scenes, int64_t count,
                                                const double bounds[6], const TetcastTransferFunction *shape,
                                                double low, double high, TetcastTransferFunction **transfer_function) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  Work work = {
      .mpi = mpi, .scenes = scenes, .count = count, .wish = {.opacity = 0.5, .low = low, .high = high, .fit = 1}};
  return make(&work, bounds, shape, NULL, transfer_function);
}
