/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "optics/transfer.h"

enum { COLORS = 17 };

/* Colour maps at equidistant knots, and categories in steps of equal width, as display values (sRGB). viridis, plasma,
 * inferno and magma by N. Smith and S. van der Walt and cividis by J. Nuñez, C. Anderton and R. Renslow are in the
 * public domain (CC0); turbo by A. Mikhailov; coolwarm after K. Moreland, Diverging color maps for scientific
 * visualization, 2009; RdBu by C. Brewer, of ColorBrewer (Apache-2.0); rainbow-desaturated as in ParaView (BSD);
 * okabe-ito by M. Okabe and K. Ito, which colour-blind people tell apart, with gray for black; gray and distinct10 are
 * our own. */
static const struct Preset {
  const char *name;
  TetcastPresetKind kind;
  int count; /* of the colours */
  unsigned char color[COLORS][3];
} presets[] = {
    {"viridis",
     TETCAST_PRESET_SEQUENTIAL,
     17,
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
     TETCAST_PRESET_SEQUENTIAL,
     17,
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
     TETCAST_PRESET_SEQUENTIAL,
     17,
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
     TETCAST_PRESET_SEQUENTIAL,
     17,
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
     TETCAST_PRESET_SEQUENTIAL,
     17,
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
     TETCAST_PRESET_DIVERGING,
     17,
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
     TETCAST_PRESET_SEQUENTIAL,
     17,
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
    {"cividis",
     TETCAST_PRESET_SEQUENTIAL,
     16,
     {{0, 34, 78},
      {0, 46, 108},
      {30, 58, 111},
      {53, 69, 108},
      {71, 81, 108},
      {87, 93, 109},
      {102, 105, 112},
      {117, 117, 117},
      {132, 130, 121},
      {148, 142, 119},
      {165, 156, 116},
      {183, 169, 110},
      {200, 184, 102},
      {219, 199, 90},
      {238, 214, 73},
      {254, 232, 56}}},
    {"RdBu",
     TETCAST_PRESET_DIVERGING,
     11,
     {{103, 0, 31},
      {178, 24, 43},
      {214, 96, 77},
      {244, 165, 130},
      {253, 219, 199},
      {247, 247, 247},
      {209, 229, 240},
      {146, 197, 222},
      {67, 147, 195},
      {33, 102, 172},
      {5, 48, 97}}},
    {"rainbow-desaturated",
     TETCAST_PRESET_SEQUENTIAL,
     8,
     {{71, 71, 219}, {0, 0, 92}, {0, 255, 255}, {0, 128, 0}, {255, 255, 0}, {255, 97, 0}, {107, 0, 0}, {224, 77, 77}}},
    {"okabe-ito",
     TETCAST_PRESET_CATEGORICAL,
     8,
     {{230, 159, 0},
      {86, 180, 233},
      {0, 158, 115},
      {213, 94, 0},
      {0, 114, 178},
      {204, 121, 167},
      {240, 228, 66},
      {128, 128, 128}}},
    {"distinct10",
     TETCAST_PRESET_CATEGORICAL,
     10,
     {{58, 113, 177},
      {240, 138, 36},
      {74, 157, 63},
      {209, 63, 66},
      {139, 104, 184},
      {139, 92, 72},
      {224, 129, 186},
      {128, 128, 128},
      {184, 179, 48},
      {44, 174, 190}}},
};

enum { PRESETS = sizeof presets / sizeof *presets };

const char *tc_preset_name(int i) {
  return i >= 0 && i < PRESETS ? presets[i].name : NULL;
}

/* The preset of this name, with _r behind it the reverse; NULL: there is none. */
static const struct Preset *find_preset(const char *name, bool *reverse) {
  const size_t length = strlen(name);
  for (int i = 0; i < PRESETS; ++i) {
    const size_t own = strlen(presets[i].name);
    *reverse = length == own + 2 && strcmp(name + own, "_r") == 0;
    if ((*reverse || length == own) && strncmp(name, presets[i].name, own) == 0)
      return &presets[i];
  }
  return NULL;
}

TetcastPresetKind tc_preset_kind(const char *name) {
  bool reverse;
  const struct Preset *preset = find_preset(name, &reverse);
  return preset ? preset->kind : TETCAST_PRESET_NONE;
}

static TetcastStatus refuse_name(TetcastContext *context, const char *name) {
  char names[256] = "";
  for (int i = 0; i < PRESETS; ++i)
    strcat(strcat(names, i ? ", " : ""), presets[i].name);
  return tc_error(context, TETCAST_ERROR_ARGUMENT, "there is no preset \"%s\"; there are %s, each reversed with _r",
                  name, names);
}

TetcastStatus tc_transfer_create_preset(TetcastContext *context, const char *name, double low, double high,
                                        double extinction, TetcastTransferFunction **out) {
  bool reverse;
  const struct Preset *preset = find_preset(name, &reverse);
  if (!preset)
    return refuse_name(context, name);
  static const double ramp[2][2] = {{0, 0}, {1, 1}};
  double color[2 * COLORS][4];
  const bool steps = preset->kind == TETCAST_PRESET_CATEGORICAL;
  const int count = steps ? 2 * preset->count : preset->count;
  for (int i = 0; i < count; ++i) {
    const int own = steps ? i / 2 : i;
    const unsigned char *bytes = preset->color[reverse ? preset->count - 1 - own : own];
    color[i][0] = steps ? (i + 1) / 2 / (double)preset->count : i / (count - 1.0);
    for (int k = 0; k < 3; ++k)
      color[i][k + 1] = bytes[k] / 255.0;
  }
  const TetcastTransferFunctionDesc desc = {
      .color = color[0], .color_count = count, .extinction = ramp[0], .extinction_count = 2};
  TetcastTransferFunction *shape;
  TetcastStatus status = tc_transfer_create(context, &desc, &shape);
  if (status)
    return status;
  status = tc_transfer_stretch(context, shape, low, high, extinction, out);
  tc_transfer_destroy(shape);
  return status;
}
