/* SPDX-License-Identifier: Apache-2.0 */
/* The public boundary of scenes: as tetcast.c. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/boundary.h"
#include "mesh/mesh.h"
#include "optics/transfer.h"
#include "render/cast.h"
#include "render/outline.h"
#include "render/rays.h"
#include "render/render.h"
#include "tetcast_scene.h"

TetcastStatus tetcast_scene_create(TetcastContext *context, const TetcastVolume *volume, TetcastScene **scene) {
  TC_ENTRY;
  CHECK_OUT(context, scene);
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, volume);
  return tc_scene_create(context, volume, scene);
}

void tetcast_scene_destroy(TetcastScene **scene) {
  TC_ENTRY;
  if (!scene)
    return;
  tc_scene_destroy(*scene);
  *scene = NULL;
}

typedef struct SetField {
  TetcastScene *scene;
  const TetcastField *field;
} SetField;

static TetcastStatus set_field(void *data) {
  const SetField *call = data;
  return tc_scene_set_field(call->scene, call->field);
}

TetcastStatus tetcast_scene_set_field(TetcastScene *scene, const TetcastField *field) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  CHECK_GIVEN(scene->context, field);
  return tc_call(set_field, &(SetField){scene, field}, NULL);
}

TetcastStatus tetcast_scene_share_field(TetcastScene *scene, const TetcastScene *other) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  CHECK_GIVEN(scene->context, other);
  if (other->volume != scene->volume)
    return ARGUMENT(scene->context, "a field of a scene of another volume");
  if (!other->values)
    return ARGUMENT(scene->context, "the other scene has no field");
  tc_scene_share_field(scene, other);
  return TETCAST_OK;
}

/* `shape` over [low, high], or the preset of this name. */
typedef struct Fit {
  const TetcastScene *scene;
  const TetcastTransferFunction *shape;
  const char *name;
  double low, high;
  TetcastTransferFunction **transfer_function;
} Fit;

static TetcastStatus fit(void *data) {
  const Fit *call = data;
  return call->shape ? tc_scene_fit(call->scene, call->shape, call->low, call->high, call->transfer_function)
                     : tc_scene_preset(call->scene, call->name, call->low, call->high, call->transfer_function);
}

static TetcastStatus check_fit(Fit *call) {
  TetcastContext *context = call->scene->context;
  if (!call->scene->values)
    return ARGUMENT(context, "a preset needs a scene with a field");
  if (!isfinite(call->low) || !isfinite(call->high) || call->low > call->high)
    return ARGUMENT(context, "range %g to %g of a preset", call->low, call->high);
  return tc_call(fit, call, NULL);
}

TetcastStatus tetcast_scene_create_preset(const TetcastScene *scene, const char *name, double low, double high,
                                          TetcastTransferFunction **transfer_function) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  CHECK_OUT(scene->context, transfer_function);
  CHECK_GIVEN(scene->context, name);
  return check_fit(&(Fit){scene, NULL, name, low, high, transfer_function});
}

TetcastStatus tetcast_scene_fit_transfer_function(const TetcastScene *scene, const TetcastTransferFunction *shape,
                                                  double low, double high,
                                                  TetcastTransferFunction **transfer_function) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  CHECK_OUT(scene->context, transfer_function);
  CHECK_GIVEN(scene->context, shape);
  return check_fit(&(Fit){scene, shape, NULL, low, high, transfer_function});
}

TetcastStatus tetcast_scene_set_transfer_function(TetcastScene *scene,
                                                  const TetcastTransferFunction *transfer_function) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  CHECK_GIVEN(scene->context, transfer_function);
  return tc_scene_set_transfer_function(scene, transfer_function);
}

