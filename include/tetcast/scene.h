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
#include <tetcast/isosurface.h>
#include <tetcast/shading.h>
#include <tetcast/slice.h>
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

/* Sets or replaces the scalar by the field that another scene of the same volume has. Both scenes then use one copy of
 * its values, and the field itself isn't needed. A scene of another volume, or one without a field, is
 * TETCAST_ERROR_ARGUMENT. */
TETCAST_API TetcastStatus tetcast_scene_share_field(TetcastScene *scene, const TetcastScene *other);

/* Makes a transfer function from a colour map: the colours of preset `name` (tetcast_preset_name()) over [low, high],
 * with an extinction that rises linearly from 0 at `low`. At `high` it has the value that makes rays which meet the
 * volume opaque to one half on average, whatever the unit of length and however values are distributed. That value is
 * capped at the largest double, which only meshes smaller than some 1e-308 reach. The scene must have a field
 * (TETCAST_ERROR_ARGUMENT); an unknown name is TETCAST_ERROR_ARGUMENT. The caller destroys the result. */
TETCAST_API TetcastStatus tetcast_scene_create_preset(const TetcastScene *scene, const char *name, double low,
                                                      double high, TetcastTransferFunction **transfer_function);

/* Makes a transfer function that has the colours of `shape`, and its extinctions multiplied by the one factor that
 * makes the pixels in which this camera sees matter opaque to `opacity` on average, in (0, 1), as far as at most one in
 * twenty is opaque to more than 0.99. Looked at is a picture of 48 × 36 rays. If all extinctions are 0 they stay that;
 * if no ray meets any, the largest is made 1 over the radius of the volume's bounding sphere. The scene must have a
 * field (TETCAST_ERROR_ARGUMENT). The caller destroys the result. */
TETCAST_API TetcastStatus tetcast_scene_scale_transfer_function(const TetcastScene *scene,
                                                                const TetcastTransferFunction *shape,
                                                                const TetcastCamera *camera, double opacity,
                                                                TetcastTransferFunction **transfer_function);

/* Makes a transfer function from a shape over [0, 1] of any colours and extinctions: 0 comes to lie at `low`, 1 at
 * `high`, and all extinctions are times the factor by which rays that meet the volume are opaque to one half on
 * average, as far as a mean optical depth between 0.25 and 6 allows it. So it is what tetcast_scene_create_preset()
 * makes if the shape is a preset over [0, 1]. Where low is high: the colour of 0.5 and the largest extinction. The
 * scene must have a field; low > high, or a number that isn't finite, is TETCAST_ERROR_ARGUMENT. The caller destroys
 * the result. */
TETCAST_API TetcastStatus tetcast_scene_fit_transfer_function(const TetcastScene *scene,
                                                              const TetcastTransferFunction *shape, double low,
                                                              double high, TetcastTransferFunction **transfer_function);

/* Sets or replaces the transfer function, of which the scene takes a copy. Must not run while this scene renders. On
 * error the scene keeps its former transfer function, or its coefficients. */
TETCAST_API TetcastStatus tetcast_scene_set_transfer_function(TetcastScene *scene,
                                                              const TetcastTransferFunction *transfer_function);

/* A row of a transfer function of two dimensions. */
typedef struct TetcastTransferRow {
  /* Where the row is, in the second quantity's unit; finite. */
  double at;
  /* What the transfer function is there. */
  const TetcastTransferFunction *transfer_function;
} TetcastTransferRow;

#define TETCAST_MAX_ROWS 64

/* Sets a transfer function of two dimensions, in place of a former transfer function or coefficients: `count` rows,
 * from 1 to TETCAST_MAX_ROWS, at ascending values of a second quantity that is constant in a cell. Between two rows,
 * extinction and colour are linear in it; before the first row and beyond the last they are as there. So in each cell
 * it is a transfer function of the scalar, linear between the knots of all rows, and pictures are as exact as with one.
 * (Levoy's opacity, Display of surfaces from volume data, 1988, and boxes and triangles in the plane of value and
 * gradient can be told so.)
 *
 * The second quantity is `second`, a field of cells, where NaN is transparent; if it is NULL, the magnitude of the
 * scalar's gradient in the cell, in the scalar's unit per unit of length. The scene takes copies of the rows and of
 * `second`. It needs a field of points, and is seen by the exact integrator in the blend mode composite, without a
 * channel of error bounds: other things are TETCAST_ERROR_ARGUMENT when rendering. Must not run while this scene
 * renders. On error the scene keeps what it had. */
