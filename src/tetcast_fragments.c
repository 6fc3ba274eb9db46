/* SPDX-License-Identifier: Apache-2.0 */
/* The public boundary of fragments: as tetcast.c. */
#include <inttypes.h>

#include "base/boundary.h"
#include "render/fragments.h"
#include "tetcast_scene.h"

TetcastStatus tetcast_fragments_create(TetcastContext *context, TetcastFragments **fragments) {
  TC_ENTRY;
  CHECK_OUT(context, fragments);
  CHECK_GIVEN(context, context);
  return tc_fragments_create(context, fragments);
}

void tetcast_fragments_destroy(TetcastFragments **fragments) {
  TC_ENTRY;
  if (!fragments)
    return;
  tc_fragments_destroy(*fragments);
  *fragments = NULL;
}

TetcastFragmentList tetcast_fragments_list(const TetcastFragments *fragments) {
  const bool grouped = fragments->count > 0 && fragments->width > 0;
  return (TetcastFragmentList){fragments->data, fragments->count, grouped ? fragments->groups : NULL,
                               (int)(fragments->width / 2)};
}

/* Whether a part of a mesh has what the scene shows by itself. */
static TetcastStatus check_looks(const TetcastScene *scene, const TetcastRenderDesc *desc) {
  TetcastContext *context = scene->context;
  const TcLighting *lighting = &scene->lighting;
  const bool lit = lighting->surfaces && scene->isosurface_count > 0;
  const char *what = scene->blend                  ? "another blend mode than composite"
                     : scene->boundary.opacity > 0 ? "the boundary, which a part has of its own"
                     : tc_scene_is_lit(scene)      ? "light in the volume"
                     : lit && (lighting->shadows || lighting->occlusion_rays) ? "shadows"
                     : lit && lighting->smooth ? "smooth normals, which need other parts; flat ones don't"
                     : desc->integrator        ? "another integrator than the exact one"
                     : desc->samples != 1      ? "several samples"
                     : desc->adaptive_coarse   ? "adaptive"
                     : scene->volume->traversal != TETCAST_TRAVERSAL_SHELL ? "the traversal of faces"
                                                                           : NULL;
  return what ? ARGUMENT(context, "parts of a mesh: not possible with %s", what) : TETCAST_OK;
}

typedef struct RenderFragments {
  const TetcastScene *scene;
  const TetcastCamera *camera;
  TetcastRenderDesc desc;
  int64_t width, height;
  TetcastFragments *fragments;
  TetcastRenderStats *stats;
} RenderFragments;

static TetcastStatus render_fragments(void *data) {
  const RenderFragments *call = data;
  return tc_scene_render_fragments(call->scene, call->camera, &call->desc, call->width, call->height, call->fragments,
                                   call->stats);
}

TetcastStatus tetcast_scene_render_fragments(const TetcastScene *scene, const TetcastCamera *camera,
                                             const TetcastRenderDesc *desc, int64_t width, int64_t height,
                                             TetcastFragments *fragments, TetcastRenderStats *stats) {
  TC_ENTRY;
  const TetcastRenderDesc defaults = tetcast_render_desc_default();
  if (!desc)
    desc = &defaults;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  CHECK_GIVEN(context, camera);
  CHECK_DESC(context, desc);
  CHECK_GIVEN(context, fragments);
  fragments->count = 0;
  if (width < 1 || width > 1 << 20 || height < 1 || height > 1 << 20)
    return ARGUMENT(context, "a picture of %" PRId64 " × %" PRId64 " pixels: must be in [1, 2^20]", width, height);
  const TetcastFrame frame = {.context = context, .width = width, .height = height, .type = TETCAST_TYPE_FLOAT64};
  TetcastStatus status = check_looks(scene, desc);
  if (!status)
    status = tc_check_render(scene, camera, desc, &frame);
  RenderFragments call = {scene, camera, *desc, width, height, fragments, stats};
  return status ? status : tc_call(render_fragments, &call, &call.desc.progress);
}

typedef struct CompositeFragments {
  TetcastContext *context;
  const TetcastFragmentList *lists;
  int64_t count;
  TetcastFrame *frame;
  double *overlap;
} CompositeFragments;

static TetcastStatus composite_fragments(void *data) {
  const CompositeFragments *call = data;
  return tc_fragments_composite(call->context, call->lists, call->count, call->frame, call->overlap);
}

/* Whether lists are possible by themselves, with each other and with the frame. */
static TetcastStatus check_lists(TetcastContext *context, const TetcastFragmentList *lists, int64_t count,
                                 const TetcastFrame *frame) {
  int64_t with = -1; /* a list that has fragments */
  for (int64_t i = 0; i < count; ++i) {
    const TetcastFragmentList *list = &lists[i];
    if (list->count < 0 || (list->count > 0 && !list->data))
      return ARGUMENT(context, "fragments: list %" PRId64 " has %" PRId64 "%s", i, list->count,
                      list->data ? "" : ", and no data");
    const bool lacking = list->count > 0 && list->group_count > 0 && !list->groups;
    if (list->group_count < 0 || list->group_count > TETCAST_MAX_GROUPS || lacking)
      return ARGUMENT(context, "fragments: list %" PRId64 " has %d groups%s", i, list->group_count,
                      lacking ? ", and no numbers of theirs" : "");
    if (with >= 0 && list->count > 0 && list->group_count != lists[with].group_count)
      return ARGUMENT(context, "fragments: list %" PRId64 " has %d groups, and list %" PRId64 " has %d", with,
                      lists[with].group_count, i, list->group_count);
    with = list->count > 0 ? i : with;
  }
  for (int i = 0; with >= 0 && lists[with].group_count > 0 && i < TC_CHANNELS; ++i) {
    if (frame->channel[i] && tc_channels[i].info.of_groups && frame->groups != lists[with].group_count)
      return ARGUMENT(context, "a frame of %d groups, but the fragments have %d", frame->groups,
                      lists[with].group_count);
  }
  return TETCAST_OK;
}

TetcastStatus tetcast_fragments_composite(TetcastContext *context, const TetcastFragmentList *lists, int64_t count,
                                          TetcastFrame *frame, double *overlap) {
  TC_ENTRY;
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, frame);
  if (count < 0 || (count > 0 && !lists))
    return ARGUMENT(context, "fragments: %" PRId64 " lists%s", count, lists ? "" : " that are NULL");
  const TetcastStatus status = check_lists(context, lists, count, frame);
  if (status)
    return status;
  return tc_call(composite_fragments, &(CompositeFragments){context, lists, count, frame, overlap}, NULL);
}
