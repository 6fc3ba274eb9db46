/* SPDX-License-Identifier: Apache-2.0 */
/* Frames as 8-bit numbers over a background. */
#include <stdlib.h>

#include "support.h"

enum { WIDTH = 19, HEIGHT = 45, PIXELS = WIDTH * HEIGHT };

static TetcastFrame *frame_of(TetcastContext *context, TetcastType type, void *pixels) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = WIDTH;
  desc.height = HEIGHT;
  desc.type = type;
  desc.pixels = pixels;
  TetcastFrame *frame = NULL;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

/* Pixels of any colour and opacity, some of them clear, opaque, too bright, negative or not a number. */
static void fill(double *pixels) {
  uint64_t seed = 1;
  for (int i = 0; i < PIXELS; ++i) {
    const double alpha = i % 7 == 0 ? 0 : i % 7 == 1 ? 1 : uniform(&seed);
    for (int k = 0; k < 3; ++k)
      pixels[4 * i + k] = alpha * uniform(&seed) * (i % 11 == 3 ? 3 : 1);
    pixels[4 * i + 3] = alpha;
  }
  pixels[4 * 20] = NAN;
  pixels[4 * 21] = -1;
  pixels[4 * 22 + 1] = INFINITY;
}

/* A component in [0, 255] as a real number, which is rounded to the nearest. */
static double expected(const double *pixel, const double background[4], int channels, int k) {
  const double alpha = pixel[3] + (1 - pixel[3]) * background[3];
  if (k == 3)
    return 255 * alpha;
  const double color = pixel[k] + (1 - pixel[3]) * background[3] * background[k];
  const double shown = channels == 3 ? color : alpha > 0 ? color / alpha : 0;
  return isnan(shown) || shown < 0 ? 0 : shown > 1 ? 255 : 255 * shown;
}

static void bytes_are_the_nearest(void **state) {
  (void)state;
  static const double backgrounds[4][4] = {{1, 1, 1, 1}, {0, 0, 0, 0}, {0.2, 0.5, 0.9, 0.3}, {0.25, 0.5, 0.75, 1}};
  static double pixels[4 * PIXELS];
  static float rounded[4 * PIXELS];
  fill(pixels);
  for (int threads = 1; threads <= 3; threads += 2) {
    Fixture fixture;
    assert_int_equal(fixture_begin(&fixture, threads, 0), TETCAST_OK);
    for (int i = 0; i < 4 * PIXELS; ++i)
      rounded[i] = (float)pixels[i];
    for (int i = 0; i < 16; ++i) {
      const bool single = i & 1;
      const int channels = i & 2 ? 4 : 3;
      const double *background = backgrounds[i / 4];
      TetcastFrame *frame = frame_of(fixture.context, single ? TETCAST_TYPE_FLOAT32 : TETCAST_TYPE_FLOAT64,
                                     single ? (void *)rounded : (void *)pixels);
      unsigned char tight[4 * PIXELS], loose[HEIGHT * 100];
      memset(loose, 77, sizeof loose);
      assert_int_equal(tetcast_frame_bytes(frame, background, channels, tight, 0), TETCAST_OK);
      /* From below, with gaps between rows. */
      assert_int_equal(tetcast_frame_bytes(frame, background, channels, loose + (HEIGHT - 1) * 100, -100), TETCAST_OK);
      for (int y = 0; y < HEIGHT; ++y) {
        const unsigned char *row = loose + (HEIGHT - 1 - y) * 100;
        assert_memory_equal(row, tight + y * WIDTH * channels, (size_t)(WIDTH * channels));
        for (int j = WIDTH * channels; j < 100; ++j)
          assert_int_equal(row[j], 77);
      }
      for (int j = 0; j < PIXELS * channels; ++j) {
        double pixel[4];
        for (int k = 0; k < 4; ++k)
          pixel[k] = single ? (double)rounded[4 * (j / channels) + k] : pixels[4 * (j / channels) + k];
        const double value = expected(pixel, background, channels, j % channels);
        assert_true(fabs(tight[j] - value) <= 0.5 + 1e-9);
      }
      tetcast_frame_destroy(&frame);
    }
    fixture_end(&fixture);
  }
}

/* Halves go up; an opaque background makes opaque pixels. */
static void rounding_is_as_stated(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  static double pixels[4 * PIXELS];
  TetcastFrame *frame = frame_of(fixture.context, TETCAST_TYPE_FLOAT64, pixels);
  static const double black[4] = {0, 0, 0, 1};
  unsigned char bytes[4 * PIXELS];
  for (int i = 0; i < PIXELS; ++i) {
    pixels[4 * i] = (i % 255 + 0.5) / 255;
    pixels[4 * i + 1] = (i % 255 + 0.499999) / 255;
    pixels[4 * i + 3] = 0.1 * (i % 11);
  }
  assert_int_equal(tetcast_frame_bytes(frame, black, 4, bytes, 0), TETCAST_OK);
  for (int i = 0; i < PIXELS; ++i) {
    const double half = pixels[4 * i] * 255; /* may be rounded to less than a half above */
    assert_int_equal(bytes[4 * i], (int)(half + 0.5));
    assert_int_equal(bytes[4 * i + 1], i % 255);
    assert_int_equal(bytes[4 * i + 2], 0);
    assert_int_equal(bytes[4 * i + 3], 255);
  }
  tetcast_frame_destroy(&frame);
  fixture_end(&fixture);
}

static void wrong_arguments_are_refused(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 1, 0), TETCAST_OK);
  TetcastFrame *frame = frame_of(fixture.context, TETCAST_TYPE_FLOAT32, NULL);
  static const double white[4] = {1, 1, 1, 1}, wrong[4] = {1, 1, 1.5, 1}, no_number[4] = {0, (double)NAN, 0, 0};
  unsigned char bytes[4 * PIXELS];
  assert_int_equal(tetcast_frame_bytes(NULL, white, 3, bytes, 0), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_frame_bytes(frame, NULL, 3, bytes, 0), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_frame_bytes(frame, white, 3, NULL, 0), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_frame_bytes(frame, no_number, 3, bytes, 0), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_frame_bytes(frame, wrong, 3, bytes, 0), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(fixture.message, "background component 1.5 is outside [0, 1]");
  assert_int_equal(tetcast_frame_bytes(frame, white, 1, bytes, 0), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(fixture.message, "a frame as bytes of 1 channels: must be 3 or 4");
  assert_int_equal(tetcast_frame_bytes(frame, white, 4, bytes, 4 * WIDTH - 1), TETCAST_ERROR_ARGUMENT);
  assert_string_equal(fixture.message, "a row stride of 75 bytes, but a row has 76");
  tetcast_frame_destroy(&frame);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bytes_are_the_nearest),
      cmocka_unit_test(rounding_is_as_stated),
      cmocka_unit_test(wrong_arguments_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
