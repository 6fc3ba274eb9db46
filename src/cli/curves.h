/* SPDX-License-Identifier: Apache-2.0 */
/* Transfer functions that are curves: gaussians, splines, and control points over the logarithm of the value. What is
 * rendered is piecewise linear, so they become linear pieces, none of which is further from the curve than 1e-4 of its
 * height: of the largest extinction, or the largest component of a colour, that the file states. */
#ifndef TETCAST_CLI_CURVES_H
#define TETCAST_CLI_CURVES_H

#include <stdbool.h>

#include <jansson.h>

#include <tetcast/transfer_function.h>

/* Whether the object of a transfer function has gaussians in place of control points. */
bool curves_gaussian(const json_t *root);

/* The sum of an object's "gaussians". `desc` states how opacities become extinctions. NULL after a message. */
TetcastTransferFunction *curves_of_gaussians(TetcastContext *context, const char *place, const json_t *root,
                                             const TetcastTransferFunctionDesc *desc);

/* Puts in place of *control, whose knots are control points, the curve through them that the object's "spline" or "log"
 * asks for; without these nothing is done. False after a message. */
bool curves_through(TetcastContext *context, const char *place, const json_t *root, TetcastTransferFunction **control);

#endif
