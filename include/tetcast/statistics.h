/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_STATISTICS_H
#define TETCAST_STATISTICS_H

#include <stdint.h>

#include <tetcast/context.h>
#include <tetcast/field.h>
#include <tetcast/mesh.h>
#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TETCAST_MAX_BINS 65536

/* What is to be found out about a field. */
typedef struct TetcastStatisticsDesc {
  /* Set by tetcast_statistics_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* The values that are told apart: from range[0] to range[1], above it, both finite. Default: 0, 0, the field's own
   * range, with the values of vertices that no cell uses, or none but hidden ones. */
  double range[2];
  /* Into how many bins of equal width the range is divided, from 1 to TETCAST_MAX_BINS; default 256. */
  int bins;
  /* The magnitudes of the gradient that are told apart, as the range of values; default: 0, 0, from 0 to the largest.
   */
  double gradient_range[2];
  /* Into how many bins these are divided, bins · gradient_bins at most 2^20; 0, the default: no joint histogram. */
  int gradient_bins;
} TetcastStatisticsDesc;

/* Makes a desc with every setting at its default. */
TETCAST_API TetcastStatisticsDesc tetcast_statistics_desc_default(void);

/* How a field's values are distributed over the mesh. In a tetrahedron in which the field is linear, the share of the
 * volume below a value is a cubic B-spline's integral and the area of an isosurface a quadratic B-spline, with the
 * values at the vertices as knots (Bajaj, Pascucci, Schikore, The contour spectrum, 1997); the numbers are sums of
 * these, so that nothing is sampled, and what they are off by is rounding alone. Volumes are in the mesh's unit of
 * length to the third power, areas to the second. A field of cells is constant in each, and has no isosurfaces. */
typedef struct TetcastStatistics {
  /* The values that were told apart, the default filled in. */
  double range[2];
  /* Into how many bins. */
  int bins;
  /* The magnitudes of the gradient that were told apart, the default filled in. */
  double gradient_range[2];
  /* Into how many bins; 0: there is no joint histogram. */
  int gradient_bins;
  /* The volume of all cells whose values are finite. */
  double total;
  /* The volume of the others, which are not counted below. */
  double unknown;
  /* The volume with values below the range. */
  double below;
  /* The volume with values above the range. */
  double above;
  /* [bins]: the volume with values in each bin. */
  double *volume;
  /* [bins + 1]: the area of the isosurface at each bin's lower end and at the last one's upper end. */
  double *area;
  /* [bins + 1]: the integral of the gradient's magnitude over these isosurfaces. */
  double *gradient;
  /* [gradient_bins][bins]: the volume with values in each bin and gradients in each bin; gradients beyond count in the
   * outermost bins (Kindlmann & Durkin, Semi-automatic generation of transfer functions, 1998). NULL without. */
  double *joint;
} TetcastStatistics;

/* Finds the statistics of a field on its mesh; `desc` may be NULL. The field must have as many values as the mesh has
 * vertices, cells or corners (TETCAST_ERROR_ARGUMENT). The result does not depend on the number of threads. */
TETCAST_API TetcastStatus tetcast_statistics_create(TetcastContext *context, const TetcastMesh *mesh,
                                                    const TetcastField *field, const TetcastStatisticsDesc *desc,
                                                    TetcastStatistics **statistics);

/* Frees them and sets the pointer to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_statistics_destroy(TetcastContext *context, TetcastStatistics **statistics);

/* Finds the values below which these shares [count] of the volume lie, in [0, 1] and ascending, to the last bits:
 * values[i] for shares[i], where the largest magnitude is up to 1e90 times that of the others. Shares 0 and 1 are the
 * field's own range. Cells with values that are not finite don't count; if there are no others, all are NaN. At
 * most 64 at a time. */
TETCAST_API TetcastStatus tetcast_statistics_quantiles(TetcastContext *context, const TetcastMesh *mesh,
                                                       const TetcastField *field, const double *shares, int count,
                                                       double *values);

#ifdef __cplusplus
}
#endif

#endif
