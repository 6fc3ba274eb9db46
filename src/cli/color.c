/* SPDX-License-Identifier: Apache-2.0 */
#include "color.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

static const struct {
  const char *name;
  unsigned char rgba[4];
} colors[] = {{"white", {255, 255, 255, 255}}, {"black", {0, 0, 0, 255}},        {"gray", {128, 128, 128, 255}},
              {"grey", {128, 128, 128, 255}},  {"silver", {192, 192, 192, 255}}, {"red", {255, 0, 0, 255}},
              {"maroon", {128, 0, 0, 255}},    {"orange", {255, 165, 0, 255}},   {"yellow", {255, 255, 0, 255}},
              {"olive", {128, 128, 0, 255}},   {"lime", {0, 255, 0, 255}},       {"green", {0, 128, 0, 255}},
              {"aqua", {0, 255, 255, 255}},    {"cyan", {0, 255, 255, 255}},     {"teal", {0, 128, 128, 255}},
              {"blue", {0, 0, 255, 255}},      {"navy", {0, 0, 128, 255}},       {"fuchsia", {255, 0, 255, 255}},
              {"magenta", {255, 0, 255, 255}}, {"purple", {128, 0, 128, 255}},   {"transparent", {0, 0, 0, 0}}};

enum { COLORS = sizeof colors / sizeof *colors };

const char *color_name(int i) {
  return i >= 0 && i < COLORS ? colors[i].name : NULL;
}

static bool parse_digits(const char *text, double rgba[4]) {
  static const char digits[] = "0123456789abcdef0123456789ABCDEF";
  const size_t length = strlen(text), each = length > 4 ? 2 : 1;
  if (text[strspn(text, digits)] || (length != 3 && length != 4 && length != 6 && length != 8))
    return false;
  rgba[3] = 1;
  for (size_t i = 0; i < length / each; i++) {
    size_t value = 0;
    for (size_t k = 0; k < each; k++)
      value = 16 * value + (size_t)(strchr(digits, text[i * each + k]) - digits) % 16;
    rgba[i] = (double)value / (each == 2 ? 255 : 15);
  }
  return true;
}

bool color_parse(const char *text, double rgba[4]) {
  if (text[0] == '#')
    return parse_digits(text + 1, rgba);
  for (int i = 0; i < COLORS; i++)
    if (!strcasecmp(text, colors[i].name)) {
      for (int k = 0; k < 4; k++)
        rgba[k] = colors[i].rgba[k] / 255.0;
      return true;
    }
  return false;
}

void colors_at(const double *knots, int64_t count, double value, double rgb[3]) {
  int64_t after = 0;
  while (after < count && knots[4 * after] <= value)
    after++;
  const double *a = knots + 4 * (after > 0 ? after - 1 : 0), *b = knots + 4 * (after < count ? after : count - 1);
  const double part = b[0] > a[0] ? (value - a[0]) / (b[0] - a[0]) : 0;
  for (int k = 0; k < 3; k++)
    rgb[k] = a[1 + k] + part * (b[1 + k] - a[1 + k]);
}
