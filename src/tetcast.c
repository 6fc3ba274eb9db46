/* SPDX-License-Identifier: Apache-2.0 */
/* The public boundary: checks arguments, guards the host's floating-point environment, and hands what takes long to a
 * thread of the library's own (call.h); nothing else. What computes nothing, and calls nothing, needs no guard. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/boundary.h"
#include "mesh/cut.h"
#include "mesh/mesh.h"
#include "optics/transfer.h"
#include "render/cast.h"
#include "render/rays.h"
#include "render/render.h"

/* ── version, status ── */

const char *tetcast_version_string(void) {
  return TETCAST_VERSION_STRING;
}

const char *tetcast_status_string(TetcastStatus status) {
  switch (status) {
  case TETCAST_OK:
    return "no error";
  case TETCAST_ERROR_ARGUMENT:
    return "invalid argument";
  case TETCAST_ERROR_MEMORY:
    return "out of memory";
  case TETCAST_ERROR_DATA:
    return "unusable data";
  case TETCAST_ERROR_LIMIT:
    return "too large";
  case TETCAST_ERROR_IO:
    return "input or output failed";
  case TETCAST_ERROR_UNSUPPORTED:
    return "not supported";
  case TETCAST_ERROR_CANCELLED:
    return "cancelled";
  case TETCAST_ERROR_EMBREE:
    return "error in Embree";
  case TETCAST_STATUS_COUNT:
    break;
  }
  return "unknown status";
}

/* ── context ── */

TetcastContextDesc tetcast_context_desc_default(void) {
  return (TetcastContextDesc){.cookie = TC_COOKIE};
}

TetcastStatus tetcast_context_create(const TetcastContextDesc *desc, TetcastContext **context) {
  TC_ENTRY;
  const TetcastContextDesc defaults = tetcast_context_desc_default();
  if (!desc)
    desc = &defaults;
  if (!context)
    return TETCAST_ERROR_ARGUMENT;
  *context = NULL;
  if (desc->cookie != TC_COOKIE || desc->threads < 0 || desc->threads > 4096 || !desc->allocate != !desc->release) {
    return TETCAST_ERROR_ARGUMENT;
  }
  return tc_context_create(desc, context);
}

void tetcast_context_destroy(TetcastContext **context) {
  TC_ENTRY;
  if (!context)
    return;
  tc_context_destroy(*context);
  *context = NULL;
}

TetcastStatus tetcast_context_set_threads(TetcastContext *context, int threads) {
  TC_ENTRY;
  CHECK_GIVEN(context, context);
  if (threads < 0 || threads > 4096)
    return ARGUMENT(context, "%d threads: must be in [0, 4096]", threads);
  atomic_store(&context->threads, threads);
  return TETCAST_OK;
}

int tetcast_context_threads(const TetcastContext *context) {
  return context ? tc_context_threads(context) : 1;
}

TetcastStatus tetcast_context_error(TetcastContext *context, TetcastStatus status, const char *format, ...) {
  TC_ENTRY;
  va_list arguments;
  va_start(arguments, format);
  tc_message_v(context, TETCAST_SEVERITY_ERROR, format, arguments);
  va_end(arguments);
  return status;
}

void tetcast_context_message(TetcastContext *context, TetcastSeverity severity, const char *format, ...) {
  TC_ENTRY;
  va_list arguments;
  va_start(arguments, format);
  tc_message_v(context, severity, format, arguments);
  va_end(arguments);
}

/* ── mesh, field ── */

static TetcastStatus check_array(TetcastContext *context, const TetcastArray *array, const char *what) {
  if (array->count < 0)
    return ARGUMENT(context, "%s: a count of %" PRId64, what, array->count);
  if (array->count > 0 && !array->data)
    return ARGUMENT(context, "%s: no data", what);
  return TETCAST_OK;
}

