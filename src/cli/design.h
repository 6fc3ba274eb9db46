/* SPDX-License-Identifier: Apache-2.0 */
/* Transfer functions that are found from the data: which values the colour map goes over and how, and how much each
 * value hides of what lies behind it. */
#ifndef TETCAST_CLI_DESIGN_H
#define TETCAST_CLI_DESIGN_H

#include <stdbool.h>

#include <tetcast/statistics.h>
#include <tetcast/transfer_function.h>

/* How values become places on a colour map, from 0 to 1. */
typedef struct DesignMap {
  double range[2];  /* the values at its two ends; those beyond have the ends' colours */
  bool logarithmic; /* places are even in the logarithm of values, which are above 0 */
  bool diverging;   /* the middle is a value that both sides are told from */
} DesignMap;

double design_place(const DesignMap *map, double value);
double design_value(const DesignMap *map, double place);

enum { DESIGN_KNOTS = 32 };

/* A transfer function but for its colours, and for the factor that extinctions still have to be multiplied by. */
typedef struct Design {
  DesignMap map;
  int count;
  double knots[DESIGN_KNOTS][2]; /* [count]: values, ascending, and extinctions of at most 1 */
  const char *reason;            /* in words, why the map is as it is */
} Design;

/* What is asked for; zeros and NULL: nothing in particular. */
typedef struct DesignDesc {
  const double *range; /* what the colour map goes over */
  const double *whole; /* the range of all values, where this field is a part of what is drawn */
  bool logarithmic;
  bool diverging;       /* the colour map that will be used is */
  const double *center; /* the value in the middle of a diverging map */
  /* Where the statistics of the values come from, in place of the mesh and the field, which may be NULL then; `whole`
   * is needed with it. */
  TetcastStatus (*statistics)(void *user, const TetcastStatisticsDesc *desc, TetcastStatistics **statistics);
  void *user;
} DesignDesc;

/* Finds what shows the most of a field: every range of colours about the same amount of it. */
TetcastStatus design_find(TetcastContext *context, const TetcastMesh *mesh, const TetcastField *field,
                          const DesignDesc *desc, Design *design);

/* Makes the transfer function but for that factor, of the colours that a colour map has over [0, 1]. */
TetcastStatus design_shape(TetcastContext *context, const Design *design, const TetcastTransferFunction *map,
                           TetcastTransferFunction **shape);

#endif
