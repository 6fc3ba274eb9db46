/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_INTEGRATOR_H
#define TETCAST_INTEGRATOR_H

/* How light is computed: by which formula, and with which instructions. */

/* How the light of a ray's segment in a cell is computed. All but the exact one are what other programs do, and are
 * there to be compared with. They take n samples per segment and don't split segments at the knots of the transfer
 * function, except for the table. Fields of cells are constant on a segment, so they are exact with all of them. */
typedef enum TetcastIntegrator {
  TETCAST_INTEGRATOR_EXACT = 0, /* the closed form, to rounding */
  TETCAST_INTEGRATOR_MIDPOINT,  /* n ≥ 1 equal steps, each constant as in its middle; error O(1/n²) */
  TETCAST_INTEGRATOR_TRAPEZOID, /* n ≥ 1 equal steps, each with the mean of its ends; O(1/n²) */
  TETCAST_INTEGRATOR_GAUSS, /* Gauss–Legendre, n nodes in [1, TETCAST_MAX_GAUSS]; order 2n in the segment's length */
  TETCAST_INTEGRATOR_TABLE  /* Ψ interpolated in an n × n table, n in [2, 4096]: K. Moreland, E. Angel 2004 */
} TetcastIntegrator;

/* The most nodes of TETCAST_INTEGRATOR_GAUSS. */
#define TETCAST_MAX_GAUSS 16

/* Instruction sets that there are kernels for, from the slowest to the fastest. */
typedef enum TetcastIsa {
  TETCAST_ISA_AUTO = 0, /* the fastest that the processor has */
  TETCAST_ISA_SCALAR,   /* for any processor, one ray in each lane */
  TETCAST_ISA_AVX2,     /* with FMA */
  TETCAST_ISA_AVX512    /* F, VL, DQ */
} TetcastIsa;

#endif
