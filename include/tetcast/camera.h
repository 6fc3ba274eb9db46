/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CAMERA_H
#define TETCAST_CAMERA_H

#include <tetcast/export.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum TetcastProjection { TETCAST_PERSPECTIVE = 0, TETCAST_ORTHOGRAPHIC } TetcastProjection;

/* Where the picture is taken from, in the mesh's coordinates. Each pixel is a ray that starts at the eye (perspective)
 * or on the plane through the eye (orthographic) and only sees what lies ahead, also from inside the mesh. Pixel (i,
 * j), j = 0 at the top, of W × H looks along forward + (2(i + ½)/W − 1) · W/H · tan(fovy/2) · right + (1 − 2(j + ½)/H)
 * · tan(fovy/2) · up with right = forward × up and up made perpendicular to forward; orthographic rays start at the eye
 * moved by the same expression with height/2 in place of tan(fovy/2). */
typedef struct TetcastCamera {
  double eye[3];    /* less than 2^499 (1e150) times the mesh's largest coordinate; beyond, rendering is
                       TETCAST_ERROR_ARGUMENT */
  double target[3]; /* must differ from eye */
  double up[3];     /* need not be perpendicular, must not be parallel, to the direction of view */
  TetcastProjection projection;
  double fovy;   /* vertical angle of view in degrees, in (0, 180); perspective only */
  double height; /* vertical extent in the mesh's unit of length, > 0, limited as eye; orthographic only */
} TetcastCamera;

/* The camera that sees all of `bounds` (xmin, xmax, ymin, …): looking along −z with +y up at their centre, 30° of view,
 * from R / sin 15° away, R half the diagonal; for pictures higher than wide (aspect = W/H < 1) farther, so that the
 * width fits as well. height is set to 2 R, for a switch to orthographic. For bounds beyond ±1e307 the eye may be
 * infinitely far away, which is no camera. */
TETCAST_API TetcastCamera tetcast_camera_default(const double bounds[6], double aspect);

#ifdef __cplusplus
}
#endif

#endif