/* Coordinates that come in three arrays. */
static TetcastStatus check_coordinates(TetcastContext *context, const TetcastArray coordinates[3]) {
  for (int k = 0; k < 3; ++k) {
    const TetcastStatus status = check_array(context, &coordinates[k], "coordinates");
    if (status)
      return status;
    if (coordinates[k].count != coordinates[0].count)
      return ARGUMENT(context, "coordinates: %" PRId64 " in x, %" PRId64 " in %c", coordinates[0].count,
                      coordinates[k].count, "xyz"[k]);
    if (coordinates[k].count > 0 &&
        (!tc_type_is_float(coordinates[k].type) || coordinates[k].type != coordinates[0].type))
      return ARGUMENT(context, "coordinates must be float32 or float64, all three alike");
  }
  return TETCAST_OK;
}

TetcastMeshDesc tetcast_mesh_desc_default(void) {
  return (TetcastMeshDesc){.cookie = TC_COOKIE};
}

typedef struct MeshCreate {
  TetcastContext *context;
  const TetcastMeshDesc *desc;
  TetcastMesh **mesh;
} MeshCreate;

static TetcastStatus mesh_create(void *data) {
  const MeshCreate *call = data;
  return tc_mesh_create(call->context, call->desc, call->mesh);
}

TetcastStatus tetcast_mesh_create(TetcastContext *context, const TetcastMeshDesc *desc, TetcastMesh **mesh) {
  TC_ENTRY;
  CHECK_OUT(context, mesh);
  CHECK_GIVEN(context, context);
  CHECK_DESC(context, desc);
  TetcastStatus status = check_array(context, &desc->vertices, "vertices");
  if (!status)
    status = check_coordinates(context, desc->coordinates);
  if (!status && desc->vertices.count > 0 && desc->coordinates[0].count > 0)
    return ARGUMENT(context, "a mesh with both vertices and coordinates");
  if (!status)
    status = check_array(context, &desc->tetrahedra, "tetrahedra");
  if (status)
    return status;
  if (desc->vertices.count > 0 && !tc_type_is_float(desc->vertices.type)) {
    return ARGUMENT(context, "vertices must be float32 or float64");
  }
  if (desc->tetrahedra.count > 0 &&
      (tc_type_size(desc->tetrahedra.type) == 0 || tc_type_is_float(desc->tetrahedra.type))) {
    return ARGUMENT(context, "tetrahedra must be of an integer type");
  }
  if (desc->index_base != 0 && desc->index_base != 1)
    return ARGUMENT(context, "an index base of %d: it is 0 or 1", desc->index_base);
  return tc_call(mesh_create, &(MeshCreate){context, desc, mesh}, NULL);
}

void tetcast_mesh_destroy(TetcastMesh **mesh) {
  TC_ENTRY;
  if (!mesh)
    return;
  tc_mesh_destroy(*mesh);
  *mesh = NULL;
}

int64_t tetcast_mesh_vertex_count(const TetcastMesh *mesh) {
  return mesh->vertices.count;
}
int64_t tetcast_mesh_tetrahedron_count(const TetcastMesh *mesh) {
  return mesh->tetrahedra.count;
}
TetcastArray tetcast_mesh_vertices(const TetcastMesh *mesh) {
  return mesh->vertices;
}
TetcastArray tetcast_mesh_tetrahedra(const TetcastMesh *mesh) {
  return mesh->tetrahedra;
}
int tetcast_mesh_index_base(const TetcastMesh *mesh) {
  return mesh->index_base;
}
void tetcast_mesh_vertex(const TetcastMesh *mesh, int64_t i, double position[3]) {
  TC_ENTRY;
  tc_mesh_vertex(mesh, i, position);
}
void tetcast_mesh_tetrahedron(const TetcastMesh *mesh, int64_t i, int64_t indices[4]) {
  tc_mesh_tetrahedron(mesh, i, indices);
}
int tetcast_mesh_hides(const TetcastMesh *mesh, int64_t i) {
  return tc_mesh_hides(mesh, i);
}

