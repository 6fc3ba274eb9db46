/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_SCENE_H
#define TETCAST_SCENE_H

#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/blend.h>
#include <tetcast/camera.h>
#include <tetcast/clip.h>
#include <tetcast/context.h>
#include <tetcast/field.h>
#include <tetcast/frame.h>
#include <tetcast/integrator.h>
#include <tetcast/transfer_function.h>
#include <tetcast/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A volume seen through a transfer function, or by coefficients of its own. Several scenes may share a volume, and
 * render at the same time. */
typedef struct TetcastScene TetcastScene;

/* Makes a scene; the volume is referred to and must outlive it. */
TETCAST_API TetcastStatus tetcast_scene_create(TetcastContext *context, const TetcastVolume *volume,
                                               TetcastScene **scene);

/* Frees the scene and sets *scene to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_scene_destroy(TetcastScene **scene);

/* Sets or replaces the scalar that is seen. It must have as many values as the volume's mesh had vertices or cells
 * (TETCAST_ERROR_ARGUMENT). Its values are copied into the volume's order; nothing else is rebuilt, and scenes of one
 * volume that are given the same field share the copy, unless it borrows its array. Must not run while this scene
 * renders. On error the scene keeps its former field. */
TETCAST_API TetcastStatus tetcast_scene_set_field(TetcastScene *scene, const TetcastField *field);

/* As that, the field that another scene of the same volume has: both then use one copy of its values, and the field
 * itself isn't needed. A scene of another volume, or one without a field, is TETCAST_ERROR_ARGUMENT. */
TETCAST_API TetcastStatus tetcast_scene_share_field(TetcastScene *scene, const TetcastScene *other);

/* A transfer function from a colour map: colours of preset `name` (tetcast_preset_name()) over [low, high] with an
 * extinction that rises from 0 at `low` to what makes rays that meet anything opaque to one half on average, whatever
 * the unit of length and however values are distributed; only where that is above the largest double, in a mesh smaller
 * than some 1e-308, it is that. The scene must have a field (TETCAST_ERROR_ARGUMENT); an unknown name is
 * TETCAST_ERROR_ARGUMENT. The caller destroys the result. */
TETCAST_API TetcastStatus tetcast_scene_create_preset(const TetcastScene *scene, const char *name, double low,
                                                      double high, TetcastTransferFunction **transfer_function);

/* Sets or replaces the transfer function; what is needed of it is copied. Must not run while this scene renders. On
 * error the scene keeps its former one, or its coefficients. */
TETCAST_API TetcastStatus tetcast_scene_set_transfer_function(TetcastScene *scene,
                                                              const TetcastTransferFunction *transfer_function);

/* Sets what is made of the scalar along rays; a new scene has TETCAST_BLEND_COMPOSITE. With another blend mode the
 * scene needs a field and a transfer function, of which only the colours are used: nothing is hidden by its extinction.
 * A pixel has the colour of its value, premultiplied by its alpha, which is 1 where the ray meets anything (with
 * several samples, the share of them that do), else 0; its value is the mean of those. An unknown blend mode is
 * TETCAST_ERROR_ARGUMENT. Must not run while this scene renders. */
TETCAST_API TetcastStatus tetcast_scene_set_blend(TetcastScene *scene, TetcastBlend blend);

/* The scene's blend mode. */
TETCAST_API TetcastBlend tetcast_scene_blend(const TetcastScene *scene);

/* Clips what is seen, of whatever kind and in every channel, to what lies in all of `half_spaces` [count], in place of
 * former ones; they are copied. 0 and NULL: all is seen, as in a new scene. Cells are not cut but rays are: each counts
 * from where it enters the last half-space to where it leaves the first, so pictures are as exact as without, and
 * nothing else takes longer; what rounding does to these two places is part of TETCAST_CHANNEL_ERROR. A ray in the
 * plane itself is kept. Where nothing is left, pictures are empty. The default camera and presets go by the whole mesh.
 * A normal of length 0, or a number that isn't finite, is TETCAST_ERROR_ARGUMENT. Must not run while this scene
 * renders. On error the scene keeps what it had. */
TETCAST_API TetcastStatus tetcast_scene_set_clip(TetcastScene *scene, const TetcastHalfSpace *half_spaces, int count);

/* Extinction κ and emission j as they are, for one or several groups (of wavelength, of energy, …). Along a ray, each
 * group has
 *
 *     radiance ∫ j(t) exp(−∫₀ᵗ κ) dt,   optical depth τ = ∫ κ dt,   transmittance e^−τ,
 *
 * κ in 1/length, in the mesh's unit, j in radiance per length. Of points they are linear in each tetrahedron, of cells
 * constant. Without extinction nothing is absorbed; without emission, as in radiography, there is no radiance. What
 * isn't given isn't computed. */
