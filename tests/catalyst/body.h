/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes for the tests, which a simulation hands over and a file holds. */
#ifndef BODY_H
#define BODY_H

#include <stdbool.h>
#include <stdint.h>

#include "standin.h"

typedef enum BodyKind { BODY_TET, BODY_HEX, BODY_WEDGE, BODY_PYRAMID, BODY_MIXED, BODY_POLYHEDRA } BodyKind;

typedef struct Body {
  BodyKind kind;
  int n[3]; /* cubes along each axis */
  int64_t points, cells, faces;
  double *x;                           /* [points][3] */
  uint8_t *types;                      /* [cells], VTK's */
  int64_t *offsets;                    /* [cells + 1] */
  int64_t *nodes;                      /* of a polyhedron: each of its corners once, in the order of its faces */
  int64_t *cell_faces;                 /* [cells][6] of polyhedra, else unused */
  int64_t *face_nodes;                 /* [faces][4] */
  double *t;                           /* [points]: field T */
  double *v;                           /* [points][3]: field V */
  double *c;                           /* [cells]: field C */
  int32_t *m;                          /* [cells]: field M, numbers of materials */
  uint8_t *ghost_cells, *ghost_points; /* VTK's bits; NULL: no ghosts */
  bool single;                         /* coordinates are floats */
} Body;

/* Cubes from `origin` on with cells of this kind; `phase` changes the fields. */
Body *body_create(BodyKind kind, const int n[3], const double origin[3], double phase);
void body_destroy(Body *body);

/* Writes it as .vtu. */
void body_write(const Body *body, const char *path);

/* How a simulation has it. */
typedef enum BodyLayout { LAYOUT_APART, LAYOUT_INTERLEAVED, LAYOUT_PADDED } BodyLayout;
typedef struct BodyView {
  BodyLayout layout;
  StandinType index; /* of the connectivity; 0: int32 */
  bool spread;       /* whether numbers of the connectivity lie 16 bytes apart */
  bool no_offsets;   /* blueprint's offsets are left to the sizes */
} BodyView;

/* Describes the body under `mesh`, whose arrays are the body's own or live until body_forget(). */
void body_describe(const Body *body, const BodyView *view, conduit_node *mesh);
/* The same as a grid: "uniform" (n[] unit cubes), "rectilinear" or "structured". */
void body_describe_grid(const Body *body, const char *type, conduit_node *mesh);
void body_describe_fields(const Body *body, conduit_node *mesh);
void body_forget(void);

/* Memory until body_forget(). */
void *body_keep(int64_t count, int64_t size);

#endif
