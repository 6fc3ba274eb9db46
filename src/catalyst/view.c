/* SPDX-License-Identifier: Apache-2.0 */
#include "view.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

static const struct {
  const char *name;
  int size;
  TetcastType type;
} types[VIEW_TYPES] = {
    [VIEW_NONE] = {"none", 0, TETCAST_TYPE_NONE},         [VIEW_INT8] = {"int8", 1, TETCAST_TYPE_NONE},
    [VIEW_INT16] = {"int16", 2, TETCAST_TYPE_NONE},       [VIEW_INT32] = {"int32", 4, TETCAST_TYPE_INT32},
    [VIEW_INT64] = {"int64", 8, TETCAST_TYPE_INT64},      [VIEW_UINT8] = {"uint8", 1, TETCAST_TYPE_NONE},
    [VIEW_UINT16] = {"uint16", 2, TETCAST_TYPE_NONE},     [VIEW_UINT32] = {"uint32", 4, TETCAST_TYPE_UINT32},
    [VIEW_UINT64] = {"uint64", 8, TETCAST_TYPE_UINT64},   [VIEW_FLOAT32] = {"float32", 4, TETCAST_TYPE_FLOAT32},
    [VIEW_FLOAT64] = {"float64", 8, TETCAST_TYPE_FLOAT64}};

const char *view_type_name(ViewType type) {
  return types[type].name;
}

int64_t view_type_size(ViewType type) {
  return types[type].size;
}

bool view_is_real(const View *view) {
  return view->type == VIEW_FLOAT32 || view->type == VIEW_FLOAT64;
}

#define LOAD(type)                                                                                                     \
  type value;                                                                                                          \
  memcpy(&value, at, sizeof value)

double view_value(const View *view, int64_t i) {
  const char *at = view->data + i * view->stride;
  switch (view->type) {
  case VIEW_FLOAT64: {
    LOAD(double);
    return value;
  }
  case VIEW_FLOAT32: {
    LOAD(float);
    return (double)value;
  }
  case VIEW_UINT64: {
    LOAD(uint64_t);
    return (double)value;
  }
  default:
    return (double)view_index(view, i);
  }
}

int64_t view_index(const View *view, int64_t i) {
  const char *at = view->data + i * view->stride;
  switch (view->type) {
  case VIEW_INT8:
    return *(const signed char *)at;
  case VIEW_UINT8:
    return *(const unsigned char *)at;
  case VIEW_INT16: {
    LOAD(int16_t);
    return value;
  }
  case VIEW_UINT16: {
    LOAD(uint16_t);
    return value;
  }
  case VIEW_INT32: {
    LOAD(int32_t);
    return value;
  }
  case VIEW_UINT32: {
    LOAD(uint32_t);
    return value;
  }
  case VIEW_INT64: {
    LOAD(int64_t);
    return value;
  }
  case VIEW_UINT64: {
    LOAD(uint64_t);
    return value <= INT64_MAX ? (int64_t)value : -1;
  }
  default:
    return -1;
  }
}

TetcastArray view_array(const View *view) {
  return (TetcastArray){
      .data = view->data, .type = types[view->type].type, .count = view->count, .stride = view->stride};
}

View view_of_array(const TetcastArray *array) {
  static const ViewType kinds[] = {
      [TETCAST_TYPE_NONE] = VIEW_NONE,    [TETCAST_TYPE_FLOAT32] = VIEW_FLOAT32, [TETCAST_TYPE_FLOAT64] = VIEW_FLOAT64,
      [TETCAST_TYPE_INT32] = VIEW_INT32,  [TETCAST_TYPE_UINT32] = VIEW_UINT32,   [TETCAST_TYPE_INT64] = VIEW_INT64,
      [TETCAST_TYPE_UINT64] = VIEW_UINT64};
  const ViewType type = kinds[array->type];
  return (View){.data = array->data,
                .type = type,
                .count = array->count,
                .stride = array->stride ? array->stride : types[type].size};
}

void *memory_take(Memory *memory, int64_t count, size_t size) {
  if (count < 0 || (uint64_t)count > SIZE_MAX / 2 / size)
    cli_out_of_memory();
  memory->blocks = cli_grow(memory->blocks, memory->count, &memory->capacity, sizeof *memory->blocks);
  return memory->blocks[memory->count++] = cli_allocate((size_t)count * size);
}

void memory_release(Memory *memory) {
  while (memory->count > 0)
    free(memory->blocks[--memory->count]);
  free(memory->blocks);
  *memory = (Memory){0};
}