TetcastStatus tetcast_scene_set_transfer_rows(TetcastScene *scene, const TetcastTransferRow *rows, int count,
                                              const TetcastField *second) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  if (count < 1 || count > TETCAST_MAX_ROWS)
    return ARGUMENT(context, "a transfer function of %d rows: must be from 1 to %d", count, TETCAST_MAX_ROWS);
  CHECK_GIVEN(context, rows);
  for (int i = 0; i < count; ++i) {
    if (!rows[i].transfer_function)
      return ARGUMENT(context, "row %d has no transfer function", i);
    if (!isfinite(rows[i].at))
      return ARGUMENT(context, "row %d is at %g, which is not finite", i, rows[i].at);
    if (i > 0 && !(rows[i].at > rows[i - 1].at)) {
      return ARGUMENT(context, "rows are not sorted: row %d at %g comes after %g", i, rows[i].at, rows[i - 1].at);
    }
  }
  if (second && tetcast_field_association(second) != TETCAST_CELL)
    return ARGUMENT(context, "the second quantity of a transfer function must be a field of cells");
  return tc_scene_set_transfer_rows(scene, rows, count, second);
}

TetcastStatus tetcast_scene_set_blend(TetcastScene *scene, TetcastBlend blend) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  if ((unsigned)blend > TETCAST_BLEND_ADDITIVE)
    return ARGUMENT(scene->context, "unknown blend mode %d", (int)blend);
  scene->blend = blend;
  tc_scene_forget(scene); /* what is visible depends on it */
  return TETCAST_OK;
}

TetcastBlend tetcast_scene_blend(const TetcastScene *scene) {
  return scene->blend;
}

static bool is_color(const double color[3]) {
  for (int k = 0; k < 3; ++k) {
    if (!(color[k] >= 0) || !isfinite(color[k]))
      return false;
  }
  return true;
}

TetcastStatus tetcast_scene_set_isosurfaces(TetcastScene *scene, const TetcastIsosurface *isosurfaces, int count) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  if (count < 0 || count > TETCAST_MAX_ISOSURFACES)
    return ARGUMENT(context, "%d isosurfaces: at most %d are possible", count, TETCAST_MAX_ISOSURFACES);
  if (count > 0)
    CHECK_GIVEN(context, isosurfaces);
  for (int i = 0; i < count; ++i) {
    const TetcastIsosurface *surface = &isosurfaces[i];
    if (!isfinite(surface->value))
      return ARGUMENT(context, "isosurface %d: the value %g is not finite", i, surface->value);
    if (!is_color(surface->color))
      return ARGUMENT(context, "isosurface %d: a colour is negative or not finite", i);
    if (!(surface->opacity >= 0 && surface->opacity <= 1))
      return ARGUMENT(context, "isosurface %d: an opacity of %g, must be in [0, 1]", i, surface->opacity);
  }
  return tc_scene_set_isosurfaces(scene, isosurfaces, count);
}

TetcastStatus tetcast_scene_set_slices(TetcastScene *scene, const TetcastSlice *slices, int count) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  if (count < 0 || count > TETCAST_MAX_SLICES)
    return ARGUMENT(context, "%d slices: at most %d are possible", count, TETCAST_MAX_SLICES);
  if (count > 0)
    CHECK_GIVEN(context, slices);
  for (int i = 0; i < count; ++i) {
    const double *n = slices[i].normal;
    if (!isfinite(n[0]) || !isfinite(n[1]) || !isfinite(n[2]) || !isfinite(slices[i].offset))
      return ARGUMENT(context, "slice %d: a number is not finite", i);
    if (n[0] == 0 && n[1] == 0 && n[2] == 0)
      return ARGUMENT(context, "slice %d: the normal has length 0", i);
    if (!(slices[i].opacity >= 0 && slices[i].opacity <= 1))
      return ARGUMENT(context, "slice %d: an opacity of %g, must be in [0, 1]", i, slices[i].opacity);
  }
  if (count > 0)
    memcpy(scene->slices, slices, (size_t)count * sizeof *slices);
  scene->slice_count = count;
  tc_scene_forget(scene);
  return TETCAST_OK;
}