TETCAST_API TetcastStatus tetcast_scene_set_transfer_rows(TetcastScene *scene, const TetcastTransferRow *rows,
                                                          int count, const TetcastField *second);

/* Sets how the scalar's values along a ray become one pixel; a new scene has TETCAST_BLEND_COMPOSITE. With another
 * blend mode the scene needs a field and a transfer function, of which only the colours are used: nothing is hidden by
 * its extinction. A pixel's value is the mean over those of its samples that meet the volume; its alpha is the share of
 * samples that do; its colour is that of its value, premultiplied by its alpha. An unknown blend mode is
 * TETCAST_ERROR_ARGUMENT. Must not run while this scene renders. */
TETCAST_API TetcastStatus tetcast_scene_set_blend(TetcastScene *scene, TetcastBlend blend);

/* The scene's blend mode. */
TETCAST_API TetcastBlend tetcast_scene_blend(const TetcastScene *scene);

/* Sets the scene's isosurfaces in place of those it had; `isosurfaces` is copied, and may be NULL when `count` is 0. At
 * most TETCAST_MAX_ISOSURFACES, no two of one value (TETCAST_ERROR_ARGUMENT). A scene that has isosurfaces needs a
 * field of points or corners (checked when it renders) but no transfer function; without one, surfaces are all there is
 * to see. Isosurfaces are seen by the exact integrator in the blend mode composite; other ones are
 * TETCAST_ERROR_ARGUMENT when rendering, and so is the channel of error bounds: where a surface is seen edge-on,
 * rounding decides whether a ray meets it. Must not run while this scene renders. On error the scene keeps those it
 * had. */
TETCAST_API TetcastStatus tetcast_scene_set_isosurfaces(TetcastScene *scene, const TetcastIsosurface *isosurfaces,
                                                        int count);

/* Sets the scene's slices in place of those it had; `slices` is copied, and may be NULL when `count` is 0. At most
 * TETCAST_MAX_SLICES. With slices, or a boundary that is seen, what the scene needs and what is refused is as with
 * isosurfaces, but the field may be one of cells, and the scene needs a transfer function, whose extinction may be 0.
 * Where a ray meets a slice follows from the plane alone, as with clips: a slice in the plane of a clip closes it. Must
 * not run while this scene renders. */
TETCAST_API TetcastStatus tetcast_scene_set_slices(TetcastScene *scene, const TetcastSlice *slices, int count);

/* Sets how the mesh's boundary is seen; NULL: not at all, as in a new scene. With TETCAST_TRAVERSAL_FACES, which knows
 * no boundary, it is TETCAST_ERROR_ARGUMENT. Must not run while this scene renders. */
TETCAST_API TetcastStatus tetcast_scene_set_boundary(TetcastScene *scene, const TetcastBoundary *boundary);

/* Sets the light; `desc` may be NULL: as a new scene has it, the default. Must not run while this scene renders. On
 * error the scene keeps what it had. */
TETCAST_API TetcastStatus tetcast_scene_set_shading(TetcastScene *scene, const TetcastShadingDesc *desc);

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
 * constant. Without extinction nothing is absorbed; without emission, as in radiography, there is no radiance. Neither
 * costs time where it isn't given. */
typedef struct TetcastCoefficientsDesc {
  /* Set by tetcast_coefficients_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* [extinction_count] fields of one scalar each: κ of each group, ≥ 0, in 1/length. Values above
   * 2^999 / largest coordinate count as that. NULL (the default) where extinction_count is 0. */
  const TetcastField *const *extinction;
  /* [emission_count] fields of one scalar each: j of each group, in radiance per length. Values may be negative, as
   * the result is linear in them. NULL (the default) where emission_count is 0. */
  const TetcastField *const *emission;
  /* The number of extinction fields. 0 (the default): nothing is absorbed; 1: all groups have the same extinction; else
   * the number of groups, at most TETCAST_MAX_GROUPS. */
  int extinction_count;
  /* The number of emission fields. 0 (the default): nothing is emitted; 1: all groups have the same emission; else the
   * number of groups, at most TETCAST_MAX_GROUPS. */
  int emission_count;
  /* What messages call the extinction. NULL (the default): "extinction". */
  const char *extinction_name;
  /* What messages call the emission. NULL (the default): "emission". */
  const char *emission_name;
} TetcastCoefficientsDesc;

