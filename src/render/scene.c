/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "render/render.h"

TetcastStatus tc_scene_create(TetcastContext *context, const TetcastVolume *volume, TetcastScene **out) {
  TetcastScene *scene;
  TcPrepared *prepared;
  if (!tc_allocate_array(context, (void **)&scene, 1, sizeof *scene, "scene"))
    return TETCAST_ERROR_MEMORY;
  if (!tc_allocate_array(context, (void **)&prepared, 1, sizeof *prepared, "scene")) {
    tc_release(context, scene);
    return TETCAST_ERROR_MEMORY;
  }
  memset(prepared, 0, sizeof *prepared);
  pthread_mutex_init(&prepared->mutex, NULL); /* with default attributes this can't fail */
  *scene = (TetcastScene){.context = context, .volume = volume, .prepared = prepared};
  const TetcastShadingDesc shading = tetcast_shading_desc_default();
  scene->lighting = tc_lighting_of(&shading);
  *out = scene;
  return TETCAST_OK;
}

/* Frees what was prepared for the field, the transfer function and the isosurfaces, as one of them changes. */
static void forget(TetcastContext *context, TcPrepared *prepared) {
  tc_release(context, prepared->isosurfaces);
  prepared->isosurfaces = NULL;
  tc_release(context, prepared->open);
  prepared->open = NULL;
  tc_shell_clear(&prepared->shell);
  tc_transfer_destroy(prepared->scaled);
  prepared->scaled = NULL;
  tc_release(context, (void *)prepared->second.cell);
  tc_second_clear(context, &prepared->second);
  prepared->ready = false;
}

void tc_scene_forget(TetcastScene *scene) {
  forget(scene->context, scene->prepared);
}

/* The transfer function in the volume's units. Without one, isosurfaces are in a volume that is not seen. */
static TetcastStatus scale_transfer(const TetcastScene *scene, TetcastTransferFunction **scaled) {
  TetcastTransferFunction *nothing = NULL;
  TetcastStatus status = TETCAST_OK;
  if (!scene->transfer) {
    TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
    static const double color[4] = {0, 0, 0, 0}, extinction[2] = {0, 0};
    desc.color = color;
    desc.extinction = extinction;
    desc.color_count = desc.extinction_count = 1;
    status = tc_transfer_create(scene->context, &desc, &nothing);
  }
  if (!status)
    status = tc_transfer_rescale(scene->context, nothing ? nothing : scene->transfer, scene->values->exponent,
                                 scene->volume->exponent, scaled);
  tc_transfer_destroy(nothing);
  return status;
}

/* What is made of the transfer function and of surfaces, in the volume's units. */
static TetcastStatus prepare_optics(const TetcastScene *scene) {
  TcPrepared *prepared = scene->prepared;
  TetcastStatus status = scale_transfer(scene, &prepared->scaled);
  if (!status && scene->row_count > 0)
    status = tc_scene_scale_rows(scene, &prepared->scaled->pieces, &prepared->second);
  return status ? status : tc_scene_scale_isosurfaces(scene, &prepared->isosurfaces);
}

/* A blend mode and coefficients look at all of the volume, a slice may be anywhere, and the boundary is all of it. */
static TetcastStatus prepare_shell(const TetcastScene *scene) {
  TcPrepared *prepared = scene->prepared;
  TcShellOf of = {.volume = scene->volume, .clip = scene->clip, .clip_count = scene->clip_count};
  if (prepared->scaled && scene->slice_count == 0 && !(scene->boundary.opacity > 0)) {
    of.rows = scene->values;
    of.pieces = &prepared->scaled->pieces;
    of.isosurfaces = prepared->isosurfaces;
    of.isosurface_count = scene->isosurface_count;
  }
  return tc_shell_build(&of, &prepared->shell);
}

/* Several threads may call this for one scene at the same time: the first does the work, the others wait for it. What
 * is freed here is not in use, as neither field nor transfer function may change while the scene renders. */
TetcastStatus tc_scene_prepare(const TetcastScene *scene) {
  TcPrepared *prepared = scene->prepared;
  TetcastStatus status = TETCAST_OK;
  pthread_mutex_lock(&prepared->mutex);
  if (!prepared->ready) {
    forget(scene->context, prepared);
    if (!scene->coefficients && !scene->blend)
      status = prepare_optics(scene);
    prepared->ready = !status;
  }
  if (!status && !prepared->shell.volume)
    status = prepare_shell(scene);
  pthread_mutex_unlock(&prepared->mutex);
  return status;
}

void tc_scene_forget_open(TetcastScene *scene) {
  tc_release(scene->context, scene->prepared->open);
  scene->prepared->open = NULL;
}

void *tc_scene_swap_vertices(const TetcastScene *scene, bool single, void *vertices) {
  TcPrepared *prepared = scene->prepared;
  pthread_mutex_lock(&prepared->mutex);
  void *before = prepared->vertices[single];
  prepared->vertices[single] = vertices;
  pthread_mutex_unlock(&prepared->mutex);
  return before;
}