TetcastStatus tetcast_scene_set_boundary(TetcastScene *scene, const TetcastBoundary *boundary) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  if (boundary && !(boundary->opacity >= 0 && boundary->opacity <= 1))
    return ARGUMENT(context, "boundary: an opacity of %g, must be in [0, 1]", boundary->opacity);
  if (boundary && boundary->colored && !is_color(boundary->color))
    return ARGUMENT(context, "boundary: a colour is negative or not finite");
  if (boundary && boundary->edges && !is_color(boundary->edge_color))
    return ARGUMENT(context, "boundary: the colour of edges is negative or not finite");
  if (boundary && boundary->opacity > 0 && scene->volume->traversal == TETCAST_TRAVERSAL_FACES)
    return ARGUMENT(context, "the mesh's boundary is seen by the traversal shell only");
  scene->boundary = boundary ? *boundary : (TetcastBoundary){.opacity = 0};
  if (!scene->boundary.colored)
    memset(scene->boundary.color, 0, sizeof scene->boundary.color);
  tc_scene_forget(scene);
  return TETCAST_OK;
}

TetcastShadingDesc tetcast_shading_desc_default(void) {
  return (TetcastShadingDesc){.cookie = TC_COOKIE,
                              .shade = TETCAST_SHADE_SURFACES,
                              .ambient = 0.2,
                              .diffuse = 0.8,
                              .specular = 0.2,
                              .exponent = 30};
}

static TetcastStatus check_light(TetcastContext *context, const TetcastLight *light, int i) {
  const double *d = light->direction;
  if (!isfinite(d[0]) || !isfinite(d[1]) || !isfinite(d[2]))
    return ARGUMENT(context, "light %d: the direction is not finite", i);
  if (d[0] == 0 && d[1] == 0 && d[2] == 0)
    return ARGUMENT(context, "light %d: the direction is 0, 0, 0", i);
  return is_color(light->color) ? TETCAST_OK : ARGUMENT(context, "light %d: a colour is negative or not finite", i);
}

TetcastStatus tetcast_scene_set_shading(TetcastScene *scene, const TetcastShadingDesc *desc) {
  TC_ENTRY;
  const TetcastShadingDesc defaults = tetcast_shading_desc_default();
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  if (!desc)
    desc = &defaults;
  TetcastContext *context = scene->context;
  CHECK_DESC(context, desc);
  if ((unsigned)desc->shade > TETCAST_SHADE_ALL)
    return ARGUMENT(context, "unknown shading %d", (int)desc->shade);
  if ((unsigned)desc->normals > TETCAST_NORMALS_FLAT)
    return ARGUMENT(context, "unknown normals %d", (int)desc->normals);
  const double shares[3] = {desc->ambient, desc->diffuse, desc->specular};
  if (!is_color(shares))
    return ARGUMENT(context, "shading: ambient %g, diffuse %g, specular %g, must be at least 0 and finite", shares[0],
                    shares[1], shares[2]);
  if (!(desc->exponent >= 1 && desc->exponent <= 10000))
    return ARGUMENT(context, "shading: an exponent of %g, must be in [1, 10000]", desc->exponent);
  if ((unsigned)desc->shadows > 1)
    return ARGUMENT(context, "shading: shadows are %d, must be 0 or 1", desc->shadows);
  if (desc->occlusion_rays < 0 || desc->occlusion_rays > 4096)
    return ARGUMENT(context, "shading: %d directions of ambient light, must be in [0, 4096]", desc->occlusion_rays);
  if (desc->light_count < 0 || desc->light_count > TETCAST_MAX_LIGHTS)
    return ARGUMENT(context, "%d lights: at most %d are possible", desc->light_count, TETCAST_MAX_LIGHTS);
  if (desc->light_count > 0)
    CHECK_GIVEN(context, desc->lights);
  for (int i = 0; i < desc->light_count; ++i) {
    const TetcastStatus status = check_light(context, &desc->lights[i], i);
    if (status)
      return status;
  }
  scene->lighting = tc_lighting_of(desc);
  tc_scene_forget_open(scene);
  return TETCAST_OK;
}