void tetcast_mesh_bounds(const TetcastMesh *mesh, double bounds[6]) {
  memcpy(bounds, mesh->bounds, sizeof mesh->bounds);
}

typedef struct MeshExamine {
  TetcastContext *context;
  const TetcastMesh *mesh;
  TetcastMeshHealth *health;
} MeshExamine;

static TetcastStatus mesh_examine(void *data) {
  const MeshExamine *call = data;
  return tc_mesh_health(call->context, call->mesh, call->health);
}

TetcastStatus tetcast_mesh_health(TetcastContext *context, const TetcastMesh *mesh, TetcastMeshHealth *health) {
  TC_ENTRY;
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, mesh);
  CHECK_GIVEN(context, health);
  return tc_call(mesh_examine, &(MeshExamine){context, mesh, health}, NULL);
}

/* ── cells ── */

TetcastCellsDesc tetcast_cells_desc_default(void) {
  return (TetcastCellsDesc){.cookie = TC_COOKIE, .type = TETCAST_CELL_HEXAHEDRON};
}

static TetcastStatus check_cells(TetcastContext *context, const TetcastCellsDesc *desc) {
  const struct {
    const TetcastArray *array;
    const char *name;
    bool integers;
  } arrays[] = {{&desc->vertices, "vertices", false},        {&desc->offsets, "offsets", true},
                {&desc->connectivity, "connectivity", true}, {&desc->faces, "faces", true},
                {&desc->face_offsets, "face_offsets", true}, {&desc->orders, "orders", false},
                {&desc->rational, "rational", false}};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; ++i) {
    const TetcastStatus status = check_array(context, arrays[i].array, arrays[i].name);
    if (status)
      return status;
    const TetcastType type = arrays[i].array->type;
    if (arrays[i].array->count > 0 && (tc_type_size(type) == 0 || (arrays[i].integers && tc_type_is_float(type)))) {
      return ARGUMENT(context, "%s must be of %s type", arrays[i].name,
                      arrays[i].integers ? "an integer" : "a numeric");
    }
  }
  if (desc->vertices.count > 0 && !tc_type_is_float(desc->vertices.type))
    return ARGUMENT(context, "vertices must be float32 or float64");
  if (desc->subdivision < 0 || desc->subdivision > TETCAST_MAX_SUBDIVISION) {
    return ARGUMENT(context, "a subdivision of %d: must be in [0, %d]", desc->subdivision,
                    (int)TETCAST_MAX_SUBDIVISION);
  }
  if (desc->offsets.count == 0 && (desc->types || tc_cell_nodes((unsigned)desc->type) == 0)) {
    return ARGUMENT(context, "cells that are not all of one type with a fixed number of nodes need offsets");
  }
  if (desc->rational.count > 0 && desc->rational.count != desc->vertices.count) {
    return ARGUMENT(context, "%" PRId64 " rational weights for %" PRId64 " vertices", desc->rational.count,
                    desc->vertices.count);
  }
  return TETCAST_OK;
}

typedef struct CellsCut {
  TetcastContext *context;
  const TetcastCellsDesc *desc;
  TetcastCut **cut;
} CellsCut;

static TetcastStatus cells_cut(void *data) {
  const CellsCut *call = data;
  return tc_cells_cut(call->context, call->desc, call->cut);
}

TetcastStatus tetcast_cells_cut(TetcastContext *context, const TetcastCellsDesc *desc, TetcastCut **cut) {
  TC_ENTRY;
  CHECK_OUT(context, cut);
  CHECK_GIVEN(context, context);
  CHECK_DESC(context, desc);
  const TetcastStatus status = check_cells(context, desc);
  return status ? status : tc_call(cells_cut, &(CellsCut){context, desc, cut}, NULL);
}

