/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_REFERENCE_JUDGE_H
#define TETCAST_REFERENCE_JUDGE_H

#include <vector>

#include "scene.h"

namespace reference {

struct Truth {
  std::vector<double> rgba;
  std::vector<char> folded;  /* per pixel: cells overlap behind it */
  std::vector<double> moved; /* per pixel: how much it changes if its ray is moved by a rounding error */
};

/* The largest difference of a channel; a NaN is infinitely far from everything. */
double distance(const std::vector<double> &a, const std::vector<double> &b, size_t pixel);

/* Prints how far one or two images are from the truth in the chosen pixels, and from each other in all; whether that is
 * within the tolerance or, with `condition`, within what moving a ray does. */
bool judge(const Scene &scene, const Truth &truth, const std::vector<size_t> &chosen,
           const std::vector<std::vector<double>> &images, double tolerance, bool condition);

} // namespace reference

#endif
