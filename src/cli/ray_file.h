/* SPDX-License-Identifier: Apache-2.0 */
/* Lists of rays, and what they have gathered, as .csv and .npy. */
#ifndef TETCAST_CLI_RAY_FILE_H
#define TETCAST_CLI_RAY_FILE_H

#include <stdbool.h>
#include <stdint.h>

#include <tetcast/cast.h>

/* Numbers of rays: origin, direction, begin, end. */
enum { RAY_ORIGIN, RAY_DIRECTION = 3, RAY_BEGIN = 6, RAY_END, RAY_NUMBERS };

typedef struct RayFile {
  int64_t count;
  double (*rays)[RAY_NUMBERS]; /* [count] */
} RayFile;

/* Reads --rays: .csv with a header, or .npy, whichever the content is. False after a message with file and line. */
bool ray_file_read(const char *path, RayFile *file);
void ray_file_release(RayFile *file);

/* As the library takes them; valid while the file is there. */
TetcastRays ray_file_rays(const RayFile *file);

/* A column of results: the name, and a number for each ray, `stride` numbers apart. */
typedef struct RayColumn {
  char name[40];
  const double *numbers;
  int64_t stride;
} RayColumn;

/* Whether the name ends with .csv or .npy. */
bool ray_file_is_writable(const char *path);

/* Writes a row for each ray. False after a message. */
bool ray_file_write(const char *path, const RayColumn *columns, int column_count, int64_t rays);

#endif