TetcastStatus tetcast_scene_set_clip(TetcastScene *scene, const TetcastHalfSpace *half_spaces, int count) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  if (count < 0)
    return ARGUMENT(context, "a clip of %d half-spaces", count);
  if (count > 0)
    CHECK_GIVEN(context, half_spaces);
  for (int i = 0; i < count; ++i) {
    const double *n = half_spaces[i].normal;
    if (!isfinite(n[0]) || !isfinite(n[1]) || !isfinite(n[2]) || !isfinite(half_spaces[i].offset))
      return ARGUMENT(context, "clip: a number of half-space %d is not finite", i);
    if (n[0] == 0 && n[1] == 0 && n[2] == 0)
      return ARGUMENT(context, "clip: the normal of half-space %d has length 0", i);
  }
  return tc_scene_set_clip(scene, half_spaces, count);
}

TetcastCoefficientsDesc tetcast_coefficients_desc_default(void) {
  return (TetcastCoefficientsDesc){.cookie = TC_COOKIE};
}

static TetcastStatus check_fields(TetcastContext *context, const TetcastField *const *fields, int count,
                                  const char *what) {
  if (count < 0 || count > TETCAST_MAX_GROUPS)
    return ARGUMENT(context, "%s of %d groups: at most %d are possible", what, count, TETCAST_MAX_GROUPS);
  if (count > 0 && !fields)
    return ARGUMENT(context, "%s: no fields", what);
  for (int i = 0; i < count; ++i) {
    if (!fields[i])
      return ARGUMENT(context, "%s: the field of group %d is NULL", what, i);
  }
  return TETCAST_OK;
}

typedef struct SetCoefficients {
  TetcastScene *scene;
  const TetcastCoefficientsDesc *desc;
} SetCoefficients;

static TetcastStatus set_coefficients(void *data) {
  const SetCoefficients *call = data;
  return tc_scene_set_coefficients(call->scene, call->desc);
}

TetcastStatus tetcast_scene_set_coefficients(TetcastScene *scene, const TetcastCoefficientsDesc *desc) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  CHECK_DESC(context, desc);
  TetcastStatus status = check_fields(context, desc->extinction, desc->extinction_count, "extinction");
  if (!status)
    status = check_fields(context, desc->emission, desc->emission_count, "emission");
  if (status)
    return status;
  if (desc->extinction_count == 0 && desc->emission_count == 0)
    return ARGUMENT(context, "coefficients: neither extinction nor emission");
  if (desc->extinction_count > 1 && desc->emission_count > 1 && desc->extinction_count != desc->emission_count) {
    return ARGUMENT(
        context, "an extinction of %d groups with an emission of %d: they must be as many, or one of the two for all",
        desc->extinction_count, desc->emission_count);
  }
  return tc_call(set_coefficients, &(SetCoefficients){scene, desc}, NULL);
}

int tetcast_scene_groups(const TetcastScene *scene) {
  return scene->coefficients ? scene->coefficients->groups : 0;
}

int64_t tetcast_scene_look(const TetcastScene *scene) {
  return tc_scene_look(scene);
}

TetcastRenderDesc tetcast_render_desc_default(void) {
  return (TetcastRenderDesc){.cookie = TC_COOKIE, .integrator_n = 1, .samples = 1, .adaptive_fine = 1};
}

static TetcastStatus check_camera(TetcastContext *context, const TetcastCamera *camera) {
  for (int k = 0; k < 3; ++k) {
    if (!isfinite(camera->eye[k]) || !isfinite(camera->target[k]) || !isfinite(camera->up[k])) {
      return ARGUMENT(context, "camera: a coordinate of eye, target or up is not finite");
    }
  }
  if (!isfinite(camera->center[0]) || !isfinite(camera->center[1]))
    return ARGUMENT(context, "camera: a center of %g, %g: must be finite", camera->center[0], camera->center[1]);
  if (camera->projection == TETCAST_PERSPECTIVE) {
    if (!(camera->fovy > 0 && camera->fovy < 180)) {
      return ARGUMENT(context, "camera: a vertical angle of %g degrees, must be in (0, 180)", camera->fovy);
    }
  } else if (camera->projection == TETCAST_ORTHOGRAPHIC) {
    if (!(camera->height > 0) || !isfinite(camera->height)) {
      return ARGUMENT(context, "camera: a height of %g, must be positive", camera->height);
    }
  } else {
    return ARGUMENT(context, "camera: unknown projection %d", (int)camera->projection);
  }
  return TETCAST_OK;
}

