/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_COLOR_H
#define TETCAST_CLI_COLOR_H

#include <stdbool.h>
#include <stdint.h>

/* Red, green, blue, alpha from 0 to 1, of a name or of #rgb, #rgba, #rrggbb or #rrggbbaa. False: it is neither. */
bool color_parse(const char *text, double rgba[4]);

/* Name i = 0, 1, … of those that there are, as in CSS 2.1, with "transparent"; NULL beyond the last. Static storage. */
const char *color_name(int i);

/* The colour at a value of knots [count][4], each a value, red, green and blue; beyond the ends it is theirs. */
void colors_at(const double *knots, int64_t count, double value, double rgb[3]);

#endif
