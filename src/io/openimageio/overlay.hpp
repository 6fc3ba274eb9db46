// SPDX-License-Identifier: Apache-2.0
// What is drawn over the pixels of a picture for people to look at: the legend.
#ifndef TETCAST_OPENIMAGEIO_OVERLAY_HPP
#define TETCAST_OPENIMAGEIO_OVERLAY_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <tetcast/image.h>

namespace tetcast {

// A rectangle of premultiplied pixels, somewhere in a picture.
struct Overlay {
  int64_t x = 0, y = 0, width = 0, height = 0;
  std::vector<float> rgba; // [height][width][4]

  // The pixel at a place of the picture; nullptr: nothing is drawn there.
  const float *at(int64_t i, int64_t j) const {
    const bool inside = i >= x && i < x + width && j >= y && j < y + height;
    return inside ? rgba.data() + 4 * ((j - y) * width + i - x) : nullptr;
  }
};

// Draws the legend for a picture of this size; ink 0 is black, 1 is white. Nothing is drawn where there is no room.
// `problem` becomes what is wrong with the text, "": nothing.
Overlay draw_legend(const TetcastLegend &legend, int64_t width, int64_t height, float ink, std::string &problem);

// Draws words for a picture of this size.
Overlay draw_caption(const TetcastCaption &caption, int64_t width, int64_t height, float ink, std::string &problem);

} // namespace tetcast

#endif