void tetcast_cut_destroy(TetcastCut **cut) {
  TC_ENTRY;
  if (!cut)
    return;
  tc_cut_destroy(*cut);
  *cut = NULL;
}

TetcastArray tetcast_cut_tetrahedra(const TetcastCut *cut) {
  return tc_cut_tetrahedra(cut);
}
TetcastArray tetcast_cut_sources(const TetcastCut *cut) {
  return tc_cut_sources(cut);
}
bool tetcast_cut_interpolate(const TetcastCut *cut, const TetcastArray *values, int components, double *result) {
  TC_ENTRY;
  return tc_cut_interpolate(cut, values, components, result);
}
void tetcast_cut_info(const TetcastCut *cut, TetcastCutInfo *info) {
  *info = *tc_cut_info(cut);
}

TetcastFieldDesc tetcast_field_desc_default(void) {
  return (TetcastFieldDesc){.cookie = TC_COOKIE};
}

TetcastStatus tetcast_field_create(TetcastContext *context, const TetcastFieldDesc *desc, TetcastField **field) {
  TC_ENTRY;
  CHECK_OUT(context, field);
  CHECK_GIVEN(context, context);
  CHECK_DESC(context, desc);
  const TetcastStatus status = check_array(context, &desc->values, "field values");
  if (status)
    return status;
  if (desc->values.count > 0 && tc_type_size(desc->values.type) == 0)
    return ARGUMENT(context, "field values need a type");
  if ((unsigned)desc->association > TETCAST_CORNER) {
    return ARGUMENT(context, "a field belongs to points or to cells");
  }
  return tc_field_create(context, desc, field);
}

void tetcast_field_destroy(TetcastField **field) {
  TC_ENTRY;
  if (!field)
    return;
  tc_field_destroy(*field);
  *field = NULL;
}

TetcastAssociation tetcast_field_association(const TetcastField *field) {
  return field->association;
}
TetcastArray tetcast_field_values(const TetcastField *field) {
  return field->values;
}
double tetcast_field_value(const TetcastField *field, int64_t i) {
  TC_ENTRY;
  return tc_array_double(&field->values, field->values.stride, i, 0);
}
void tetcast_field_range(const TetcastField *field, double range[2], int64_t *nonfinite_count) {
  TC_ENTRY;
  tc_field_range(field, range, nonfinite_count);
}

/* ── volume ── */

TetcastVolumeDesc tetcast_volume_desc_default(void) {
  return (TetcastVolumeDesc){.cookie = TC_COOKIE};
}

/* Whether the bounds of a whole are around a part of it. */
static TetcastStatus check_bounds(TetcastContext *context, const TetcastMesh *mesh, const double bounds[6]) {
  for (int k = 0; k < 3; ++k) {
    const double low = bounds[2 * k], high = bounds[2 * k + 1];
    if (!(low >= -1e300 && low <= high && high <= 1e300))
      return ARGUMENT(context, "bounds from %g to %g in %c: must ascend, within 1e300", low, high, "xyz"[k]);
    if (mesh->bounds[2 * k] >= low && mesh->bounds[2 * k + 1] <= high)
      continue;
    return ARGUMENT(context, "bounds from %g to %g in %c: the mesh reaches from %g to %g", low, high, "xyz"[k],
                    mesh -> bounds[2 * k], mesh -> bounds[2 * k + 1]);
  }
  return TETCAST_OK;
}

typedef struct VolumeCreate {
  TetcastContext *context;
  const TetcastMesh *mesh;
  TetcastVolumeDesc desc;
  TetcastVolume **volume;
} VolumeCreate;

static TetcastStatus volume_create(void *data) {
  const VolumeCreate *call = data;
  return tc_volume_create(call->context, call->mesh, &call->desc, call->volume);
}

