/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a mesh, rendered one by one, and put together exactly.
 *
 * Parts need be neither convex nor ordered: a ray may pass from one to another and back, as often as it likes. What it
 * has in a part from where it enters to where it leaves is a fragment. All fragments of a ray, from all parts, sorted
 * along it and composited, are what it has in the whole mesh, up to rounding.
 *
 * Each part is a mesh, a volume (with TetcastVolumeDesc.bounds, the same for all) and a scene, in one process or in
 * several; a cell is in one part only. Every part renders fragments from the same camera, with the same transfer
 * function and surfaces, or coefficients in the same groups, and the same instruction set; then
 * tetcast_fragments_composite() makes the picture. */
#ifndef TETCAST_FRAGMENTS_H
#define TETCAST_FRAGMENTS_H

#include <stdint.h>

#include <tetcast/camera.h>
#include <tetcast/context.h>
#include <tetcast/frame.h>
#include <tetcast/scene.h>
#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a ray has between two places at which it is outside of the part, or of what is visible of it. The surfaces that
 * it meets there are included, as nothing of another part comes between; a surface in a face that two parts share is in
 * one of them. At such a face the places of both parts' fragments have the same bits. It holds no pointers, and may be
 * sent to other processes as it is. */
typedef struct TetcastFragment {
  /* Its pixel, row · width + column, rows from the top. */
  int64_t pixel;
  /* Where it begins, in the mesh's unit of length along the ray, from the ray's point that is nearest to the middle of
   * the volume's bounds, towards the eye negative. So places don't lose digits to a distant eye. For the distance from
   * where the ray starts, add (middle − start) · direction. */
  double begin;
  /* Where it ends, likewise. */
  double end;
  /* ∫ κ dt, and −ln(1 − opacity) of each surface, above 0; infinity with an opaque one. The fragment's opacity is 1 −
   * exp(−optical_depth). With coefficients 0: each group has its own (TetcastFragmentList.groups). */
  double optical_depth;
  /* Red, green, blue, premultiplied by its opacity. With coefficients 0. */
  double color[3];
} TetcastFragment;

/* Some fragments, by ascending pixels. */
typedef struct TetcastFragmentList {
  /* [count]; NULL is allowed where count is 0. */
  const TetcastFragment *data;
  /* How many there are. */
  int64_t count;
  /* [count][group_count][2], of scenes with coefficients: for each group of each fragment the radiance, in the
   * emission's unit times the mesh's unit of length, as it leaves the fragment at its beginning, and the optical depth
   * ∫ κ dt, at least 0. They may be sent as they are, too. NULL where group_count or count is 0. */
  const double *groups;
  /* The number of groups of the scene's coefficients, in [1, TETCAST_MAX_GROUPS]; 0: it has a transfer function. */
  int group_count;
} TetcastFragmentList;

/* The fragments of a picture of a part, with memory that is kept from picture to picture. */
typedef struct TetcastFragments TetcastFragments;

/* Makes an object without fragments. */
TETCAST_API TetcastStatus tetcast_fragments_create(TetcastContext *context, TetcastFragments **fragments);

/* Frees it and sets *fragments to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_fragments_destroy(TetcastFragments **fragments);

/* Its fragments, pixel by pixel, those of a pixel by ascending begin; valid until it is rendered into again. */
TETCAST_API TetcastFragmentList tetcast_fragments_list(const TetcastFragments *fragments);

/* Renders a picture of width × height pixels, each in [1, 2^20], one ray each, to fragments, in place of those that
 * were there. Fragments of which nothing is seen are left out, and so is what lies behind an opaque part of a fragment;
 * but with coefficients all of them are there, with all of their optical depth, in 56 bytes and 16 for each group.
 * `desc` and `stats` may be NULL; of `desc`, isa, stop, start, picture_height (`height` is the number of rows then) and
 * progress are used, and fragments are exact whatever the tolerance. After an error or a cancelled call there are no
 * fragments. With one instruction set, fragments have the same bits for any number of threads. Calls with different
 * `fragments` may run at the same time, also on one scene.
 *
 * The scene may show what a cell shows by itself: coefficients, or a field through a transfer function of one or two
 * dimensions, isosurfaces, slices. What follows from the cells around it, of which a part may not have all, is
 * TETCAST_ERROR_ARGUMENT: the boundary, light in the volume, and on isosurfaces shadows, occlusion and smooth normals
 * (TETCAST_NORMALS_FLAT are possible). So are another blend mode, another integrator, several samples, adaptive_coarse
 * and TETCAST_TRAVERSAL_FACES. */
TETCAST_API TetcastStatus tetcast_scene_render_fragments(const TetcastScene *scene, const TetcastCamera *camera,
                                                         const TetcastRenderDesc *desc, int64_t width, int64_t height,
                                                         TetcastFragments *fragments, TetcastRenderStats *stats);

/* Composites lists[count] into all pixels of `frame`. Pixels have the same bits whatever the order of the lists, and
 * however fragments are shared out among them. A pixel that isn't one of the frame's or not in ascending order, numbers
 * that are not as above, and NaN are TETCAST_ERROR_DATA; the frame's pixels are unspecified then.
 *
 * Lists that have fragments must all have the same group_count (TETCAST_ERROR_ARGUMENT). With groups, pixels and those
 * channels of the frame that only scenes with coefficients have (TetcastChannelInfo.needs_coefficients) become what
 * tetcast_scene_render() makes of the whole; if it has any with a value for each group, its `groups` must be
 * group_count (TETCAST_ERROR_ARGUMENT). So it is where no list has any fragment. Other channels, and without groups all
 * of them, are not changed.
 *
 * `overlap`, if it isn't NULL, is the largest length over which a fragment of a pixel overlaps those before it, in the
 * mesh's unit. Where no cell is in two parts, and the mesh doesn't overlap itself, it is 0 to rounding.
 * Cells in several parts, as ghosts that should have been left out, show up in it if a ray sees them. */
TETCAST_API TetcastStatus tetcast_fragments_composite(TetcastContext *context, const TetcastFragmentList *lists,
                                                      int64_t count, TetcastFrame *frame, double *overlap);

#ifdef __cplusplus
}
#endif

#endif
