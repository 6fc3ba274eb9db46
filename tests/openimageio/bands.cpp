// SPDX-License-Identifier: Apache-2.0
// Pictures that are written in bands of rows are the files of whole ones, and nothing is left of those that can't be.
#include <algorithm>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

extern "C" {
#include <cmocka.h>
}

#include "fixture.hpp"

#include <tetcast/image.h>

namespace fs = std::filesystem;

static constexpr int64_t width = 33, height = 150;

static float number(int64_t i) {
  return float(i % 4 == 3 ? 1 : double(i * 7919 % 1009) / 1009);
}

// The rows [begin, end) of a picture.
static TetcastFrame *rows(int64_t begin, int64_t end, std::vector<float> &pixels, int64_t wide = width) {
  pixels.resize(size_t(4 * wide * (end - begin)));
  for (size_t i = 0; i < pixels.size(); i++)
    pixels[i] = number(4 * wide * begin + int64_t(i));
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = wide;
  desc.height = end - begin;
  desc.type = TETCAST_TYPE_FLOAT32;
  desc.pixels = pixels.data();
  TetcastFrame *frame = nullptr;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

static std::string content(const fs::path &path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

static size_t file_count() {
  return size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

static TetcastStatus begin(const char *name, int64_t tall, TetcastImage **image) {
  std::vector<float> pixels;
  TetcastFrame *frame = rows(0, 64, pixels);
  const TetcastStatus status = tetcast_image_begin(context, (folder / name).c_str(), frame, tall, nullptr, image);
  tetcast_frame_destroy(&frame);
  return status;
}

static TetcastStatus add(TetcastImage *image, int64_t from, int64_t to, int64_t wide = width) {
  std::vector<float> pixels;
  TetcastFrame *frame = rows(from, to, pixels, wide);
  const TetcastStatus status = tetcast_image_add(image, frame);
  tetcast_frame_destroy(&frame);
  return status;
}

static void bands_make_the_file_of_the_whole(void **) {
  for (const char *name : {"a.png", "a.exr", "a.tif"}) {
    std::vector<float> pixels;
    TetcastFrame *frame = rows(0, height, pixels);
    assert_int_equal(tetcast_image_write(context, (folder / name).c_str(), frame, nullptr), TETCAST_OK);
    tetcast_frame_destroy(&frame);
    const std::string other = std::string("b") + (name + 1);
    TetcastImage *image = nullptr;
    assert_int_equal(begin(other.c_str(), height, &image), TETCAST_OK);
    assert_int_equal(add(image, 0, 64), TETCAST_OK);
    assert_int_equal(add(image, 64, 128), TETCAST_OK);
    assert_false(fs::exists(folder / other));
    assert_int_equal(add(image, 128, height), TETCAST_OK);
    assert_int_equal(tetcast_image_end(&image), TETCAST_OK);
    assert_null(image);
    assert_true(content(folder / name) == content(folder / other));
    fs::remove(folder / name);
    fs::remove(folder / other);
  }
  assert_int_equal(file_count(), 0);
}

static void what_is_not_whole_leaves_nothing(void **) {
  for (const char *name : {"a.png", "a.exr", "a.tif"}) {
    TetcastImage *image = nullptr;
    assert_int_equal(begin(name, height, &image), TETCAST_OK);
    assert_int_equal(add(image, 0, 64), TETCAST_OK);
    assert_int_equal(tetcast_image_end(&image), TETCAST_ERROR_ARGUMENT);
    assert_non_null(std::strstr(last_error.c_str(), "rows of the picture are missing"));
    assert_null(image);
    assert_int_equal(begin(name, height, &image), TETCAST_OK);
    tetcast_image_destroy(&image);
    assert_null(image);
    static const int64_t wrong[][3] = {{64, 100, width}, {64, 128, width + 1}, {64, height + 1, width}};
    for (const auto &one : wrong) {
      assert_int_equal(begin(name, height, &image), TETCAST_OK);
      assert_int_equal(add(image, 0, 64), TETCAST_OK);
      assert_int_equal(add(image, one[0], one[1], one[2]), TETCAST_ERROR_ARGUMENT);
      assert_non_null(std::strstr(last_error.c_str(), "the frame is not the next band of the picture"));
      assert_int_equal(tetcast_image_end(&image), TETCAST_ERROR_ARGUMENT);
    }
  }
  TetcastImage *image = nullptr;
  assert_int_equal(begin("a.jpg", height, &image), TETCAST_ERROR_ARGUMENT);
  assert_non_null(std::strstr(last_error.c_str(), "only .png, .exr and .tif are written in bands of rows"));
  assert_int_equal(begin("a.png", 63, &image), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(begin("missing/a.png", height, &image), TETCAST_ERROR_IO);
  tetcast_image_destroy(&image);
  tetcast_image_destroy(nullptr);
  assert_int_equal(tetcast_image_end(&image), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(file_count(), 0);
}

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(bands_make_the_file_of_the_whole),
                              cmocka_unit_test(what_is_not_whole_leaves_nothing)};
  return cmocka_run_group_tests(tests, setup, teardown);
}