void tc_scene_destroy(TetcastScene *scene) {
  if (!scene)
    return;
  forget(scene->context, scene->prepared);
  tc_gradients_clear(&scene->prepared->gradients);
  tc_release(scene->context, scene->isosurfaces);
  for (int i = 0; i < 2; ++i)
    tc_release(scene->context, scene->prepared->vertices[i]);
  pthread_mutex_destroy(&scene->prepared->mutex);
  tc_release(scene->context, scene->prepared);
  tc_rows_release(scene->values);
  tc_scene_clear_rows(scene);
  tc_transfer_destroy(scene->transfer);
  tc_coefficients_destroy(scene->coefficients);
  tc_release(scene->context, scene->clip);
  tc_release(scene->context, scene);
}

/* Makes `rows` the scene's scalar, and takes over the caller's reference to them. */
static void bind(TetcastScene *scene, TcRows *rows) {
  forget(scene->context, scene->prepared);
  tc_gradients_clear(&scene->prepared->gradients);
  tc_rows_release(scene->values);
  scene->values = rows;
}

TetcastStatus tc_scene_set_field(TetcastScene *scene, const TetcastField *field) {
  TcRows *rows;
  const TetcastStatus status = tc_rows_of_scalar(scene->volume, field, &rows);
  if (!status)
    bind(scene, rows);
  return status;
}

void tc_scene_share_field(TetcastScene *scene, const TetcastScene *other) {
  tc_rows_retain(other->values);
  bind(scene, other->values);
}

/* Makes a transfer function or coefficients the scene's own, in place of what it had. At most one of the two is given,
 * the other is NULL. */
static void replace(TetcastScene *scene, TetcastTransferFunction *transfer, TcCoefficients *coefficients) {
  forget(scene->context, scene->prepared);
  tc_scene_clear_rows(scene);
  tc_transfer_destroy(scene->transfer);
  tc_coefficients_destroy(scene->coefficients);
  scene->transfer = transfer;
  scene->coefficients = coefficients;
}

TetcastStatus tc_scene_set_transfer_function(TetcastScene *scene, const TetcastTransferFunction *transfer) {
  TetcastTransferFunction *copy;
  const TetcastStatus status = tc_transfer_copy(scene->context, transfer, &copy);
  if (!status)
    replace(scene, copy, NULL);
  return status;
}

TetcastStatus tc_scene_set_transfer_rows(TetcastScene *scene, const TetcastTransferRow *rows, int count,
                                         const TetcastField *second) {
  TetcastContext *context = scene->context;
  TetcastTransferFunction **copies, *hull = NULL;
  double *at;
  TcRows *cells = NULL;
  if (!tc_allocate_array(context, (void **)&copies, count, sizeof(*copies), "transfer function"))
    return TETCAST_ERROR_MEMORY;
  memset(copies, 0, (size_t)count * sizeof *copies);
  TetcastStatus status = tc_allocate_array(context, (void **)&at, count, sizeof *at, "transfer function")
                             ? TETCAST_OK
                             : TETCAST_ERROR_MEMORY;
  for (int i = 0; !status && i < count; ++i) {
    at[i] = rows[i].at;
    status = tc_transfer_copy(context, rows[i].transfer_function, &copies[i]);
  }
  if (!status)
    status = tc_second_hull(context, copies, count, &hull);
  if (!status && second)
    status = tc_rows_of_scalar(scene->volume, second, &cells);
  if (status) {
    for (int i = 0; i < count; ++i)
      tc_transfer_destroy(copies[i]);
    tc_release(context, copies);
    tc_release(context, at);
    tc_transfer_destroy(hull);
    return status;
  }
  replace(scene, hull, NULL);
  scene->rows = copies;
  scene->row_at = at;
  scene->row_count = count;
  scene->second = cells;
  return TETCAST_OK;
}

TetcastStatus tc_scene_set_coefficients(TetcastScene *scene, const TetcastCoefficientsDesc *desc) {
  TcCoefficients *copy;
  const TetcastStatus status = tc_coefficients_create(scene->volume, desc, &copy);
  if (!status)
    replace(scene, NULL, copy);
  return status;
}

TetcastStatus tc_scene_set_clip(TetcastScene *scene, const TetcastHalfSpace *half_spaces, int count) {
  TcHalfSpace *clip;
  int kept;
  const TetcastStatus status = tc_clip_create(scene->volume, half_spaces, count, &clip, &kept);
  if (status)
    return status;
  tc_release(scene->context, scene->clip);
  scene->clip = clip;
  scene->clip_count = kept;
  tc_shell_clear(&scene->prepared->shell);
  tc_scene_forget_open(scene); /* what is cut off throws no shadow */
  return TETCAST_OK;
}
