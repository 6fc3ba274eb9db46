/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_TRANSFER_FUNCTION_H
#define TETCAST_TRANSFER_FUNCTION_H

#include <stdint.h>

#include <tetcast/context.h>
#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Scalar → colour and extinction. With extinction κ(s) ≥ 0 [1/length] and colour c(s) (not premultiplied) along a ray,
 *     C = ∫ c κ exp(−∫κ) dt,   α = 1 − exp(−∫κ dt)
 * (Max, Optical models for direct volume rendering, IEEE TVCG 1995). Both are piecewise linear, each with its own
 * knots, and constant beyond their first and last. Two knots at one value make a step; at the value itself the later
 * one holds. Immutable; may be used from several threads at a time. */
typedef struct TetcastTransferFunction TetcastTransferFunction;

/* How opacity becomes extinction. `unit_distance` u > 0 has the mesh's unit of length. */
typedef enum TetcastOpacityModel {
  TETCAST_OPACITY_UNIT_DISTANCE = 0, /* α is what one u of the material has: κ = −ln(1 − α) / u at the knots. VTK's
                                      * image mappers. α above 1 − 2^−53 counts as that, so κ ≤ 36.74 / u */
  TETCAST_OPACITY_VTK_UNSTRUCTURED, /* κ = α / u: VTK's unstructured grid mappers */
  TETCAST_OPACITY_OSPRAY            /* κ = α · densityScale: OSPRay, with unit_distance = 1 / densityScale */
} TetcastOpacityModel;

typedef struct TetcastTransferFunctionDesc {
  uint32_t cookie;
  const double
      *color; /* [color_count][4]: value, red, green, blue; values sorted, no more than two equal, colours ≥ 0 */
  int64_t color_count; /* ≥ 1 */
  const double
      *extinction; /* [extinction_count][2]: value, extinction ≥ 0; sorted likewise; NULL if opacity is given */
  int64_t extinction_count; /* ≥ 1 with extinction */
  const double *opacity;    /* [opacity_count][2]: value, opacity in [0, 1]; NULL if extinction is given */
  int64_t opacity_count;    /* ≥ 1 with opacity */
  double unit_distance;     /* > 0, default 1 */
  TetcastOpacityModel opacity_model;
} TetcastTransferFunctionDesc;

TETCAST_API TetcastTransferFunctionDesc tetcast_transfer_function_desc_default(void);

/* All arrays are copied. Unsorted, negative or non-finite entries are TETCAST_ERROR_ARGUMENT; the message names the
 * knot. Any finite entry will do: where it is drawn, an extinction above 2^999 (5e300) / the mesh's largest coordinate
 * counts as that, which nothing can be seen through, and a colour above 2^500 (3e150) as that. */
TETCAST_API TetcastStatus tetcast_transfer_function_create(TetcastContext *context,
                                                           const TetcastTransferFunctionDesc *desc,
                                                           TetcastTransferFunction **transfer_function);

/* Name of preset i = 0, 1, …; NULL beyond the last. Static storage. */
TETCAST_API const char *tetcast_preset_name(int i);

/* Frees it and sets the pointer to NULL. NULL and pointer to NULL do nothing. Scenes that use it keep what they need.
 */
TETCAST_API void tetcast_transfer_function_destroy(TetcastTransferFunction **transfer_function);

/* The knots, opacity already turned into extinction: [*count][4] (value, r, g, b) and [*count][2] (value, extinction);
 * valid while the transfer function lives. */
TETCAST_API const double *tetcast_transfer_function_color(const TetcastTransferFunction *transfer_function,
                                                          int64_t *count);
TETCAST_API const double *tetcast_transfer_function_extinction(const TetcastTransferFunction *transfer_function,
                                                               int64_t *count);

#ifdef __cplusplus
}
#endif

#endif
