/* SPDX-License-Identifier: Apache-2.0 */
/* Fields that solve Laplace's or Poisson's equation on a mesh: linear finite elements, conjugate gradients. */
#ifndef TETCAST_CLI_LAPLACE_H
#define TETCAST_CLI_LAPLACE_H

#include <tetcast/context.h>
#include <tetcast/mesh.h>

typedef enum LaplaceProblem {
  LAPLACE_HEAT, /* ∇²u = 0, u = 1 on cavities, 0 on outer surfaces */
  LAPLACE_GLOW, /* ∇²u = −1, u = 0 on all surfaces; scaled to a maximum of 1 */
  LAPLACE_FLOW  /* |∇φ|, ∇²φ = 0, φ = x on the faces at the lowest and highest x, no flux through any other */
} LaplaceProblem;

/* values[i] at vertex i; array of the mesh's number of vertices. */
TetcastStatus laplace_solve(TetcastContext *context, const TetcastMesh *mesh, LaplaceProblem problem, double *values);

#endif