typedef struct TetcastCoefficientsDesc {
  uint32_t cookie;
  const TetcastField *const
      *extinction; /* [extinction_count], one scalar each: ≥ 0; above 2^999 / largest coordinate: as that */
  const TetcastField *const *emission; /* [emission_count]; may be negative: what comes out is linear in it */
  int extinction_count,
      emission_count; /* 0: none; 1: the same for all groups; else the number of groups, to TETCAST_MAX_GROUPS */
  const char *extinction_name, *emission_name; /* for messages; NULL: "extinction", "emission" */
} TetcastCoefficientsDesc;

TETCAST_API TetcastCoefficientsDesc tetcast_coefficients_desc_default(void);

/* Sets the coefficients, in place of former ones or of a transfer function; they are copied, and the volume's own field
 * is not used. Values of magnitude above 2^1022 count as that. To a group, cells that touch a NaN or an infinite value
 * of it are transparent and dark. A negative extinction is TETCAST_ERROR_DATA, and the message says where; a field that
 * isn't of the volume's mesh is TETCAST_ERROR_ARGUMENT. Must not run while this scene renders. On error the scene keeps
 * what it had. */
TETCAST_API TetcastStatus tetcast_scene_set_coefficients(TetcastScene *scene, const TetcastCoefficientsDesc *desc);

/* Number of groups of the coefficients, 0 without. */
TETCAST_API int tetcast_scene_groups(const TetcastScene *scene);

typedef struct TetcastRenderDesc {
  uint32_t cookie;
  TetcastIntegrator integrator; /* default: exact */
  int integrator_n;             /* see there; at most 2^20; default 1; not used by exact */
  int samples;    /* rays per pixel in [1, 2^16], a regular grid as near to square as the number allows; default 1: the
                     centre */
  TetcastIsa isa; /* at most this one is used; default: auto. All give the same picture up to rounding */
  double tolerance; /* ≥ 0, finite; default 0: exact. Else, a picture sooner: none of a pixel's four channels is further
                     * than this from the exact picture's. Absolute, in the units of the channel (alpha: 1 is opaque).
                     * Only with the exact integrator. Rays are walked in single precision where a bound on what that
                     * costs allows it: with a point field and a transfer function without jumps, AVX2 or AVX-512, from
                     * 1e-3 or 1e-4 on, depending on how steep both are. The bound takes it that cells don't overlap:
                     * where a mesh folds over itself, single precision may be further off. */
  TetcastProgress progress;
  const TetcastArray *stop; /* [height · width], float or double, rows from the top: the distance from its start at
                             * which every ray of the pixel ends, in the mesh's unit of length: from the eye, or, of an
                             * orthographic camera, from the plane through it, along the ray, not along the direction of
                             * view. So a picture is made that goes in front of opaque things of other origin. Infinity:
                             * it doesn't end; 0 or less: it sees nothing; NaN is TETCAST_ERROR_ARGUMENT. NULL
                             * (default): none ends */
} TetcastRenderDesc;

TETCAST_API TetcastRenderDesc tetcast_render_desc_default(void);

typedef struct TetcastRenderStats {
  int64_t rays;     /* cast: width × height × samples */
  int64_t segments; /* cells crossed over a length > 0, summed over the rays */
  double error; /* largest of the pixels' bounds as in TETCAST_CHANNEL_ERROR; NaN with another integrator than the exact
                 * one, with a blend mode other than composite, and where neither that channel nor a tolerance is asked
                 * for */
  int64_t lost; /* rays whose walk ended before the boundary: 0, or a defect of tetcast */
  const char *isa;       /* instruction set of the kernel that ran; static storage */
  const char *precision; /* of the arithmetic: "double", or "single" (of the walk, rays where it may not do apart);
                            static storage */
} TetcastRenderStats;

/* Renders into every pixel of `frame`, all its channels. `desc` and `stats` may be NULL. The scene must have
 * coefficients, or a transfer function and a field (TETCAST_ERROR_ARGUMENT).
 *
 * With coefficients, the pixel's colour is the radiance: of three groups as red, green, blue; of one group grey; of
 * another number grey, their mean. Its alpha is 1 − transmittance, the mean of the groups'. Only the exact integrator
 * works with them, to rounding whatever the tolerance. Channels of groups need a frame with the scene's number of
 * groups.
 *
 * With another blend mode than composite, values are exact up to rounding in double precision, whatever the tolerance;
 * other integrators, coefficients and the error channel are TETCAST_ERROR_ARGUMENT then.
 *
 * With one instruction set the result has the same bits for any
 * number of threads. After an error or a cancelled call the frame's pixels are unspecified and the scene is as before.
 * Calls with different frames may run at the same time, also on one scene. */
TETCAST_API TetcastStatus tetcast_scene_render(const TetcastScene *scene, const TetcastCamera *camera,
                                               const TetcastRenderDesc *desc, TetcastFrame *frame,
                                               TetcastRenderStats *stats);

#ifdef __cplusplus
}
#endif

#endif
