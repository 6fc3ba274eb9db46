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

/* What the values of a field belong to. */
typedef enum TetcastAssociation {
  TETCAST_POINT = 0, /* one value per vertex, linear (barycentric) in each tetrahedron */
  TETCAST_CELL,      /* one value per tetrahedron, constant in it */
  TETCAST_CORNER /* four values per tetrahedron, in the order of its vertices; linear in it, may jump at its faces */
} TetcastAssociation;

/* One scalar per vertex, per cell or per corner of a cell. NaN and infinite values make the cells they touch
 * transparent. */
typedef struct TetcastField TetcastField;

/* What a field is made from. */
typedef struct TetcastFieldDesc {
  /* Set by tetcast_field_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* [n] of any type: the values, in the order of the mesh's vertices or cells. Integers beyond 2^53 are rounded to the
   * nearest double. */
  TetcastArray values;
  /* What the values belong to. Default: TETCAST_POINT. */
  TetcastAssociation association;
  /* Whether the values are copied (the default) or borrowed. A borrowed array may change between calls; scenes that
   * were given the field before keep the former values. */
  TetcastOwnership ownership;
} TetcastFieldDesc;

/* Makes a desc without values, with every setting at its default. */
TETCAST_API TetcastFieldDesc tetcast_field_desc_default(void);

/* Makes a field. Values without a known type are TETCAST_ERROR_ARGUMENT. */
TETCAST_API TetcastStatus tetcast_field_create(TetcastContext *context, const TetcastFieldDesc *desc,
                                               TetcastField **field);

/* Frees the field and sets *field to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_field_destroy(TetcastField **field);

/* What the field's values belong to. */
TETCAST_API TetcastAssociation tetcast_field_association(const TetcastField *field);

/* [n]: the field's values, of the type they came in. Valid while the field lives. */
TETCAST_API TetcastArray tetcast_field_values(const TetcastField *field);

/* Value i in [0, n) as a double. */
TETCAST_API double tetcast_field_value(const TetcastField *field, int64_t i);

/* Smallest and largest finite value (0 and 0 where there is none) and how many values are NaN or infinite.
 * Each out pointer may be NULL. */
TETCAST_API void tetcast_field_range(const TetcastField *field, double range[2], int64_t *nonfinite_count);

#ifdef __cplusplus
}
#endif

#endif