TetcastStatus tetcast_volume_create(TetcastContext *context, const TetcastMesh *mesh, const TetcastVolumeDesc *desc,
                                    TetcastVolume **volume) {
  TC_ENTRY;
  const TetcastVolumeDesc defaults = tetcast_volume_desc_default();
  if (!desc)
    desc = &defaults;
  CHECK_OUT(context, volume);
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, mesh);
  CHECK_DESC(context, desc);
  if (desc->traversal != TETCAST_TRAVERSAL_SHELL && desc->traversal != TETCAST_TRAVERSAL_FACES) {
    return ARGUMENT(context, "unknown traversal %d", (int)desc->traversal);
  }
  const TetcastStatus status = desc->bounds ? check_bounds(context, mesh, desc->bounds) : TETCAST_OK;
  if (status)
    return status;
  VolumeCreate call = {context, mesh, *desc, volume};
  return tc_call(volume_create, &call, &call.desc.progress);
}

void tetcast_volume_destroy(TetcastVolume **volume) {
  TC_ENTRY;
  if (!volume)
    return;
  tc_volume_destroy(*volume);
  *volume = NULL;
}

void tetcast_volume_info(const TetcastVolume *volume, TetcastVolumeInfo *info) {
  tc_volume_info(volume, info);
}

TetcastTraceDesc tetcast_trace_desc_default(void) {
  return (TetcastTraceDesc){.cookie = TC_COOKIE, .weights = 1};
}

typedef struct VolumeTrace {
  const TetcastVolume *volume;
  const TetcastRays *rays;
  TetcastTraceDesc desc;
  TetcastTraceFunction *function;
  void *user;
} VolumeTrace;

static TetcastStatus volume_trace(void *data) {
  const VolumeTrace *call = data;
  return tc_volume_trace(call->volume, call->rays, &call->desc, call->function, call->user);
}

TetcastStatus tetcast_volume_trace(const TetcastVolume *volume, const TetcastRays *rays, const TetcastTraceDesc *desc,
                                   TetcastTraceFunction *function, void *user) {
  TC_ENTRY;
  const TetcastTraceDesc defaults = tetcast_trace_desc_default();
  if (!desc)
    desc = &defaults;
  if (!volume)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = volume->context;
  CHECK_DESC(context, rays);
  CHECK_DESC(context, desc);
  CHECK_GIVEN(context, function);
  if ((unsigned)desc->isa > TETCAST_ISA_AVX512)
    return ARGUMENT(context, "unknown instruction set %d", (int)desc->isa);
  const TetcastStatus status = tc_rays_check(context, rays);
  VolumeTrace call = {volume, rays, *desc, function, user};
  return status ? status : tc_call(volume_trace, &call, &call.desc.progress);
}

/* ── transfer function ── */

TetcastTransferFunctionDesc tetcast_transfer_function_desc_default(void) {
  return (TetcastTransferFunctionDesc){.cookie = TC_COOKIE, .unit_distance = 1};
}

TetcastStatus tetcast_transfer_function_create(TetcastContext *context, const TetcastTransferFunctionDesc *desc,
                                               TetcastTransferFunction **transfer_function) {
  TC_ENTRY;
  CHECK_OUT(context, transfer_function);
  CHECK_GIVEN(context, context);
  CHECK_DESC(context, desc);
  if ((unsigned)desc->opacity_model > TETCAST_OPACITY_OSPRAY) {
    return ARGUMENT(context, "unknown opacity model %d", (int)desc->opacity_model);
  }
  return tc_transfer_create(context, desc, transfer_function);
}

const char *tetcast_preset_name(int i) {
  return tc_preset_name(i);
}

TetcastPresetKind tetcast_preset_kind(const char *name) {
  return name ? tc_preset_kind(name) : TETCAST_PRESET_NONE;
}