/* Makes a desc without coefficients: set at least one of the two. */

TETCAST_API TetcastCoefficientsDesc tetcast_coefficients_desc_default(void);

/* Sets the coefficients, in place of former ones or of a transfer function. They are copied; the scene's field is not
 * used. Values of magnitude above 2^1022 count as that. To a group, cells that touch a NaN or an infinite value
 * of it are transparent and dark. A negative extinction is TETCAST_ERROR_DATA, and the message says where; a field that
 * isn't of the volume's mesh is TETCAST_ERROR_ARGUMENT. Must not run while this scene renders. On error the scene keeps
 * what it had. */
TETCAST_API TetcastStatus tetcast_scene_set_coefficients(TetcastScene *scene, const TetcastCoefficientsDesc *desc);

/* Number of groups of the coefficients, 0 without. */
TETCAST_API int tetcast_scene_groups(const TetcastScene *scene);

/* A number ≥ 0 that scenes of parts of a mesh have in common if they show the same of it: transfer functions of one or
 * two dimensions, isosurfaces and their light, slices. Scenes that show something else have another one, but for a
 * chance of 2^-62; what follows from the parts themselves, fields, coefficients, and clips, is not in it. */
TETCAST_API int64_t tetcast_scene_look(const TetcastScene *scene);

/* How a picture is computed. */
typedef struct TetcastRenderDesc {
  /* Set by tetcast_render_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* How emission and absorption are integrated along a ray (integrator.h). Default: TETCAST_INTEGRATOR_EXACT. */
  TetcastIntegrator integrator;
  /* The integrator's number n (integrator.h), in [1, 2^20]. Default: 1. The exact integrator doesn't use it. */
  int integrator_n;
  /* Rays per pixel, in [1, 2^16]: a regular grid as near to square as the number allows. Default: 1, through the
   * pixel's centre. */
  int samples;
  /* The largest instruction set that may be used. All give the same picture up to rounding. Default: TETCAST_ISA_AUTO,
   * the largest that the processor has. */
  TetcastIsa isa;
  /* How far each of a pixel's four channels may be from the exact picture's, finite and ≥ 0, in the units of the
   * channel (alpha: 1 is opaque). A larger tolerance makes pictures faster. Default: 0, exact. Only with the exact
   * integrator. TETCAST_CHANNEL_ERROR, which is measured only where it is asked for, is above it only where it is for
   * the exact picture as well: where a ray lies in faces to all digits. Rays are walked in single precision where a
   * bound on its error allows it: with a point field without NaN, a transfer function without jumps, a mesh that
   * doesn't fold over itself (no cell is turned inside out against its neighbour), and AVX2 or AVX-512; from 1e-3 or
   * 1e-4 on, depending on how steep field and transfer function are.
   */
  double tolerance;
  /* [height · width], float or double, rows from the top, NULL (default) for none: the distance at which every ray of
   * the pixel ends, in the mesh's unit of length: from the eye, or, of an orthographic camera, from the plane through
   * it, along the ray, not along the direction of view. So a picture is made that goes in front of opaque things of
   * other origin. Infinity: the ray doesn't end; 0 or less: it sees nothing; NaN is TETCAST_ERROR_ARGUMENT. */
  const TetcastArray *stop;
  /* As `stop`: the distance from which on a ray sees anything; 0 or less: all of it. NULL (default): all rays see all.
   * So pictures are made of parts of rays, which composited front to back give the whole. What is met exactly where one
   * part ends and the next begins is in one of them, but for the boundary's faces, which may be in both. */
  const TetcastArray *start;
  /* Above 0: the frame has some rows of a picture with so many, each of which is what it is in the whole picture, up to
   * rounding; and to the bit, if the frame begins at a multiple of 16 rows and ends at one, or at the picture's end. A
   * picture that doesn't fit into memory is made so. At least first_row + the frame's height, at most 2^20. Default: 0,
   * the frame is the picture. Not with `stop`, `start` or adaptive_coarse (TETCAST_ERROR_ARGUMENT). */
  int64_t picture_height;
  /* With picture_height, the row of the picture that is the frame's first. Default: 0, the topmost. */
  int64_t first_row;
  /* Above 0, a power of two up to 64: rays are cast where the picture has something to show, not through every pixel
   * (Levoy 1990). First there is one at every so many pixels, in both directions; a square between four of them is cut
   * into four, and so on down to single pixels, unless all four channels of its corners differ by less than
   * adaptive_epsilon; the pixels between corners are interpolated. A pixel that a ray was cast through is as exact as
   * without, but what lies between corners may be missed: there is no bound on the error. Default: 0, every pixel. Not
   * with several samples, channels, or a blend mode other than composite (TETCAST_ERROR_ARGUMENT). */
  int adaptive_coarse;
  /* With adaptive_coarse, finite and ≥ 0, in the units of the channels, colours premultiplied. 0 (the default): no
   * square is left whole, and the picture is, to the bit, the one without adaptive_coarse and with adaptive_fine
   * samples. */
  double adaptive_epsilon;
  /* With adaptive_coarse, in [1, 2^16]: how many rays, on a grid as with `samples`, are cast through a pixel that
   * differs by adaptive_epsilon or more from one of its four neighbours. Default: 1, none but the first. */
  int adaptive_fine;
  /* Called while the picture is made (context.h). Default: not called. */
  TetcastProgress progress;
} TetcastRenderDesc;

