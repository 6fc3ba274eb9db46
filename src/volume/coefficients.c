/* SPDX-License-Identifier: Apache-2.0 */
#include "volume/coefficients.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "mesh/mesh.h"

/* What checks and their messages need to know of a coefficient. */
typedef struct List {
  const char *name;
  const TetcastField *const *fields;
  int count;
} List;

static const char *place_name(const TetcastField *field) {
  return field->association == TETCAST_POINT ? "vertex" : "tetrahedron";
}

static TetcastStatus check_field(const TetcastVolume *volume, const List *list, int i, bool extinction) {
  const TetcastField *field = list->fields[i];
  if (field->association == TETCAST_CORNER)
    return tc_error(volume->context, TETCAST_ERROR_ARGUMENT, "%s: a field of corners can't be one", list->name);
  const int64_t wanted = field->association == TETCAST_POINT ? volume->vertex_count : volume->mesh_cell_count;
  if (field->values.count != wanted) {
    return tc_error(volume->context, TETCAST_ERROR_ARGUMENT, "%s has %" PRId64 " values, the mesh %" PRId64 " %s",
                    list->name, field->values.count, wanted,
                    field->association == TETCAST_POINT ? "vertices" : "tetrahedra");
  }
  if (tc_field_jumps(volume, field)) {
    return tc_error(
        volume->context, TETCAST_ERROR_ARGUMENT,
        "%s: points of different cells at one place have different values, which only a transfer function can show",
        list->name);
  }
  double range[2] = {0, 0};
  if (extinction)
    tc_field_range(field, range, NULL);
  if (!(range[0] < 0))
    return TETCAST_OK;
  int64_t at = 0;
  while (!(tc_field_at(field, at) < 0))
    ++at;
  char group[32] = "";
  if (list->count > 1)
    snprintf(group, sizeof group, " of group %d", i);
  return tc_error(volume->context, TETCAST_ERROR_DATA, "%s: a negative extinction%s, %g at %s %" PRId64, list->name,
                  group, tc_field_at(field, at), place_name(field), at);
}

static TetcastStatus check_list(const TetcastVolume *volume, const List *list, bool extinction) {
  for (int i = 0; i < list->count; ++i) {
    const TetcastStatus status = check_field(volume, list, i, extinction);
    if (status)
      return status;
  }
  return TETCAST_OK;
}

/* ── binding ── */

static double largest_of(const List *list, int i) {
  double range[2];
  tc_field_range(list->fields[i], range, NULL);
  return fmax(fabs(range[0]), fabs(range[1]));
}

/* The exponent of the largest emission. */
static int emission_exponent(const List *emission) {
  double largest = 0;
  for (int i = 0; i < emission->count; ++i)
    largest = fmax(largest, largest_of(emission, i));
  int exponent = 0;
  if (largest > 0)
    frexp(largest, &exponent);
  return exponent < -1000 ? -1000 : exponent; /* so that 2^−exponent doesn't overflow */
}

/* The fields of one association, those of extinction first, and the slot of each. */
static TetcastStatus bind_association(const TetcastVolume *volume, const List lists[2], TetcastAssociation association,
                                      int first_slot, int *const slots[2], TcRows **rows) {
  const TetcastField *fields[2 * TETCAST_MAX_GROUPS];
  int width = 0;
  for (int l = 0; l < 2; ++l) {
    for (int i = 0; i < lists[l].count; ++i) {
      if (lists[l].fields[i]->association != association)
        continue;
      slots[l][i] = first_slot + width;
      fields[width++] = lists[l].fields[i];
    }
  }
  return width ? tc_rows_of_fields(volume, fields, width, rows) : TETCAST_OK;
}

static TetcastStatus bind_all(const TetcastVolume *volume, const List lists[2], TcCoefficients *c) {
  if (!tc_allocate_array(c->context, (void **)&c->slots, 2 * (int64_t)c->groups, sizeof *c->slots, "coefficients") ||
      !tc_allocate_array(c->context, (void **)&c->largest, 2 * (int64_t)c->groups, sizeof *c->largest, "coefficients"))
    return TETCAST_ERROR_MEMORY;
  int *const slots[2] = {c->slots, c->slots + c->groups};
  TetcastStatus status = bind_association(volume, lists, TETCAST_POINT, 0, slots, &c->points);
  if (!status)
    status = bind_association(volume, lists, TETCAST_CELL, c->points ? c->points->width : 0, slots, &c->cells);
  for (int l = 0; !status && l < 2; ++l) {
    double *largest = c->largest + l * c->groups;
    for (int g = 0; g < lists[l].count; ++g)
      largest[g] = largest_of(&lists[l], g);
    for (int g = lists[l].count; g < c->groups; ++g) {
      slots[l][g] = lists[l].count ? slots[l][0] : -1;
      largest[g] = lists[l].count ? largest[0] : 0;
    }
  }
  return status;
}

TetcastStatus tc_coefficients_create(const TetcastVolume *volume, const TetcastCoefficientsDesc *desc,
                                     TcCoefficients **out) {
  const List lists[2] = {
      {desc->extinction_name ? desc->extinction_name : "extinction", desc->extinction, desc->extinction_count},
      {desc->emission_name ? desc->emission_name : "emission", desc->emission, desc->emission_count}};
  TetcastStatus status = check_list(volume, &lists[0], true);
  if (!status)
    status = check_list(volume, &lists[1], false);
  if (status)
    return status;
  TcCoefficients *c;
  if (!tc_allocate_array(volume->context, (void **)&c, 1, sizeof *c, "coefficients"))
    return TETCAST_ERROR_MEMORY;
  const int half = volume->exponent / 2, brightest = emission_exponent(&lists[1]);
  *c = (TcCoefficients){.context = volume->context,
                        .scale = {ldexp(1, half), ldexp(1, volume->exponent - half)},
                        .emission_exponent = brightest,
                        .emission_scale = ldexp(1, -brightest),
                        .extinction_count = desc->extinction_count,
                        .emission_count = desc->emission_count,
                        .groups = desc->extinction_count > desc->emission_count ? desc->extinction_count
                                                                                : desc->emission_count};
  status = bind_all(volume, lists, c);
  if (status) {
    tc_coefficients_destroy(c);
    return status;
  }
  *out = c;
  return TETCAST_OK;
}

void tc_coefficients_destroy(TcCoefficients *c) {
  if (!c)
    return;
  tc_rows_release(c->points);
  tc_rows_release(c->cells);
  tc_release(c->context, c->slots);
  tc_release(c->context, c->largest);
  tc_release(c->context, c);
}