TetcastStatus tetcast_transfer_function_create_preset(TetcastContext *context, const char *name, double low,
                                                      double high, double extinction,
                                                      TetcastTransferFunction **transfer_function) {
  TC_ENTRY;
  CHECK_OUT(context, transfer_function);
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, name);
  if (!isfinite(low) || !isfinite(high) || low > high)
    return ARGUMENT(context, "range %g to %g of a preset", low, high);
  if (!isfinite(extinction) || extinction < 0)
    return ARGUMENT(context, "extinction %g of a preset", extinction);
  return tc_transfer_create_preset(context, name, low, high, extinction, transfer_function);
}

TetcastStatus tetcast_transfer_function_stretch(TetcastContext *context, const TetcastTransferFunction *shape,
                                                double low, double high, double extinction,
                                                TetcastTransferFunction **transfer_function) {
  TC_ENTRY;
  CHECK_OUT(context, transfer_function);
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, shape);
  if (!isfinite(low) || !isfinite(high) || low > high)
    return ARGUMENT(context, "range %g to %g of a transfer function", low, high);
  if (!isfinite(extinction) || extinction < 0)
    return ARGUMENT(context, "extinction %g of a transfer function", extinction);
  return tc_transfer_stretch(context, shape, low, high, extinction, transfer_function);
}

TetcastStatus tetcast_opacity_factor(TetcastContext *context, const double *depths, int64_t count, double opacity,
                                     int clear, double *factor) {
  TC_ENTRY;
  CHECK_GIVEN(context, context);
  CHECK_GIVEN(context, depths);
  CHECK_GIVEN(context, factor);
  if (count < 1)
    return ARGUMENT(context, "%" PRId64 " optical depths", count);
  if (!(opacity > 0 && opacity < 1))
    return ARGUMENT(context, "opacity %g is not between 0 and 1", opacity);
  for (int64_t i = 0; i < count; ++i) {
    if (!(depths[i] > 0 && isfinite(depths[i])))
      return ARGUMENT(context, "optical depth %" PRId64 " is %g", i, depths[i]);
  }
  return tc_opacity_factor(context, depths, count, opacity, clear != 0, factor);
}

void tetcast_transfer_function_destroy(TetcastTransferFunction **transfer_function) {
  TC_ENTRY;
  if (!transfer_function)
    return;
  tc_transfer_destroy(*transfer_function);
  *transfer_function = NULL;
}

const double *tetcast_transfer_function_color(const TetcastTransferFunction *transfer_function, int64_t *count) {
  if (count)
    *count = transfer_function->color_count;
  return transfer_function->color;
}

const double *tetcast_transfer_function_extinction(const TetcastTransferFunction *transfer_function, int64_t *count) {
  if (count)
    *count = transfer_function->extinction_count;
  return transfer_function->extinction;
}

/* ── camera, frame ── */

TetcastCamera tetcast_camera_default(const double bounds[6], double aspect) {
  TC_ENTRY;
  return tc_camera_default(bounds, aspect);
}

TetcastFrameDesc tetcast_frame_desc_default(void) {
  return (TetcastFrameDesc){.cookie = TC_COOKIE, .type = TETCAST_TYPE_FLOAT64, .groups = 1};
}

TetcastStatus tetcast_frame_create(TetcastContext *context, const TetcastFrameDesc *desc, TetcastFrame **frame) {
  TC_ENTRY;
  const int64_t largest = INT64_C(1) << 20;
  CHECK_OUT(context, frame);
  CHECK_GIVEN(context, context);
  CHECK_DESC(context, desc);
  if (desc->width < 1 || desc->height < 1 || desc->width > largest || desc->height > largest) {
    return ARGUMENT(context, "a frame of %" PRId64 " × %" PRId64 " pixels: each must be in [1, %" PRId64 "]",
                    desc->width, desc->height, largest);
  }
  if (!tc_type_is_float(desc->type))
    return ARGUMENT(context, "a frame's type must be float32 or float64");
  uint32_t known = 0;
  for (int i = 0; i < TC_CHANNELS; ++i)
    known |= tc_channels[i].info.channel;
  if (desc->channels & ~known) {
    return ARGUMENT(context, "a frame with channels 0x%" PRIx32 ": some are unknown", desc->channels);
  }
  if (desc->groups < 1 || desc->groups > TETCAST_MAX_GROUPS) {
    return ARGUMENT(context, "a frame of %d groups: must be in [1, %d]", desc->groups, TETCAST_MAX_GROUPS);
  }
  const int64_t row = desc->width * 4 * (int64_t)tc_type_size(desc->type);
  if (desc->pixels && desc->row_stride != 0 && desc->row_stride < row && desc->row_stride > -row) {
    return ARGUMENT(context, "a row stride of %" PRId64 " bytes, but a row has %" PRId64, desc->row_stride, row);
  }
  return tc_frame_create(context, desc, frame);
}

