/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_TRANSFER_FUNCTION_H
#define TETCAST_TRANSFER_FUNCTION_H

#include <stdint.h>

#include <tetcast/context.h>
#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Gives every value of the scalar a colour and an extinction. With extinction κ(s) ≥ 0 [1/length] and colour c(s) (not
 * premultiplied) along a ray, C = ∫ c κ exp(−∫κ) dt,   α = 1 − exp(−∫κ dt) (Max, Optical models for direct volume
 * rendering, IEEE TVCG 1995). Both are piecewise linear, each with its own knots, and constant beyond their first and
 * last. Two knots at one value make a step; at the value itself the later one holds. Immutable; may be used from
 * several threads at a time. */
typedef struct TetcastTransferFunction TetcastTransferFunction;

/* How opacity becomes extinction. `unit_distance` u > 0 has the mesh's unit of length. */
typedef enum TetcastOpacityModel {
  /* α is the opacity of a layer of thickness u: κ = −ln(1 − α) / u at the knots, as VTK's image mappers take it. An α
   * above 1 − 2^−53 counts as that, so that κ ≤ 36.74 / u. */
  TETCAST_OPACITY_UNIT_DISTANCE = 0,
  /* κ = α / u, as VTK's mappers of unstructured grids take it. */
  TETCAST_OPACITY_VTK_UNSTRUCTURED,
  /* κ = α · densityScale, as OSPRay takes it; u is 1 / densityScale. */
  TETCAST_OPACITY_OSPRAY
} TetcastOpacityModel;

/* What a transfer function is made from: colours, and either extinctions or opacities. All arrays are copied. Values
 * are in the scalar's unit and sorted; no more than two of them are equal. */
typedef struct TetcastTransferFunctionDesc {
  /* Set by tetcast_transfer_function_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* [color_count][4]: the knots of the colour, each a value and red, green and blue ≥ 0. */
  const double *color;
  /* The number of the colour's knots, ≥ 1. */
  int64_t color_count;
  /* [extinction_count][2]: the knots of the extinction, each a value and an extinction ≥ 0, in 1/length. NULL (the
   * default) if opacity is given. */
  const double *extinction;
  /* The number of the extinction's knots, ≥ 1 if extinction is given. */
  int64_t extinction_count;
  /* [opacity_count][2]: the knots of the opacity, each a value and an opacity in [0, 1]. NULL (the default) if
   * extinction is given. */
  const double *opacity;
  /* The number of the opacity's knots, ≥ 1 if opacity is given. */
  int64_t opacity_count;
  /* The distance that opacities are given for (TetcastOpacityModel), in the mesh's unit of length, > 0. Default: 1. */
  double unit_distance;
  /* How opacity becomes extinction. Default: TETCAST_OPACITY_UNIT_DISTANCE. */
  TetcastOpacityModel opacity_model;
} TetcastTransferFunctionDesc;

/* Makes a desc without knots, with every setting at its default. */
TETCAST_API TetcastTransferFunctionDesc tetcast_transfer_function_desc_default(void);

/* Makes a transfer function. Unsorted, negative or non-finite entries are TETCAST_ERROR_ARGUMENT; the message names the
 * knot. Any finite entry is accepted. When it is drawn, an extinction above 2^999 (5e300) / the mesh's largest
 * coordinate counts as that, which nothing can be seen through, and a colour above 2^500 (3e150) counts as that. */
TETCAST_API TetcastStatus tetcast_transfer_function_create(TetcastContext *context,
                                                           const TetcastTransferFunctionDesc *desc,
                                                           TetcastTransferFunction **transfer_function);

/* Name of preset i = 0, 1, …: of a colour map. NULL beyond the last. Static storage. Wherever a preset is named, the
 * name with "_r" behind it is the reverse: the same colours from the last to the first. */
TETCAST_API const char *tetcast_preset_name(int i);

/* What colours of a preset are for. */
typedef enum TetcastPresetKind {
  /* There is no preset of that name. */
  TETCAST_PRESET_NONE = 0,
  /* From little to much. */
  TETCAST_PRESET_SEQUENTIAL,
  /* From the middle to both sides: the middle of the range has a meaning, such as 0. */
  TETCAST_PRESET_DIVERGING,
  /* Things of different kinds: constant colours, in steps of equal width. */
  TETCAST_PRESET_CATEGORICAL
} TetcastPresetKind;

/* The kind of the preset of this name, or of its reverse. NULL is TETCAST_PRESET_NONE. */
TETCAST_API TetcastPresetKind tetcast_preset_kind(const char *name);

/* Makes a transfer function from a colour map: the colours of preset `name` over [low, high], with an extinction that
 * rises linearly from 0 at `low` to `extinction` ≥ 0 [1/length] at `high`. Where low is high: the colour of the map's
 * middle and this extinction. An unknown name, low > high, or a number that isn't finite is TETCAST_ERROR_ARGUMENT. The
 * caller destroys the result. */
TETCAST_API TetcastStatus tetcast_transfer_function_create_preset(TetcastContext *context, const char *name, double low,
                                                                  double high, double extinction,
                                                                  TetcastTransferFunction **transfer_function);

/* Makes a transfer function from a shape over [0, 1] of any colours and extinctions: 0 comes to lie at `low`, 1 at
 * `high`, and the largest extinction becomes `extinction` ≥ 0 [1/length], unless all are 0. Where low is high: the
 * colour of 0.5 and this extinction. low > high, or a number that isn't finite, is TETCAST_ERROR_ARGUMENT. The caller
 * destroys the result. */
TETCAST_API TetcastStatus tetcast_transfer_function_stretch(TetcastContext *context,
                                                            const TetcastTransferFunction *shape, double low,
                                                            double high, double extinction,
                                                            TetcastTransferFunction **transfer_function);

/* Finds the factor by which extinctions have to be multiplied so that rays which have these optical depths [count ≥ 1],
 * finite and > 0, become opaque to `opacity` on average, in (0, 1). If `clear` is 0, as far as a mean depth between
 * 0.25 and 6 allows it, as tetcast_scene_fit_transfer_function() has it; else as far as at most one in twenty is opaque
 * to more than 0.99, as tetcast_scene_scale_transfer_function() has it. For those whose rays are cast elsewhere. */
TETCAST_API TetcastStatus tetcast_opacity_factor(TetcastContext *context, const double *depths, int64_t count,
                                                 double opacity, int clear, double *factor);

/* Frees it and sets the pointer to NULL. NULL and pointer to NULL do nothing. Scenes have copies of what they need. */
TETCAST_API void tetcast_transfer_function_destroy(TetcastTransferFunction **transfer_function);

/* [*count][4]: the colour's knots, each a value and red, green and blue. Valid while the transfer function lives. */
TETCAST_API const double *tetcast_transfer_function_color(const TetcastTransferFunction *transfer_function,
                                                          int64_t *count);

/* [*count][2]: the extinction's knots, each a value and an extinction, also if opacities were given. Valid while the
 * transfer function lives. */
TETCAST_API const double *tetcast_transfer_function_extinction(const TetcastTransferFunction *transfer_function,
                                                               int64_t *count);

#ifdef __cplusplus
}
#endif

#endif
