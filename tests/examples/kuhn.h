/* SPDX-License-Identifier: Apache-2.0 */
/* The simulation's side of diffusion.c: it knows nothing of tetcast. */
#ifndef EXAMPLES_KUHN_H
#define EXAMPLES_KUHN_H

#include <stdint.h>

/* The unit cube as n³ small cubes of six tetrahedra each, and what linear finite elements need of it. */
typedef struct Kuhn {
  int64_t vertex_count, cell_count;
  double (*vertices)[3];
  int64_t (*cells)[4];
  double *mass;            /* [vertex_count]: the integral of a vertex's hat function (lumped mass matrix) */
  double (*stiffness)[10]; /* [cell_count]: ∫ ∇φi·∇φj for the pairs i ≤ j of a cell's four vertices, row by row */
  double *rate;            /* [vertex_count]: for kuhn_step() */
  double largest_step; /* explicit Euler with diffusivity 1 is stable, and keeps minimum and maximum, up to here */
} Kuhn;

/* Returns 0, or −1 when there is no memory. kuhn_free() in either case. */
int kuhn_make(Kuhn *kuhn, int n);
void kuhn_free(Kuhn *kuhn);

/* One explicit Euler step of ∂u/∂t = ∇²u with no flow through the cube's sides: u −= step · M⁻¹ K u. */
void kuhn_step(const Kuhn *kuhn, double step, double *u);

#endif
