/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_FIELD_H
#define TETCAST_FIELD_H

#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/context.h>
#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum TetcastAssociation {
  TETCAST_POINT = 0, /* one value per vertex, linear (barycentric) in each tetrahedron */
  TETCAST_CELL,      /* one value per tetrahedron, constant in it */
  TETCAST_CORNER     /* four values per tetrahedron, in the order of its vertices: linear in it, with jumps between
                        tetrahedra */
} TetcastAssociation;

/* One scalar per vertex, per cell or per corner of a cell. NaN and infinite values make the cells they touch
 * transparent. */
typedef struct TetcastField TetcastField;

typedef struct TetcastFieldDesc {
  uint32_t cookie;
  TetcastArray values; /* [n] any type; integers beyond 2^53 are rounded to the nearest double */
  TetcastAssociation association;
  TetcastOwnership
      ownership; /* a borrowed array may change between calls; what was set from it before keeps its values */
} TetcastFieldDesc;

TETCAST_API TetcastFieldDesc tetcast_field_desc_default(void);

TETCAST_API TetcastStatus tetcast_field_create(TetcastContext *context, const TetcastFieldDesc *desc,
                                               TetcastField **field);

/* Frees the field and sets *field to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_field_destroy(TetcastField **field);

TETCAST_API TetcastAssociation tetcast_field_association(const TetcastField *field);
TETCAST_API TetcastArray tetcast_field_values(const TetcastField *field); /* [n], of the type they came in */
TETCAST_API double tetcast_field_value(const TetcastField *field, int64_t i);

/* Smallest and largest finite value (0 and 0 where there is none) and how many values are NaN or infinite.
 * Each out pointer may be NULL. */
TETCAST_API void tetcast_field_range(const TetcastField *field, double range[2], int64_t *nonfinite_count);

#ifdef __cplusplus
}
#endif

#endif