/* Whether the scene is one that fills the frame's channels. */
static TetcastStatus check_channels(const TetcastScene *scene, bool exact, const TetcastFrame *frame) {
  TetcastContext *context = scene->context;
  const bool error = tc_frame_channel(frame, TETCAST_CHANNEL_ERROR) != NULL;
  const TcCoefficients *c = scene->coefficients;
  for (int i = 0; i < TC_CHANNELS; ++i) {
    const TetcastChannelInfo *info = &tc_channels[i].info;
    if (!frame->channel[i])
      continue;
    if (info->needs_coefficients && !c)
      return ARGUMENT(context, "with a transfer function there is no channel %s", info->name);
    if (info->needs_composite && (c || scene->blend))
      return ARGUMENT(context, "the channel %s needs a transfer function or surfaces, and the blend mode composite",
                      info->name);
    if (info->needs_composite && !exact)
      return ARGUMENT(context, "the channel %s is known to the exact integrator only", info->name);
    if (info->needs_composite && error)
      return ARGUMENT(context, "there is no channel for the error together with the channel %s", info->name);
    if (info->needs_blend && !scene->blend)
      return ARGUMENT(context, "with the blend mode composite there is no channel %s", info->name);
    if (info->of_groups && frame->groups != c->groups) {
      return ARGUMENT(context, "a frame of %d groups, but the scene has %d", frame->groups, c->groups);
    }
  }
  return TETCAST_OK;
}

/* Whether the scene is complete, and can be seen by the exact integrator or another one, with this tolerance, with a
 * bound on the error or without. */
static TetcastStatus check_scene(const TetcastScene *scene, bool exact, double tolerance, bool error) {
  TetcastContext *context = scene->context;
  const TcCoefficients *c = scene->coefficients;
  if (c && scene->blend)
    return ARGUMENT(context, "with coefficients there is only the blend mode composite");
  if (scene->blend && !exact)
    return ARGUMENT(context, "with another blend mode than composite there is only the exact integrator");
  if (scene->blend && error)
    return ARGUMENT(context, "with another blend mode than composite there is no channel for the error");
  if (c && !exact)
    return ARGUMENT(context, "with coefficients there is only the exact integrator");
  if (!c && !scene->values)
    return ARGUMENT(context, "the scene has no field yet");
  if (tc_scene_has_surfaces(scene)) {
    if (c)
      return ARGUMENT(context, "with coefficients there are no surfaces");
    if (scene->blend)
      return ARGUMENT(context, "surfaces are seen in the blend mode composite only");
    if (!exact)
      return ARGUMENT(context, "surfaces are seen by the exact integrator only");
    if (error)
      return ARGUMENT(context, "with surfaces there is no channel for the error");
  }
  if (scene->row_count > 0) {
    if (scene->blend)
      return ARGUMENT(context, "a transfer function of two dimensions is seen in the blend mode composite only");
    if (!exact)
      return ARGUMENT(context, "the exact integrator alone knows transfer functions of two dimensions");
    if (error)
      return ARGUMENT(context, "with a transfer function of two dimensions there is no channel for the error");
    if (scene->values->association != TETCAST_POINT)
      return ARGUMENT(context, "a transfer function of two dimensions needs a field of points");
  }
  if (tc_scene_is_lit(scene)) {
    if (c)
      return ARGUMENT(context, "with coefficients no light falls on the volume");
    if (scene->blend)
      return ARGUMENT(context, "light falls on the volume in the blend mode composite only");
    if (!exact)
      return ARGUMENT(context, "the exact integrator alone knows light in the volume");
    if (error)
      return ARGUMENT(context, "with light in the volume there is no channel for the error");
    if (scene->values->association != TETCAST_POINT)
      return ARGUMENT(context, "light in the volume needs a field of points, whose gradient is that of the vertices");
  }
  if (scene->isosurface_count > 0 && scene->values->association == TETCAST_CELL)
    return ARGUMENT(context, "isosurfaces need a field of points or corners, and this one is constant in each cell");
  const bool colored = scene->isosurface_count > 0 && scene->slice_count == 0 && !(scene->boundary.opacity > 0);
  if (!c && !scene->transfer && !colored)
    return ARGUMENT(context, "the scene has no transfer function yet");
  if (!exact && (tolerance > 0 || error)) {
    return ARGUMENT(context, "only the exact integrator knows its error: no %s with another",
                    error ? "channel for the error" : "tolerance");
  }
  return TETCAST_OK;
}

