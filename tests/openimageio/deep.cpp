// SPDX-License-Identifier: Apache-2.0
// Deep pictures, read back with OpenImageIO: each sample has its part's depths and light, empty ones are left out, and
// flattened they are what compositing gives. With the names of a flat and a deep file, and of how many parts that one
// has, the files are compared: so the command's are tested (deep.sh).
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

extern "C" {
#include <cmocka.h>
}

#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include "fixture.hpp"

#include <tetcast/image.h>
#include <tetcast/tetcast.h>

namespace fs = std::filesystem;
using OIIO::DeepData;
using OIIO::ImageBuf;
using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int width = 13, height = 37, pixels = width * height, layers = 5;

// Numbers that half holds. Of some pixels all parts are empty, of others some.
static float light(int layer, int pixel, int channel) {
  if (pixel % 7 == 0 || (pixel + layer) % 3 == 0)
    return 0;
  return float((pixel * 5 + layer * 3 + channel) % 32) / 64;
}

struct Made {
  std::vector<std::vector<float>> colors;
  std::vector<const float *> pointers;
  std::vector<double> begin, end;
  TetcastDeep deep;
};

static void make(Made &made) {
  for (int layer = 0; layer < layers; layer++) {
    std::vector<float> colors;
    for (int i = 0; i < 4 * pixels; i++)
      colors.push_back(light(layer, i / 4, i % 4));
    made.colors.push_back(colors);
  }
  for (const auto &colors : made.colors)
    made.pointers.push_back(colors.data());
  for (int i = 0; i < pixels; i++) {
    made.begin.push_back(i / 8.0);
    made.end.push_back(i / 8.0 + (i % 4 ? 10 : 0));
  }
  made.deep = {width, height, layers, made.pointers.data(), made.begin.data(), made.end.data()};
}

static void samples_are_parts(void **) {
  for (const TetcastPixelType type : {TETCAST_PIXEL_DEFAULT, TETCAST_PIXEL_FLOAT, TETCAST_PIXEL_HALF}) {
    Made made;
    make(made);
    const std::string path = folder / "parts.exr";
    assert_int_equal(tetcast_image_write_deep(context, path.c_str(), &made.deep, type), TETCAST_OK);
    auto input = ImageInput::open(path);
    assert_non_null(input.get());
    const ImageSpec &spec = input->spec();
    assert_true(spec.deep && spec.width == width && spec.height == height && spec.nchannels == 6);
    DeepData data;
    assert_true(input->read_native_deep_image(0, 0, data));
    int channel[6];
    const char *names[] = {"R", "G", "B", "A", "Z", "ZBack"};
    for (int k = 0; k < 6; k++) {
      channel[k] = spec.channelindex(names[k]);
      assert_true(channel[k] >= 0);
      const bool half = type == TETCAST_PIXEL_HALF && k < 4;
      assert_true(spec.channelformat(channel[k]) == (half ? TypeDesc::HALF : TypeDesc::FLOAT));
    }
    for (int i = 0; i < pixels; i++) {
      int sample = 0;
      for (int layer = 0; layer < layers; layer++) {
        bool any = false;
        for (int k = 0; k < 4; k++)
          any = any || light(layer, i, k) != 0;
        if (!any)
          continue;
        assert_true(sample < data.samples(i));
        for (int k = 0; k < 4; k++)
          assert_true(data.deep_value(i, channel[k], sample) == light(layer, i, k));
        const double length = made.end[size_t(i)] - made.begin[size_t(i)];
        assert_true(data.deep_value(i, channel[4], sample) == float(made.begin[size_t(i)] + length * layer / layers));
        assert_true(data.deep_value(i, channel[5], sample) ==
                    (layer == layers - 1 ? float(made.end[size_t(i)])
                                         : float(made.begin[size_t(i)] + length * (layer + 1) / layers)));
        sample++;
      }
      assert_int_equal(data.samples(i), sample);
    }
  }
}

// The largest difference of red, green, blue and alpha between a flat picture and a deep one that is flattened;
// infinite if the files are not such.
static double difference(const std::string &flat_path, const std::string &deep_path, int most_samples) {
  ImageBuf flat(flat_path), deep(deep_path);
  if (!flat.read(0, 0, true, TypeDesc::FLOAT) || !deep.read() || !deep.deep() || flat.deep() ||
      deep.spec().width != flat.spec().width || deep.spec().height != flat.spec().height)
    return INFINITY;
  const ImageBuf flattened = OIIO::ImageBufAlgo::flatten(deep);
  double largest = 0;
  int most = 0;
  for (int y = 0; y < flat.spec().height; y++) {
    for (int x = 0; x < flat.spec().width; x++) {
      most = std::max(most, deep.deep_samples(x, y));
      for (const char *name : {"R", "G", "B", "A"}) {
        const float a = flat.getchannel(x, y, 0, flat.spec().channelindex(name)),
                    b = flattened.getchannel(x, y, 0, flattened.spec().channelindex(name));
        largest = std::max(largest, std::fabs(double(a) - double(b)));
      }
    }
  }
  return most > most_samples || most < 2 ? INFINITY : largest;
}

static void what_cannot_be_is_refused(void **) {
  Made made;
  make(made);
  const struct {
    const char *name, *text;
    TetcastPixelType type;
  } cases[] = {{"a.tif", "only .exr holds deep pictures", TETCAST_PIXEL_DEFAULT},
               {"exr", "only .exr holds deep pictures", TETCAST_PIXEL_DEFAULT},
               {"a.exr", "of type half or float", TETCAST_PIXEL_UINT8},
               {"none/a.exr", "its folder does not exist", TETCAST_PIXEL_DEFAULT}};
  for (const auto &item : cases) {
    const std::string path = folder / item.name;
    assert_int_not_equal(tetcast_image_write_deep(context, path.c_str(), &made.deep, item.type), TETCAST_OK);
    if (last_error.find(item.text) == std::string::npos)
      fail_msg("'%s' is missing in '%s'", item.text, last_error.c_str());
    assert_false(fs::exists(path));
  }
  made.deep.begin = nullptr;
  assert_int_equal(tetcast_image_write_deep(context, "a.exr", &made.deep, TETCAST_PIXEL_DEFAULT),
                   TETCAST_ERROR_ARGUMENT);
  make(made);
  made.deep.layer_count = 0;
  assert_int_equal(tetcast_image_write_deep(context, "a.exr", &made.deep, TETCAST_PIXEL_DEFAULT),
                   TETCAST_ERROR_ARGUMENT);
}

int main(int argc, char **argv) {
  if (argc == 5) { // FLAT DEEP PARTS OFF
    const double off = difference(argv[1], argv[2], std::atoi(argv[3]));
    std::printf("%s and %s differ by %g\n", argv[1], argv[2], off);
    return off <= std::atof(argv[4]) ? 0 : 1;
  }
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(samples_are_parts),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
