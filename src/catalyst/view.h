/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers in a simulation's memory, of any type that Conduit has, and memory of one's own beside them. */
#ifndef TETCAST_CATALYST_VIEW_H
#define TETCAST_CATALYST_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <tetcast/array.h>

typedef enum ViewType {
  VIEW_NONE,
  VIEW_INT8,
  VIEW_INT16,
  VIEW_INT32,
  VIEW_INT64,
  VIEW_UINT8,
  VIEW_UINT16,
  VIEW_UINT32,
  VIEW_UINT64,
  VIEW_FLOAT32,
  VIEW_FLOAT64,
  VIEW_TYPES
} ViewType;

/* Number i lies at data + i * stride, with no particular alignment. */
typedef struct View {
  const char *data;
  ViewType type;
  int64_t count, stride;
} View;

/* "float64" and the like; in static storage. */
const char *view_type_name(ViewType type);
int64_t view_type_size(ViewType type);
bool view_is_real(const View *view);

/* Number i as a double; as an index, -1 where it is beyond 64 bits with a sign. */
double view_value(const View *view, int64_t i);
int64_t view_index(const View *view, int64_t i);

/* The same as the library's, of TETCAST_TYPE_NONE where it has no such type: of 8 and 16 bits. */
TetcastArray view_array(const View *view);

/* A view of the library's: of the first components where it has tuples. */
View view_of_array(const TetcastArray *array);

/* Blocks of memory that go together. */
typedef struct Memory {
  void **blocks;
  int count, capacity;
} Memory;

/* `count` elements of this size, not set. */
void *memory_take(Memory *memory, int64_t count, size_t size);
void memory_release(Memory *memory);

#endif