/* Whether the rays' ends are those of the frame's pixels. */
static TetcastStatus check_stop(TetcastContext *context, const TetcastArray *stop, const char *name,
                                const TetcastFrame *frame) {
  if (!tc_type_is_float(stop->type))
    return ARGUMENT(context, "%s: the type must be float32 or float64", name);
  if (stop->count != frame->width * frame->height) {
    return ARGUMENT(context, "%s: %" PRId64 " distances for a frame of %" PRId64 " × %" PRId64 " pixels", name,
                    stop->count, frame->width, frame->height);
  }
  CHECK_GIVEN(context, stop->data);
  const int64_t stride = tc_array_stride(stop, 1);
  for (int64_t i = 0; i < stop->count; ++i) {
    if (isnan(tc_array_double(stop, stride, i, 0))) {
      return ARGUMENT(context, "%s: the distance of pixel (%" PRId64 ", %" PRId64 ") is NaN", name, i % frame->width,
                      i / frame->width);
    }
  }
  return TETCAST_OK;
}

/* Whether the picture can be one of few rays, if it is to be. */
static TetcastStatus check_adaptive(const TetcastScene *scene, const TetcastRenderDesc *desc,
                                    const TetcastFrame *frame) {
  TetcastContext *context = scene->context;
  const int coarse = desc->adaptive_coarse;
  if (coarse == 0)
    return TETCAST_OK;
  if (coarse < 0 || coarse > 64 || (coarse & (coarse - 1)))
    return ARGUMENT(context, "adaptive: a ray at every %d pixels, must be a power of two up to 64", coarse);
  if (!(desc->adaptive_epsilon >= 0) || !isfinite(desc->adaptive_epsilon))
    return ARGUMENT(context, "adaptive: an epsilon of %g, must be 0 or a positive number", desc->adaptive_epsilon);
  if (desc->adaptive_fine < 1 || desc->adaptive_fine > 65536)
    return ARGUMENT(context, "adaptive: %d samples in fine pixels, must be in [1, 65536]", desc->adaptive_fine);
  if (desc->samples != 1)
    return ARGUMENT(context, "adaptive: not possible with %d samples", desc->samples);
  if (scene->blend)
    return ARGUMENT(context, "adaptive: only possible in the blend mode composite");
  for (int i = 0; i < TC_CHANNELS; ++i) {
    if (frame->channel[i])
      return ARGUMENT(context, "adaptive: the channel %s can't be interpolated", tc_channels[i].info.name);
  }
  return TETCAST_OK;
}

/* Whether the frame can be a part of the picture, if it is to be. */
static TetcastStatus check_rows(const TetcastScene *scene, const TetcastRenderDesc *desc, const TetcastFrame *frame) {
  TetcastContext *context = scene->context;
  if (desc->picture_height == 0)
    return TETCAST_OK;
  if (desc->picture_height < 0 || desc->picture_height > 1 << 20 || desc->first_row < 0 ||
      desc->first_row > desc->picture_height - frame->height) {
    return ARGUMENT(context, "%" PRId64 " rows from row %" PRId64 " on, of a picture with %" PRId64, frame->height,
                    desc->first_row, desc->picture_height);
  }
  if (desc->stop || desc->start || desc->adaptive_coarse > 0)
    return ARGUMENT(context, "rows of a picture: not possible with stop, start or adaptive");
  return TETCAST_OK;
}

