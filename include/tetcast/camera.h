/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CAMERA_H
#define TETCAST_CAMERA_H

#include <tetcast/export.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How rays spread: from one point, or parallel. */
typedef enum TetcastProjection { TETCAST_PERSPECTIVE = 0, TETCAST_ORTHOGRAPHIC } TetcastProjection;

/* Where the picture is taken from, in the mesh's coordinates. Each pixel is a ray that starts at the eye (perspective)
 * or on the plane through the eye (orthographic) and only sees what lies ahead, also from inside the mesh. Pixel (i,
 * j), j = 0 at the top, of W × H looks along forward + (center[0] + 2(i + ½)/W − 1) · W/H · tan(fovy/2) · right +
 * (center[1] + 1 − 2(j + ½)/H) · tan(fovy/2) · up with right = forward × up and up made perpendicular to forward;
 * orthographic rays start at the eye moved by the same expression with height/2 in place of tan(fovy/2). */
typedef struct TetcastCamera {
  /* The point that the picture is taken from. Coordinates must be below 2^499 (1e150) times the mesh's largest one;
   * beyond, rendering is TETCAST_ERROR_ARGUMENT. */
  double eye[3];
  /* The point that is seen in the picture's middle, unless `center` moves it. It must differ from the eye. */
  double target[3];
  /* The direction that points upwards in the picture. It need not be perpendicular to the direction of view, but must
   * not be parallel to it. */
  double up[3];
  /* Whether rays start at the eye or are parallel. */
  TetcastProjection projection;
  /* The vertical angle of view in degrees, in (0, 180). Used in perspective only. */
  double fovy;
  /* The picture's height in the mesh's unit of length, > 0 and limited as the eye's coordinates are. Used in
   * orthographic projection only. */
  double height;
  /* Where the picture's middle is to the right of what lies straight ahead, and above it, in halves of the picture's
   * width and height, finite: 0, 0 for most cameras. The direction of view stays as it is, so that pictures side by
   * side fit together: those of a wall of 2 × 2 screens, each half as large as the whole, have −1 or 1. For two eyes it
   * turns the picture to one plane without turning the cameras to each other. VTK calls it the window's centre. */
  double center[2];
} TetcastCamera;

/* Makes the camera that sees all of `bounds` (xmin, xmax, ymin, ymax, zmin, zmax). It looks along −z with +y up at
 * their centre, with 30° of view, from the distance R / sin 15° where R is half the diagonal. For pictures higher than
 * wide (aspect = W/H < 1) it is farther away, so that the width fits as well. The height is set to 2 R, for a switch to
 * orthographic projection. For bounds beyond ±1e307 the eye may be infinitely far away, which no picture can be taken
 * from. */
TETCAST_API TetcastCamera tetcast_camera_default(const double bounds[6], double aspect);

#ifdef __cplusplus
}
#endif

#endif
