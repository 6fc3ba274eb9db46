/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "optics/transfer.h"

enum { KNOTS = 17 };

/* Colour maps at 17 equidistant knots, as display values (sRGB). viridis, plasma, inferno and magma by N. Smith and
 * S. van der Walt are in the public domain (CC0); turbo by A. Mikhailov; coolwarm after K. Moreland, Diverging color
 * maps for scientific visualization, 2009; gray. */
static const struct Preset {
  const char *name;
  unsigned char color[KNOTS][3];
} presets[] = {
    {"viridis",
     {{68, 1, 84},
      {72, 24, 106},
      {71, 45, 123},
      {66, 64, 134},
      {59, 82, 139},
      {51, 99, 141},
      {44, 114, 142},
      {38, 130, 142},
      {32, 145, 140},
      {31, 160, 136},
      {40, 174, 128},
      {63, 188, 115},
      {94, 201, 98},
      {132, 212, 75},
      {173, 220, 48},
      {216, 226, 25},
      {253, 231, 37}}},
    {"plasma",
     {{13, 8, 135},
      {49, 5, 151},
      {76, 2, 161},
      {102, 0, 167},
      {126, 3, 168},
      {149, 17, 161},
      {170, 35, 149},
      {188, 53, 135},
      {204, 71, 120},
      {218, 90, 106},
      {230, 108, 92},
      {240, 128, 78},
      {248, 149, 64},
      {253, 172, 51},
      {253, 197, 39},
      {248, 223, 37},
      {240, 249, 34}}},
    {"inferno",
     {{0, 0, 4},
      {11, 7, 36},
      {33, 12, 74},
      {61, 9, 101},
      {87, 16, 109},
      {113, 25, 110},
      {138, 34, 106},
      {163, 44, 97},
      {188, 55, 84},
      {210, 70, 68},
      {228, 90, 49},
      {241, 115, 29},
      {249, 142, 9},
      {252, 172, 17},
      {249, 203, 53},
      {242, 234, 105},
      {252, 255, 164}}},
    {"magma",
     {{0, 0, 4},
      {10, 8, 34},
      {29, 17, 71},
      {54, 16, 107},
      {81, 18, 124},
      {106, 28, 129},
      {131, 38, 129},
      {156, 46, 127},
      {183, 55, 121},
      {208, 65, 111},
      {231, 81, 99},
      {245, 107, 92},
      {252, 137, 97},
      {254, 167, 114},
      {254, 196, 136},
      {253, 226, 163},
      {252, 253, 191}}},
    {"turbo",
     {{48, 18, 59},
      {64, 64, 162},
      {70, 107, 227},
      {66, 148, 255},
      {40, 188, 235},
      {24, 221, 194},
      {50, 242, 152},
      {109, 254, 98},
      {164, 252, 60},
      {205, 236, 52},
      {238, 207, 58},
      {253, 172, 52},
      {251, 126, 33},
      {235, 80, 14},
      {208, 47, 5},
      {169, 22, 1},
      {122, 4, 3}}},
    {"coolwarm",
     {{59, 76, 192},
      {78, 104, 215},
      {98, 130, 234},
      {119, 154, 247},
      {141, 176, 254},
      {163, 194, 255},
      {184, 208, 249},
      {204, 217, 238},
      {221, 221, 221},
      {236, 211, 198},
      {245, 196, 173},
      {247, 177, 148},
      {244, 154, 123},
      {236, 127, 99},
      {222, 97, 76},
      {203, 62, 56},
      {180, 4, 38}}},
    {"gray",
     {{0, 0, 0},
      {16, 16, 16},
      {32, 32, 32},
      {48, 48, 48},
      {64, 64, 64},
      {80, 80, 80},
      {96, 96, 96},
      {112, 112, 112},
      {128, 128, 128},
      {143, 143, 143},
      {159, 159, 159},
      {175, 175, 175},
      {191, 191, 191},
      {207, 207, 207},
      {223, 223, 223},
      {239, 239, 239},
      {255, 255, 255}}},
};

enum { PRESETS = sizeof presets / sizeof *presets };

const char *tc_preset_name(int i) {
  return i >= 0 && i < PRESETS ? presets[i].name : NULL;
}

TetcastStatus tc_transfer_create_preset(TetcastContext *context, const char *name, double low, double high,
                                        double extinction, TetcastTransferFunction **out) {
  const struct Preset *preset = NULL;
  char names[256] = "";
  for (int i = 0; i < PRESETS; ++i) {
    if (strcmp(presets[i].name, name) == 0)
      preset = &presets[i];
    strcat(strcat(names, i ? ", " : ""), presets[i].name);
  }
  if (!preset) {
    return tc_error(context, TETCAST_ERROR_ARGUMENT, "there is no preset \"%s\"; there are %s", name, names);
  }
  double color[KNOTS][4], ramp[2][2] = {{low, low < high ? 0 : extinction}, {high, extinction}};
  int64_t count = 0;
  for (int i = 0; i < KNOTS; ++i) {
    /* Where the range is a single value, or so narrow that knots would fall on each other, the middle colour alone. */
    const double w = i / (KNOTS - 1.0), value = low * (1 - w) + high * w;
    if (count > 0 && !(value > color[count - 1][0]))
      continue;
    color[count][0] = i == KNOTS - 1 ? high : value;
    for (int k = 0; k < 3; ++k)
      color[count][k + 1] = preset->color[low < high ? i : KNOTS / 2][k] / 255.0;
    ++count;
  }
  const TetcastTransferFunctionDesc desc = {
      .color = color[0], .color_count = count, .extinction = ramp[0], .extinction_count = low < high ? 2 : 1};
  return tc_transfer_create(context, &desc, out);
}