TetcastStatus tc_check_render(const TetcastScene *scene, const TetcastCamera *camera, const TetcastRenderDesc *desc,
                              const TetcastFrame *frame) {
  TetcastContext *context = scene->context;
  if (desc->samples < 1 || desc->samples > 65536)
    return ARGUMENT(context, "%d samples: must be in [1, 65536]", desc->samples);
  static const int least[] = {INT32_MIN, 1, 1, 1, 2}, most[] = {INT32_MAX, 1 << 20, 1 << 20, TETCAST_MAX_GAUSS, 4096};
  if ((unsigned)desc->integrator > TETCAST_INTEGRATOR_TABLE)
    return ARGUMENT(context, "unknown integrator %d", (int)desc->integrator);
  if (desc->integrator_n < least[desc->integrator] || desc->integrator_n > most[desc->integrator]) {
    return ARGUMENT(context, "an integrator with n = %d: must be in [%d, %d]", desc->integrator_n,
                    least[desc->integrator], most[desc->integrator]);
  }
  if ((unsigned)desc->isa > TETCAST_ISA_AVX512)
    return ARGUMENT(context, "unknown instruction set %d", (int)desc->isa);
  if (!(desc->tolerance >= 0) || !isfinite(desc->tolerance)) {
    return ARGUMENT(context, "a tolerance of %g: must be 0 or a positive number", desc->tolerance);
  }
  const bool exact = desc->integrator == TETCAST_INTEGRATOR_EXACT,
             error = tc_frame_channel(frame, TETCAST_CHANNEL_ERROR) != NULL;
  TetcastStatus status = check_channels(scene, exact, frame);
  if (!status)
    status = check_scene(scene, exact, desc->tolerance, error);
  if (!status)
    status = check_adaptive(scene, desc, frame);
  if (!status)
    status = check_rows(scene, desc, frame);
  if (!status)
    status = check_camera(context, camera);
  if (!status && desc->stop)
    status = check_stop(context, desc->stop, "stop", frame);
  if (!status && desc->start)
    status = check_stop(context, desc->start, "start", frame);
  return status;
}

typedef struct SceneRender {
  const TetcastScene *scene;
  const TetcastCamera *camera;
  TetcastRenderDesc desc;
  TetcastFrame *frame;
  TetcastRenderStats *stats;
} SceneRender;

static TetcastStatus scene_render(void *data) {
  const SceneRender *call = data;
  return tc_scene_render(call->scene, call->camera, &call->desc, call->frame, call->stats);
}

TetcastStatus tetcast_scene_render(const TetcastScene *scene, const TetcastCamera *camera,
                                   const TetcastRenderDesc *desc, TetcastFrame *frame, TetcastRenderStats *stats) {
  TC_ENTRY;
  const TetcastRenderDesc defaults = tetcast_render_desc_default();
  if (!desc)
    desc = &defaults;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  CHECK_GIVEN(context, camera);
  CHECK_DESC(context, desc);
  CHECK_GIVEN(context, frame);
  const TetcastStatus status = tc_check_render(scene, camera, desc, frame);
  SceneRender call = {scene, camera, *desc, frame, stats};
  return status ? status : tc_call(scene_render, &call, &call.desc.progress);
}

typedef struct Scale {
  const TetcastScene *scene;
  const TetcastTransferFunction *shape;
  const TcView *view;
  double opacity;
  TetcastTransferFunction **transfer_function;
} Scale;

static TetcastStatus scale(void *data) {
  const Scale *call = data;
  return tc_scene_scale(call->scene, call->shape, call->view, call->opacity, call->transfer_function);
}

TetcastStatus tetcast_scene_scale_transfer_function(const TetcastScene *scene, const TetcastTransferFunction *shape,
                                                    const TetcastCamera *camera, double opacity,
                                                    TetcastTransferFunction **transfer_function) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  CHECK_OUT(context, transfer_function);
  CHECK_GIVEN(context, shape);
  CHECK_GIVEN(context, camera);
  if (!scene->values)
    return ARGUMENT(context, "a transfer function is scaled by a scene with a field");
  if (!(opacity > 0 && opacity < 1))
    return ARGUMENT(context, "opacity %g is not between 0 and 1", opacity);
  TcView view;
  TetcastStatus status = check_camera(context, camera);
  if (!status)
    status = tc_view_create(context, camera, scene->volume, 4.0 / 3, &view);
  return status ? status : tc_call(scale, &(Scale){scene, shape, &view, opacity, transfer_function}, NULL);
}

