/* SPDX-License-Identifier: Apache-2.0 */
/* Scalars that `tetcast mesh` can attach to the vertices of a mesh, so that there is something to render. */
#ifndef TETCAST_CLI_FIELDS_H
#define TETCAST_CLI_FIELDS_H

#include <tetcast/context.h>
#include <tetcast/mesh.h>

enum { FIELD_PARAMETERS = 4 };

typedef struct FieldSpec {
  const char *name; /* static storage */
  int kind;
  double parameters[FIELD_PARAMETERS];
} FieldSpec;

/* Reads NAME[:PARAMETER,…]; −1, or the exit code after a message. */
int field_parse(const char *text, FieldSpec *spec);

/* values[i] at vertex i; array of the mesh's number of vertices. */
TetcastStatus field_compute(TetcastContext *context, const TetcastMesh *mesh, const FieldSpec *spec, double *values);

/* Name of field i = 0, 1, …; NULL beyond the last. Static storage. */
const char *field_name(int i);

/* One line a field on standard output. */
void field_print_help(void);

#endif