/* Makes a desc with every setting at its default. */
TETCAST_API TetcastRenderDesc tetcast_render_desc_default(void);

/* What was done to make a picture. */
typedef struct TetcastRenderStats {
  /* The number of rays cast: width × height × samples, or with adaptive_coarse how many there were. */
  int64_t rays;
  /* The number of cells crossed over a length > 0, summed over the rays. */
  int64_t segments;
  /* The largest of the pixels' error bounds (TETCAST_CHANNEL_ERROR), ≥ 0, where they were measured: if the frame has
   * that channel, or rays were walked in single precision. Else, and with adaptive_coarse, NaN. */
  double error;
  /* The number of rays whose walk ended before the boundary. Anything but 0 is a defect of tetcast. */
  int64_t lost;
  /* The name of the instruction set that was used: "scalar", "avx2" or "avx512". In static storage, never NULL. */
  const char *isa;
  /* The arithmetic's precision: "double", or "single" where rays were walked in single precision, except for the few
   * rays for which that would not do. In static storage, never NULL. */
  const char *precision;
} TetcastRenderStats;

/* Renders into every pixel of `frame`, all its channels. `desc` and `stats` may be NULL. The scene must have
 * coefficients, or a transfer function and a field (TETCAST_ERROR_ARGUMENT).
 *
 * With coefficients, the pixel's colour is the radiance: three groups are red, green and blue; one group is grey; of
 * any other number the mean is shown in grey. Its alpha is the mean over the groups of 1 − transmittance. Only the
 * exact integrator works with them, and the result is exact up to rounding whatever the tolerance. Channels of groups
 * need a frame with the scene's number of groups.
 *
 * With another blend mode than composite, values are exact up to rounding in double precision, whatever the tolerance;
 * other integrators, coefficients and the error channel are TETCAST_ERROR_ARGUMENT then.
 *
 * With one instruction set the result has the same bits for any number of threads. After an error or a cancelled call
 * the frame's pixels are unspecified and the scene is as before. Calls with different frames may run at the same time,
 * also on one scene. */
TETCAST_API TetcastStatus tetcast_scene_render(const TetcastScene *scene, const TetcastCamera *camera,
                                               const TetcastRenderDesc *desc, TetcastFrame *frame,
                                               TetcastRenderStats *stats);

/* Draws the edges of the mesh's bounding box into a frame that this scene was rendered to from this camera, about a
 * pixel wide, in a colour: red, green and blue, not premultiplied, each at least 0 and finite. They are composited
 * where they are: those of the box's faces that are seen from outside lie before all of the mesh, others behind it.
 * `desc`: with which the frame was rendered, NULL: the default; the distances of its `stop` hide edges, and the frame
 * has the rows of the picture that it says. The frame's channels are not changed. */
TETCAST_API TetcastStatus tetcast_scene_draw_outline(const TetcastScene *scene, const TetcastCamera *camera,
                                                     const TetcastRenderDesc *desc, const double color[3],
                                                     TetcastFrame *frame);

#ifdef __cplusplus
}
#endif

#endif
