// SPDX-License-Identifier: Apache-2.0
// Colour maps and opacities as linear pieces, beside VTK's own functions: at many values, in every colour space, for
// random points, midpoints and sharpnesses.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include <vtkColorTransferFunction.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>

extern "C" {
#include "color_map.h"
}

namespace {

int failures = 0;
constexpr int values = 20000;

void check(bool good, const char *what, double off, int knots) {
  if (good)
    return;
  std::printf("FAILED: %s: off by %g, with %d knots\n", what, off, knots);
  ++failures;
}

// Number k of the knots' at x.
double linear(const ColorMapKnots &knots, double x, int k) {
  const double *first = knots.data;
  int next = 0; // the first knot above x
  while (next < knots.count && first[next * knots.width] <= x)
    ++next;
  const double *b = first + std::min(next, knots.count - 1) * knots.width, *a = next > 0 ? b - knots.width : b;
  if (next == 0 || next == knots.count)
    return b[k];
  return a[k] + (b[k] - a[k]) * (x - a[0]) / (b[0] - a[0]);
}

// The largest difference, steps apart: VTK takes either side at a step itself.
template <typename At> double difference(const ColorMapKnots &knots, double first, double last, At &&at) {
  double most = 0;
  for (int i = 0; i <= values; ++i) {
    const double x = first + (last - first) * (i + 0.37) / (values + 1);
    const double *expected = at(x);
    for (int k = 1; k < knots.width; ++k)
      most = std::max(most, std::fabs(expected[k - 1] - linear(knots, x, k)));
  }
  return most;
}

struct Space {
  const char *name;
  ColorSpace ours;
  int vtk;
  bool wrap, steps;
};
const Space spaces[] = {{"RGB", COLOR_SPACE_RGB, VTK_CTF_RGB, false, false},
                        {"HSV", COLOR_SPACE_HSV, VTK_CTF_HSV, false, false},
                        {"HSV, the shorter way", COLOR_SPACE_HSV_WRAP, VTK_CTF_HSV, true, false},
                        {"Lab", COLOR_SPACE_LAB, VTK_CTF_LAB, false, false},
                        {"Diverging", COLOR_SPACE_DIVERGING, VTK_CTF_DIVERGING, false, false},
                        {"Step", COLOR_SPACE_RGB, VTK_CTF_STEP, false, true}};

void compare_colors(const Space &space, const std::vector<double> &points) {
  vtkNew<vtkColorTransferFunction> expected;
  expected->SetColorSpace(space.vtk);
  expected->SetHSVWrap(space.wrap);
  const int count = int(points.size() / 4);
  for (int i = 0; i < count; ++i)
    expected->AddRGBPoint(points[4 * i], points[4 * i + 1], points[4 * i + 2], points[4 * i + 3]);
  ColorMapKnots knots =
      space.steps ? color_map_steps(points.data(), count) : color_map_colors(space.ours, points.data(), count);
  double rgb[3];
  const double off = difference(knots, points[0], points[4 * (count - 1)], [&](double x) {
    expected->GetColor(x, rgb);
    return rgb;
  });
  check(off <= 1e-3 && knots.count < 1000 * count, space.name, off, knots.count);
  color_map_release(&knots);
}

double compare_opacities(const std::vector<double> &points) {
  vtkNew<vtkPiecewiseFunction> expected;
  const int count = int(points.size() / 4);
  double height = 0;
  for (int i = 0; i < count; ++i) {
    expected->AddPoint(points[4 * i], points[4 * i + 1], points[4 * i + 2], points[4 * i + 3]);
    height = std::max(height, points[4 * i + 1]);
  }
  ColorMapKnots knots = color_map_opacities(points.data(), count);
  double value;
  const double off = difference(knots, points[0], points[4 * (count - 1)], [&](double x) {
    value = expected->GetValue(x);
    return &value;
  });
  check(off <= 1e-4 * height + 1e-15 && knots.count < 2000 * count, "opacity", off, knots.count);
  color_map_release(&knots);
  return off / height;
}

} // namespace

int main() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const double plain[][3] = {{0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}};
  for (int run = 0; run < 60; ++run) {
    std::vector<double> points;
    const int count = 2 + run % 5;
    for (int i = 0; i < count; ++i) {
      points.push_back(i + 0.6 * unit(random));
      const double *fixed = plain[random() % 7]; // gray and full colours are special in each space
      for (int k = 0; k < 3; ++k)
        points.push_back(run % 2 ? fixed[k] : unit(random));
    }
    for (const Space &space : spaces)
      compare_colors(space, points);
  }
  compare_colors(spaces[4], {0, 0.23, 0.299, 0.754, 1, 0.706, 0.016, 0.15}); // coolwarm

  const double bends[] = {0, 0.005, 0.01, 0.02, 0.25, 0.5, 0.75, 0.985, 0.995, 1};
  double most = 0;
  for (int run = 0; run < 200; ++run) {
    std::vector<double> points;
    const int count = 2 + run % 4;
    const double height = run % 3 ? 1 : 0.01;
    for (int i = 0; i < count; ++i)
      points.insert(points.end(),
                    {i + 0.6 * unit(random), height * unit(random), run % 7 ? unit(random) : bends[random() % 10],
                     run % 2 ? unit(random) : bends[random() % 10]});
    most = std::max(most, compare_opacities(points));
  }
  check(most > 1e-8, "no difference at all is seen", most, 0);
  std::printf("%d failures; opacities off by up to %g of their height\n", failures, most);
  return failures != 0;
}
