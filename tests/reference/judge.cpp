/* SPDX-License-Identifier: Apache-2.0 */
#include "judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace reference {

/* The largest difference of a channel; a NaN is infinitely far from everything. */
double distance(const std::vector<double> &a, const std::vector<double> &b, size_t pixel) {
  double largest = 0;
  for (size_t i = 4 * pixel; i < 4 * pixel + 4; i++)
    largest = std::max(largest, std::isnan(a[i] - b[i]) ? HUGE_VAL : std::abs(a[i] - b[i]));
  return largest;
}

namespace {

struct Limits {
  size_t width; /* of the image */
  double tolerance;
  bool condition;
};

/* Prints how far `image` is from `expected`, to which `worst` is raised; whether that is within the tolerance. */
bool compare(const char *what, const std::vector<double> &expected, const std::vector<double> &image,
             const std::vector<size_t> &pixels, const Truth &truth, const Limits &limits, double &worst) {
  const size_t width = limits.width;
  double overall = 0;
  std::printf("%s, %zu pixels:\n", what, pixels.size());
  for (size_t c = 0; c < 4; c++) {
    double largest = -1, squares = 0;
    size_t where = 0;
    for (size_t pixel : pixels) {
      const double difference = std::abs(image[pixel * 4 + c] - expected[pixel * 4 + c]);
      const double error = std::isnan(difference) ? HUGE_VAL : difference;
      squares += error * error;
      if (error > largest) {
        largest = error;
        where = pixel;
      }
    }
    std::printf("  %c  max %.2e  rms %.2e  worst at %zu,%zu: %.17g, should be %.17g\n", "RGBA"[c], largest,
                std::sqrt(squares / double(pixels.size())), where % width, where / width, image[where * 4 + c],
                expected[where * 4 + c]);
    overall = std::max(overall, largest);
  }
  size_t beyond = 0, ill = 0;
  for (size_t pixel : pixels) {
    const double error = distance(expected, image, pixel);
    beyond += error > limits.tolerance;
    ill += error > limits.tolerance && error <= truth.moved[pixel];
  }
  std::printf("  %zu pixels beyond %g, %zu of them by less than a moved ray\n", beyond, limits.tolerance, ill);
  worst = std::max(worst, overall);
  return beyond == (limits.condition ? ill : 0);
}

} // namespace

bool judge(const Scene &scene, const Truth &truth, const std::vector<size_t> &chosen,
           const std::vector<std::vector<double>> &images, double tolerance, bool condition) {
  const Limits limits{size_t(scene.width), tolerance, condition};
  std::vector<size_t> sound, all;
  double alpha = 0, worst = 0;
  for (size_t pixel : chosen)
    if (!truth.folded[pixel]) {
      sound.push_back(pixel);
      alpha += truth.rgba[pixel * 4 + 3];
    }
  for (size_t pixel = 0; pixel < truth.folded.size(); pixel++)
    if (!truth.folded[pixel])
      all.push_back(pixel);
  const size_t left_out = chosen.size() - sound.size();
  bool good = left_out * 50 < chosen.size(); /* a mesh of which there is no right picture tests nothing */
  for (size_t i = 0; i < images.size(); i++)
    good &= compare(i ? "other" : "image", truth.rgba, images[i], sound, truth, limits, worst);
  if (images.size() > 1)
    good &= compare("other against image", images[0], images[1], all, truth, limits, worst);
  std::printf("%s: max %.2e, average alpha %.3f in %zu pixels; %zu left out because cells overlap\n",
              good ? "agreed" : "DIFFERENT", worst, alpha / double(sound.size()), sound.size(), left_out);
  return good;
}

} // namespace reference
