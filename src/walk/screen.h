/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices as a camera sees them, projected once for a frame: a step of a walk then finds a vertex with two
 * subtractions.
 *
 * For a camera that looks along `forward`, with a pixel's ray along forward + u right + v up, a vertex at a from the
 * eye has the coordinates (z, z u, z v) = (f*, r*, u*) · a, with the dual basis of (forward, right, up). Its position
 * on the screen, in pixels from where the volume's centre is nearly, is rounded once: all before is computed to twice
 * the precision. */
#ifndef TC_WALK_SCREEN_H
#define TC_WALK_SCREEN_H

#include "volume/rows.h"

/* A camera in scaled coordinates: position (u, v) ∈ [−1, 1]² of the picture looks along forward + u right + v up
 * (perspective), or starts at eye + u right + v up (orthographic). */
typedef struct TcView {
  double eye[3], forward[3], right[3], up[3];
  bool orthographic;
} TcView;

/* The coordinate c · (vertex − eye), to twice the precision. */
typedef struct TcDual {
  double high[3], low[3];
} TcDual;

typedef struct TcScreen {
  /* [vertex_count][4]: double x, y, d, s, or 32-bit integers x, y in units of 1/unit pixel and float d, s. x and y are
   * pixels from (x0, y0), to the right and down. d is distance / z − 1 in perspective, with z along `forward` from the
   * eye, else z − distance. s is the scalar, where the field is one of points. */
  void *vertices;
  double x0, y0;               /* whole pixels */
  double forward[3], distance; /* of the volume's centre from the eye, along `forward` */
  bool perspective;
  double unit;   /* in single precision: a power of two */
  double extent; /* bound on |x|, |y|: to which their rounding is relative */

  TcDual to_x, to_y, to_z;   /* x and y in pixels, times z in perspective */
  double offset_x, offset_y; /* of pixel coordinates */
} TcScreen;

/* How far what a ray sees may be off by rounding, in the numbers that it is walked with: its vertices are moved beside
 * it by `beside` + `relative` times how far they are from it, its depths by `depth`, its scalars by `value`.
 * walk/screen.c derives them. */
typedef struct TcResolution {
  double beside, relative, depth, value;
} TcResolution;

/* `single`: of kernels in single precision; `values`: the largest magnitude of scalars, and of the transfer function's
 * knots among them. */
TcResolution tc_screen_resolution(const TetcastVolume *volume, const TcScreen *screen, bool single, int64_t width,
                                  int64_t height, double values);
/* The same in ray space, of rays from an eye that is at most this far from the volume's centre; 0 for rays whose
 * directions are taken as given. */
TcResolution tc_ray_resolution(const TetcastVolume *volume, double eye_distance, double values);

/* How vertices are seen in a picture of width × height pixels; without the vertices. False: not to be projected, as the
 * eye is too near to the volume's sphere, inside it, or so far away that digits would be lost. */
bool tc_screen_setup(const TetcastVolume *volume, const TcView *view, int64_t width, int64_t height, TcScreen *screen);

#endif
