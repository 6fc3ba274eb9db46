// SPDX-License-Identifier: Apache-2.0
// What files say about their colours, and what the exposure does to them.
#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

extern "C" {
#include <cmocka.h>
}

#include <OpenImageIO/imageio.h>

#include "fixture.hpp"

#include <tetcast/image.h>

using OIIO::ImageInput;
using OIIO::TypeDesc;

static const float pixels[4][4] = {{0.25f, 0.5f, 0, 0.5f}, {0.1f, 0, 0.3f, 0.3f}, {0, 0, 0, 0}, {0.75f, 0.1f, 1, 1}};

static TetcastStatus write(const std::string &path, const TetcastImageDesc &desc) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 2;
  frame_desc.type = TETCAST_TYPE_FLOAT32;
  frame_desc.pixels = const_cast<float(*)[4]>(pixels);
  TetcastFrame *frame = nullptr;
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  const TetcastStatus status = tetcast_image_write(context, path.c_str(), frame, &desc);
  tetcast_frame_destroy(&frame);
  return status;
}

static void colors_are_said_to_be_what_they_are(void **) {
  static const struct {
    const char *name;
    TetcastPixelType type;
    int linear;
    const char *space, *words; // the first nullptr: what OpenImageIO takes it for
  } cases[] = {{"a.png", TETCAST_PIXEL_UINT8, 0, "sRGB", ""},
               {"b.png", TETCAST_PIXEL_UINT16, 1, "sRGB", ""},
               {"a.jpg", TETCAST_PIXEL_UINT8, 1, "sRGB", ""},
               {"a.tif", TETCAST_PIXEL_UINT8, 1, nullptr, "colours are display values (sRGB)"},
               {"b.tif", TETCAST_PIXEL_FLOAT, 0, nullptr, "colours are display values (sRGB)"},
               {"c.tif", TETCAST_PIXEL_DOUBLE, 1, nullptr, "colours are linear radiance"},
               {"a.exr", TETCAST_PIXEL_HALF, 1, "Linear", "colours are linear radiance"},
               {"b.exr", TETCAST_PIXEL_FLOAT, 0, nullptr, "colours are display values (sRGB)"}};
  for (const auto &one : cases) {
    const std::string path = folder / one.name;
    TetcastImageDesc desc = tetcast_image_desc_default();
    desc.pixel_type = one.type;
    desc.linear = one.linear;
    assert_int_equal(write(path, desc), TETCAST_OK);
    const auto input = ImageInput::open(path);
    assert_true(input != nullptr);
    const std::string space = input->spec()["oiio:ColorSpace"].get(), words = input->spec()["ImageDescription"].get();
    if (one.space && space != one.space)
      fail_msg("%s: colour space '%s'", one.name, space.c_str());
    if (words != one.words)
      fail_msg("%s: '%s'", one.name, words.c_str());
  }
}

static void exposure_is_for_colors_of_integers(void **) {
  for (const double exposure : {0.0, 1.0, -1.5, 0.3, 1000.0, -1000.0}) {
    for (const double alpha : {0.0, 0.4, 1.0}) {
      const std::string path = folder / "x.tif";
      TetcastImageDesc desc = tetcast_image_desc_default();
      desc.exposure = exposure;
      const double background[4] = {0.2, 0.6, 1, alpha};
      std::copy(background, background + 4, desc.background);
      for (const TetcastPixelType type : {TETCAST_PIXEL_UINT16, TETCAST_PIXEL_FLOAT}) {
        desc.pixel_type = type;
        assert_int_equal(write(path, desc), TETCAST_OK);
        OIIO::ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1);
        const auto input = ImageInput::open(path, &config);
        const int channels = input->spec().nchannels;
        std::vector<double> got(4 * size_t(channels));
        assert_true(input->read_image(0, 0, 0, channels, TypeDesc::DOUBLE, got.data()));
        for (size_t i = 0; i < got.size(); i++) {
          const float *p = pixels[i / size_t(channels)];
          const size_t k = i % size_t(channels);
          const double behind = (1 - double(p[3])) * alpha, all = double(p[3]) + behind;
          const double over = double(p[k]) * std::pow(2, exposure) + behind * background[k];
          const double expected = type == TETCAST_PIXEL_FLOAT ? double(p[k])
                                  : k == 3                    ? all
                                  : all > 0                   ? std::min(over / all, 1.0)
                                                              : 0;
          if (std::fabs(got[i] - expected) > 1e-5)
            fail_msg("exposure %g, background %g: value %zu is %g instead of %g", exposure, alpha, i, got[i], expected);
        }
      }
    }
  }
  TetcastImageDesc desc = tetcast_image_desc_default();
  desc.exposure = NAN;
  assert_int_equal(write(folder / "y.png", desc), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(last_error.c_str(), "the exposure nan is not a finite number");
}

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(colors_are_said_to_be_what_they_are),
                              cmocka_unit_test(exposure_is_for_colors_of_integers)};
  return cmocka_run_group_tests(tests, setup, teardown);
}