TetcastStatus tetcast_scene_draw_outline(const TetcastScene *scene, const TetcastCamera *camera,
                                         const TetcastRenderDesc *desc, const double color[3], TetcastFrame *frame) {
  TC_ENTRY;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  CHECK_GIVEN(context, camera);
  CHECK_GIVEN(context, color);
  CHECK_GIVEN(context, frame);
  const TetcastRenderDesc standard = tetcast_render_desc_default();
  if (!desc)
    desc = &standard;
  CHECK_DESC(context, desc);
  if (!is_color(color))
    return ARGUMENT(context, "outline: a colour is negative or not finite");
  TcView view;
  TetcastStatus status = check_camera(context, camera);
  if (!status && desc->stop)
    status = check_stop(context, desc->stop, "stop", frame);
  if (!status)
    status = check_rows(scene, desc, frame);
  const int64_t height = desc->picture_height ? desc->picture_height : frame->height;
  if (!status)
    status = tc_view_create(context, camera, scene->volume, (double)frame->width / (double)height, &view);
  if (!status)
    tc_outline_draw(scene->volume, &view, desc->stop, color, height, desc->picture_height ? desc->first_row : 0, frame);
  return status;
}

/* ── any rays ── */

TetcastRays tetcast_rays_default(void) {
  return (TetcastRays){.cookie = TC_COOKIE};
}

TetcastCastDesc tetcast_cast_desc_default(void) {
  return (TetcastCastDesc){.cookie = TC_COOKIE};
}

/* Whether the scene can be seen without a camera, and has what is asked for. */
static TetcastStatus check_result(const TetcastScene *scene, const TetcastCastResult *result) {
  TetcastContext *context = scene->context;
  if (tc_scene_is_lit(scene))
    return ARGUMENT(context, "rays: light in the volume is seen from a camera only");
  if (scene->boundary.opacity > 0 && scene->boundary.edges)
    return ARGUMENT(context, "rays: the boundary's edges are as wide as a camera's pixels");
  if (!scene->coefficients && (result->radiance || result->group_optical_depth || result->transmittance))
    return ARGUMENT(context, "rays: only scenes with coefficients have groups");
  if (scene->blend && result->optical_depth)
    return ARGUMENT(context, "rays: with another blend mode than composite there is no optical depth");
  if (!scene->blend && result->value)
    return ARGUMENT(context, "rays: with the blend mode composite there is no value");
  return TETCAST_OK;
}

typedef struct SceneCast {
  const TetcastScene *scene;
  const TetcastRays *rays;
  TetcastCastDesc desc;
  const TetcastCastResult *result;
  TetcastRenderStats *stats;
} SceneCast;

static TetcastStatus scene_cast(void *data) {
  const SceneCast *call = data;
  return tc_scene_cast(call->scene, call->rays, &call->desc, call->result, call->stats);
}

TetcastStatus tetcast_scene_cast(const TetcastScene *scene, const TetcastRays *rays, const TetcastCastDesc *desc,
                                 const TetcastCastResult *result, TetcastRenderStats *stats) {
  TC_ENTRY;
  const TetcastCastDesc defaults = tetcast_cast_desc_default();
  if (!desc)
    desc = &defaults;
  if (!scene)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = scene->context;
  CHECK_DESC(context, rays);
  CHECK_DESC(context, desc);
  CHECK_GIVEN(context, result);
  if ((unsigned)desc->isa > TETCAST_ISA_AVX512)
    return ARGUMENT(context, "unknown instruction set %d", (int)desc->isa);
  TetcastStatus status = check_result(scene, result);
  if (!status)
    status = check_scene(scene, true, 0, result->error != NULL);
  if (!status)
    status = tc_rays_check(context, rays);
  SceneCast call = {scene, rays, *desc, result, stats};
  return status ? status : tc_call(scene_cast, &call, &call.desc.progress);
}
