/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices as a camera sees them, projected once for a frame. A step of a walk then takes two subtractions to find
 * where a vertex is beside the ray.
 *
 * For a camera that looks along `forward`, with a pixel's ray along forward + u right + v up, a vertex at a from the
 * eye has the coordinates (z, z u, z v) = (f*, r*, u*) · a, with the dual basis of (forward, right, up). Its position
 * on the screen is in pixels from (x0, y0), near the volume's centre. It is rounded once, as everything before is
 * computed to twice the precision. */
#ifndef TC_WALK_SCREEN_H
#define TC_WALK_SCREEN_H

#include "volume/rows.h"

/* A camera in scaled coordinates. The ray through position (u, v) ∈ [−1, 1]² of the picture goes along
 * forward + u right + v up (perspective), or starts at eye + u right + v up (orthographic), where `center` is added to
 * (u, v). */
typedef struct TcView {
  double eye[3], forward[3], right[3], up[3], center[2];
  bool orthographic;
} TcView;

/* A vector c, high + low, for which c · (vertex − eye) is a coordinate of a vertex, to twice the precision. */
typedef struct TcDual {
  double high[3], low[3];
} TcDual;

typedef struct TcScreen {
  /* [vertex_count][4]: x, y, d and s of each vertex. In double precision all are doubles; in single precision, x and y
   * are 32-bit integers in units of 1 / unit pixels, d and s are floats. x and y are the place on the screen, in pixels
   * from (x0, y0), to the right and down. With z the distance from the eye along `forward`, d is distance / z − 1 in
   * perspective, else z − distance. s is the scalar, if it is one of points. */
  void *vertices;
  /* A place near the volume's centre, in whole pixels from the picture's upper left corner. */
  double x0, y0;
  /* The distance of the volume's centre from the eye along `forward`. */
  double forward[3], distance;
  bool perspective;
  /* In single precision: how many units a pixel has, a power of two. */
  double unit;
  /* A bound on |x| and |y|, to which their rounding is relative. */
  double extent;
  /* These give z, and x and y in pixels (in perspective times z), from the middle of the picture. */
  TcDual to_x, to_y, to_z;
  /* The middle of the picture, in pixels from (x0, y0). */
  double offset_x, offset_y;
} TcScreen;

/* Bounds on the rounding of what a ray sees, in the numbers that it is walked with; walk/screen.c derives them. A
 * vertex is moved beside the ray by at most `beside` + `relative` times its distance from the ray. The error of a depth
 * is at most `depth`, that of a scalar at most `value`. */
typedef struct TcResolution {
  double beside, relative, depth, value;
} TcResolution;

/* The resolution with projected vertices. `single` tells whether the kernels are those in single precision. `values` is
 * the largest magnitude of scalars, and of the transfer function's knots among them. */
TcResolution tc_screen_resolution(const TetcastVolume *volume, const TcScreen *screen, bool single, int64_t width,
                                  int64_t height, double values);
/* The resolution in ray space, for rays from an eye that is at most `eye_distance` from the volume's centre; 0 for rays
 * whose directions are exact as given. */
TcResolution tc_ray_resolution(const TetcastVolume *volume, double eye_distance, double values);

/* Sets up how vertices are projected for a picture of width × height pixels, without projecting them. False if they
 * can't be, as the eye is too near to the volume's sphere, inside it, or so far away that digits would be lost. */
bool tc_screen_setup(const TetcastVolume *volume, const TcView *view, int64_t width, int64_t height, TcScreen *screen);

#endif