void tetcast_frame_destroy(TetcastFrame **frame) {
  TC_ENTRY;
  if (!frame)
    return;
  tc_frame_destroy(*frame);
  *frame = NULL;
}

int64_t tetcast_frame_width(const TetcastFrame *frame) {
  return frame->width;
}
int64_t tetcast_frame_height(const TetcastFrame *frame) {
  return frame->height;
}
TetcastType tetcast_frame_type(const TetcastFrame *frame) {
  return frame->type;
}
const void *tetcast_frame_pixels(const TetcastFrame *frame) {
  return frame->pixels;
}
int64_t tetcast_frame_row_stride(const TetcastFrame *frame) {
  return frame->row_stride;
}
int tetcast_frame_groups(const TetcastFrame *frame) {
  return frame->groups;
}
const TetcastChannelInfo *tetcast_channel_info(int i) {
  return i >= 0 && i < TC_CHANNELS ? &tc_channels[i].info : NULL;
}
const void *tetcast_frame_channel(const TetcastFrame *frame, TetcastChannel channel) {
  return tc_frame_channel(frame, channel);
}

TetcastStatus tetcast_frame_recolor(TetcastFrame *frame, const TetcastTransferFunction *transfer_function) {
  TC_ENTRY;
  if (!frame)
    return TETCAST_ERROR_ARGUMENT;
  CHECK_GIVEN(frame->context, transfer_function);
  if (!tc_frame_channel(frame, TETCAST_CHANNEL_VALUE))
    return ARGUMENT(frame->context, "to colour a frame anew it must have the channel value");
  tc_frame_recolor(frame, &transfer_function->pieces);
  return TETCAST_OK;
}

typedef struct FrameBytes {
  const TetcastFrame *frame;
  const double *background;
  int channels;
  unsigned char *bytes;
  int64_t row_stride;
} FrameBytes;

static TetcastStatus frame_bytes(void *data) {
  const FrameBytes *call = data;
  tc_frame_bytes(call->frame, call->background, call->channels, call->bytes, call->row_stride);
  return TETCAST_OK;
}

TetcastStatus tetcast_frame_bytes(const TetcastFrame *frame, const double background[4], int channels,
                                  unsigned char *bytes, int64_t row_stride) {
  TC_ENTRY;
  if (!frame)
    return TETCAST_ERROR_ARGUMENT;
  TetcastContext *context = frame->context;
  CHECK_GIVEN(context, background);
  CHECK_GIVEN(context, bytes);
  for (int k = 0; k < 4; ++k) {
    if (!(background[k] >= 0 && background[k] <= 1))
      return ARGUMENT(context, "background component %g is outside [0, 1]", background[k]);
  }
  if (channels != 3 && channels != 4)
    return ARGUMENT(context, "a frame as bytes of %d channels: must be 3 or 4", channels);
  const int64_t row = frame->width * channels;
  if (row_stride != 0 && row_stride < row && row_stride > -row)
    return ARGUMENT(context, "a row stride of %" PRId64 " bytes, but a row has %" PRId64, row_stride, row);
  return tc_call(frame_bytes, &(FrameBytes){frame, background, channels, bytes, row_stride}, NULL);
}
