/* SPDX-License-Identifier: Apache-2.0 */
/* VTKHDF files. */
#ifndef TEST_VTK_HDF_SAMPLES_H
#define TEST_VTK_HDF_SAMPLES_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How the steps of a row of cubes along x are stored: at times 0, 0.5 and 1, of 2, 3 and 4 cubes in one part, two and
 * one, whose height is 1 + step; or of 2 cubes of height 1 at each, stored once, with each step's parts listed (again)
 * or not; or without steps, in two parts. */
typedef enum HdfSteps { HDF_MOVING, HDF_STILL, HDF_STILL_LISTED, HDF_NO_STEPS } HdfSteps;

/* Point array h = (1 + step) (x + 2y + 4z), cell array c = 10 step + the number of the cube. Points are the parts' own.
 */
void hdf_sample_cubes(const char *path, HdfSteps steps);

/* An image of 3 × 2 × 2 points, with steps, point array h as above, stored for step 0 and 1, step 2 having that of step
 * 0; cell array c of both cells, 10 step + number; and `still`, of 7s, that is of all steps. */
void hdf_sample_image(const char *path, bool steps);

/* Two cubes with an array of each kind: "good" = 0, 1, … at the points, "truth" = i odd, an enumeration, "half" = i / 2
 * in half precision, "big" = i, the other way round, and what can't be read: "text", "pair" (a compound), "short" of
 * too few values, "claim" of a thousand million components that are nowhere. */
void hdf_sample_types(const char *path);

/* A file that says it is of this type, and nothing more. */
void hdf_sample_type(const char *path, const char *type);

/* Cubes whose list `name` has a number changed. */
void hdf_sample_damaged(const char *path, const char *name, long long value);

#ifdef __cplusplus
}
#endif

#endif
