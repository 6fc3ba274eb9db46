/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_ARRAY_H
#define TETCAST_ARRAY_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The types of numbers that arrays may hold. */
typedef enum TetcastType {
  TETCAST_TYPE_NONE = 0,
  TETCAST_TYPE_FLOAT32,
  TETCAST_TYPE_FLOAT64,
  TETCAST_TYPE_INT32,
  TETCAST_TYPE_UINT32,
  TETCAST_TYPE_INT64,
  TETCAST_TYPE_UINT64
} TetcastType;

/* A view of tuples in memory. The tuple's number of components is stated where an array is asked for, e.g. [n, 3].
 * Component j of tuple i lies at (char *)data + i * stride + j * sizeof(type); no alignment is required. */
typedef struct TetcastArray {
  /* The first component of the first tuple. May be NULL only if count is 0. */
  const void *data;
  /* The type of each component. TETCAST_TYPE_NONE: there is no array, where one may be left out. */
  TetcastType type;
  /* The number of tuples, ≥ 0. */
  int64_t count;
  /* Bytes from one tuple to the next. 0: tuples lie next to each other. */
  int64_t stride;
} TetcastArray;

/* What becomes of arrays handed in. */
typedef enum TetcastOwnership {
  TETCAST_COPY = 0, /* copied during the call */
  TETCAST_BORROW    /* referred to: must stay in place and, unless said otherwise, unchanged while the object lives */
} TetcastOwnership;

#ifdef __cplusplus
}
#endif

#endif
