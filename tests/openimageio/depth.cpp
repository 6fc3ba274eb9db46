// SPDX-License-Identifier: Apache-2.0
// Depths are read from images as other programs write them, and what is no depth is refused.
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <sys/stat.h>

extern "C" {
#include <cmocka.h>
}

#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>

#include "fixture.hpp"

#include <tetcast/image.h>
#include <tetcast/tetcast.h>

namespace fs = std::filesystem;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

static constexpr int width = 7, height = 5, pixels = width * height;
// What channel c has at a pixel: numbers that single precision holds.
static double number(int c, int pixel) {
  if (pixel == 3)
    return INFINITY;
  return pixel == 5 ? (double)NAN : 1000 * c + pixel / 8.0 - 1;
}

static std::string write(const char *name, TypeDesc type, const std::vector<std::string> &channels, int parts = 1) {
  const fs::path path = folder / name;
  const auto output = ImageOutput::create(path.string());
  assert_true(output != nullptr);
  std::vector<ImageSpec> specs;
  for (int part = 0; part < parts; part++) {
    ImageSpec spec(width, height, int(channels.size()) / parts, type);
    spec.channelnames.assign(channels.begin() + part * spec.nchannels, channels.begin() + (part + 1) * spec.nchannels);
    spec.attribute("oiio:subimagename", "part" + std::to_string(part));
    specs.push_back(spec);
  }
  assert_true(parts > 1 ? output->open(path.string(), parts, specs.data()) : output->open(path.string(), specs[0]));
  for (int part = 0; part < parts; part++) {
    if (part > 0)
      assert_true(output->open(path.string(), specs[size_t(part)], ImageOutput::AppendSubimage));
    const int count = specs[size_t(part)].nchannels;
    std::vector<double> values;
    for (int pixel = 0; pixel < pixels; pixel++)
      for (int c = 0; c < count; c++)
        values.push_back(number(part * count + c, pixel));
    assert_true(output->write_image(TypeDesc::DOUBLE, values.data()));
  }
  assert_true(output->close());
  return path.string();
}

static TetcastStatus read(const std::string &path, double *depth, int64_t w = width, int64_t h = height) {
  last_error.clear();
  last_warning.clear();
  return tetcast_image_read_depth(context, path.c_str(), w, h, depth);
}

// The depths are those of channel c.
static void expect(const std::string &path, int c, bool warned) {
  double depth[pixels];
  if (read(path, depth) != TETCAST_OK)
    fail_msg("%s", last_error.c_str());
  for (int pixel = 0; pixel < pixels; pixel++) {
    const double wanted = number(c, pixel);
    assert_true(std::isnan(wanted) ? std::isnan(depth[pixel]) : depth[pixel] == wanted);
  }
  assert_int_equal(!last_warning.empty(), warned);
}

static void refuse(const std::string &path, TetcastStatus status, const char *word, int64_t w = width,
                   int64_t h = height) {
  double depth[pixels];
  assert_int_equal(read(path, depth, w, h), status);
  if (last_error.find(word) == std::string::npos || last_error.find(path) == std::string::npos ||
      last_error.find('\n') != std::string::npos)
    fail_msg("'%s' lacks '%s' or the path, or has several lines", last_error.c_str(), word);
}

static void the_channel_of_depths_is_found(void **) {
  expect(write("z.exr", TypeDesc::FLOAT, {"Z"}), 0, false);
  expect(write("any.exr", TypeDesc::FLOAT, {"Distance"}), 0, false);
  expect(write("rgbz.exr", TypeDesc::FLOAT, {"R", "G", "B", "A", "Z"}), 4, false);
  expect(write("layers.exr", TypeDesc::FLOAT, {"R", "G", "B", "view.Depth.Z"}), 3, false);
  expect(write("both.exr", TypeDesc::FLOAT, {"R", "G", "B", "A", "Z", "back.Z"}), 4, false);
  expect(write("rgb.exr", TypeDesc::FLOAT, {"R", "G", "B"}), 0, true);
  expect(write("parts.exr", TypeDesc::FLOAT, {"R", "Z"}, 2), 1, false);
  expect(write("one.tif", TypeDesc::DOUBLE, {"Y"}), 0, false);
  expect(write("half.exr", TypeDesc::HALF, {"Z"}), 0, false);
}

static void what_is_no_depth_is_refused(void **) {
  const std::string fine = write("fine.exr", TypeDesc::FLOAT, {"Z"});
  refuse(fine, TETCAST_ERROR_DATA, "it has 7 x 5 pixels, the picture 5 x 7", 5, 7);
  refuse(write("a.png", TypeDesc::UINT16, {"Y"}), TETCAST_ERROR_DATA, "uint16");
  refuse(write("number.exr", TypeDesc::UINT32, {"Z"}), TETCAST_ERROR_DATA, "floating-point");
  refuse((folder / "nowhere.exr").string(), TETCAST_ERROR_IO, "nowhere.exr");
  refuse(folder.string(), TETCAST_ERROR_IO, "regular file");
  assert_int_equal(mkfifo((folder / "pipe.exr").c_str(), 0600), 0);
  refuse((folder / "pipe.exr").string(), TETCAST_ERROR_IO, "regular file");
  std::ofstream(folder / "text.exr") << "no image at all";
  refuse((folder / "text.exr").string(), TETCAST_ERROR_IO, "text.exr");
  fs::resize_file(fine, fs::file_size(fine) / 2);
  refuse(fine, TETCAST_ERROR_IO, "fine.exr");
  double depth[pixels];
  assert_int_equal(tetcast_image_read_depth(context, nullptr, width, height, depth), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_image_read_depth(context, "a.exr", width, height, nullptr), TETCAST_ERROR_ARGUMENT);
}

static void deep_images_are_refused(void **) {
  const std::string path = (folder / "deep.exr").string();
  const auto output = ImageOutput::create(path);
  ImageSpec spec(width, height, 5, TypeDesc::FLOAT);
  spec.channelnames = {"R", "G", "B", "A", "Z"};
  spec.deep = true;
  assert_true(output->open(path, spec));
  OIIO::DeepData data;
  data.init(spec);
  for (int pixel = 0; pixel < pixels; pixel++)
    data.set_samples(pixel, 1);
  assert_true(output->write_deep_image(data));
  assert_true(output->close());
  refuse(path, TETCAST_ERROR_DATA, "deep");
}

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(the_channel_of_depths_is_found),
                              cmocka_unit_test(what_is_no_depth_is_refused), cmocka_unit_test(deep_images_are_refused)};
  return cmocka_run_group_tests(tests, setup, teardown);
}
