/* SPDX-License-Identifier: Apache-2.0 */
#include "ray_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "cli.h"
#include "file.h"

static const char *const names[RAY_NUMBERS] = {"ox", "oy", "oz", "dx", "dy", "dz", "begin", "end"};

/* The first bytes of .npy: eight of them, then the length of the header in two. */
static const char magic[8] = "\x93NUMPY\x01";
enum { NPY_START = 10, NPY_ALIGNMENT = 64 };

static void set_defaults(double ray[RAY_NUMBERS]) {
  ray[RAY_BEGIN] = 0;
  ray[RAY_END] = INFINITY;
}

/* What is wrong with a ray, NULL: nothing. */
static const char *fault_of(const double ray[RAY_NUMBERS]) {
  for (int k = 0; k < RAY_BEGIN; k++)
    if (!isfinite(ray[k]))
      return k < RAY_DIRECTION ? "a coordinate of the origin is not finite" : "a number of the direction is not finite";
  if (ray[3] == 0 && ray[4] == 0 && ray[5] == 0)
    return "the direction is 0, 0, 0";
  if (isnan(ray[RAY_BEGIN]) || isnan(ray[RAY_END]))
    return "begin or end is not a number";
  return ray[RAY_BEGIN] > ray[RAY_END] ? "it begins after its end" : NULL;
}

/* ── .csv ── */

/* The word up to the next comma, without blanks around it; *text goes behind the comma, NULL: there is none. */
static char *next_word(char **text) {
  char *word = *text + strspn(*text, " \t"), *comma = strchr(word, ',');
  *text = comma ? comma + 1 : NULL;
  char *end = comma ? comma : word + strlen(word);
  while (end > word && strchr(" \t\r\n", end[-1]))
    end--;
  *end = '\0';
  return word;
}

static bool is_blank(const char *line) {
  return line[strspn(line, " \t\r\n")] == '\0';
}

/* Which number each column is; returns how many there are, 0 after a message. */
static int read_header(const char *path, char *line, int columns[RAY_NUMBERS]) {
  bool has[RAY_NUMBERS] = {false};
  int count = 0;
  if (!strncmp(line, "\xEF\xBB\xBF", 3)) /* some programs begin UTF-8 with it */
    line += 3;
  for (char *text = line; text;) {
    const char *word = next_word(&text);
    int at = 0;
    while (at < RAY_NUMBERS && strcasecmp(word, names[at]) != 0)
      at++;
    if (at == RAY_NUMBERS || has[at]) {
      cli_error("%s:1: %s column '%s'; expected the names ox,oy,oz,dx,dy,dz and perhaps begin,end", path,
                at < RAY_NUMBERS ? "a second" : "unknown", word);
      return 0;
    }
    has[at] = true;
    columns[count++] = at;
  }
  for (int k = 0; k < RAY_BEGIN; k++)
    if (!has[k]) {
      cli_error("%s:1: the column %s is missing; expected the names ox,oy,oz,dx,dy,dz and perhaps begin,end", path,
                names[k]);
      return 0;
    }
  return count;
}

/* A number; of the ends of a ray also an infinite one. */
static bool parse(const char *word, int at, double *value) {
  const bool negative = *word == '-';
  if (at < RAY_BEGIN || strcasecmp(word + (negative || *word == '+'), "inf") != 0)
    return cli_parse_number(word, value);
  *value = negative ? -INFINITY : INFINITY;
  return true;
}

static bool read_row(const char *path, long number, char *line, const int *columns, int count,
                     double ray[RAY_NUMBERS]) {
  char *text = line;
  set_defaults(ray);
  for (int i = 0; i < count; i++) {
    if (!text) {
      cli_error("%s:%ld: %d numbers instead of %d", path, number, i, count);
      return false;
    }
    const char *word = next_word(&text);
    if (!parse(word, columns[i], &ray[columns[i]])) {
      cli_error("%s:%ld: %s is '%s', not a number", path, number, names[columns[i]], word);
      return false;
    }
  }
  const char *fault = text ? "more numbers than the header has names" : fault_of(ray);
  if (fault)
    cli_error("%s:%ld: %s", path, number, fault);
  return !fault;
}

/* A ray more. */
static double *append(RayFile *file, int64_t *capacity) {
  if (file->count == *capacity) {
    *capacity = *capacity ? 2 * *capacity : 1024;
    file->rays = realloc(file->rays, (size_t)*capacity * sizeof *file->rays);
    if (!file->rays) {
      cli_error("out of memory");
      exit(CLI_FAILED);
    }
  }
  return file->rays[file->count++];
}

static bool read_csv(const char *path, FILE *stream, RayFile *file) {
  char *line = NULL;
  size_t size = 0;
  int columns[RAY_NUMBERS], count = 0;
  int64_t capacity = 0;
  bool fine = true;
  for (long number = 1; fine && getline(&line, &size, stream) >= 0; number++) {
    if (number == 1)
      fine = (count = read_header(path, line, columns)) > 0;
    else if (!is_blank(line))
      fine = read_row(path, number, line, columns, count, append(file, &capacity));
  }
  free(line);
  if (fine && count == 0) {
    cli_error("%s: is empty; expected a line with the names ox,oy,oz,dx,dy,dz and perhaps begin,end", path);
    return false;
  }
  return fine;
}

/* ── .npy ── */

/* Where the value of a key is in the header, NULL: nowhere. */
static const char *value_of(const char *header, const char *key) {
  const char *at = strstr(header, key);
  at = at ? strchr(at + strlen(key), ':') : NULL;
  return at ? at + 1 + strspn(at + 1, " ") : NULL;
}

/* The shape of an array of float64; false after a message. */
static bool read_shape(const char *path, const char *header, int64_t *rows, int *columns) {
  const char *type = value_of(header, "'descr'"), *order = value_of(header, "'fortran_order'"),
             *shape = value_of(header, "'shape'");
  if (!type || !order || !shape) {
    cli_error("%s: the header of the .npy file is damaged", path);
    return false;
  }
  if (strncmp(type, "'<f8'", 5) != 0) {
    cli_error("%s: the type of the array is %.*s; expected float64, '<f8'", path, (int)strcspn(type, ",}"), type);
    return false;
  }
  if (strncmp(order, "False", 5) != 0) {
    cli_error("%s: the array is in Fortran's order; expected that of C", path);
    return false;
  }
  long long n = -1;
  int k = 0, end = 0;
  if (sscanf(shape, "(%lld , %d %n", &n, &k, &end) != 2 || n < 0 || (k != RAY_BEGIN && k != RAY_NUMBERS) ||
      (shape[end] != ')' && strncmp(shape + end, ",)", 2) != 0)) {
    cli_error("%s: the shape of the array is %.*s; expected (n, 6) or (n, 8)", path, (int)strcspn(shape, ")") + 1,
              shape);
    return false;
  }
  *rows = n;
  *columns = k;
  return true;
}

static bool read_npy(const char *path, FILE *stream, RayFile *file) {
  unsigned char start[NPY_START];
  struct stat status;
  rewind(stream);
  if (fread(start, 1, sizeof start, stream) != sizeof start || memcmp(start, magic, sizeof magic) != 0) {
    cli_error("%s: is a .npy file of another version; expected 1.0", path);
    return false;
  }
  const size_t length = start[8] + 256 * (size_t)start[9];
  char *header = cli_allocate(length + 1);
  const size_t got = fread(header, 1, length, stream);
  header[got] = '\0';
  int64_t rows = 0;
  int columns = RAY_BEGIN;
  const bool fine = read_shape(path, header, &rows, &columns);
  free(header);
  if (!fine)
    return false;
  const int64_t begin = (int64_t)(NPY_START + length), row = columns * (int64_t)sizeof(double);
  if (fstat(fileno(stream), &status) != 0 || rows > (status.st_size - begin) / row) {
    cli_error("%s: is truncated: it has less than %lld rows", path, (long long)rows);
    return false;
  }
  file->rays = cli_allocate((size_t)(rows + 1) * sizeof *file->rays);
  for (; file->count < rows; file->count++) {
    double *ray = file->rays[file->count];
    set_defaults(ray);
    if (fread(ray, sizeof *ray, (size_t)columns, stream) != (size_t)columns) {
      cli_error("%s: cannot be read", path);
      return false;
    }
    const char *fault = fault_of(ray);
    if (fault) {
      cli_error("%s: row %lld: %s", path, (long long)file->count, fault);
      return false;
    }
  }
  return true;
}

/* ── both ── */

bool ray_file_read(const char *path, RayFile *file) {
  *file = (RayFile){0};
  FILE *stream = fopen(path, "rbe");
  struct stat status;
  if (!stream || fstat(fileno(stream), &status) != 0 || S_ISDIR(status.st_mode)) {
    cli_error("cannot read '%s': %s", path, strerror(stream ? EISDIR : errno));
    if (stream)
      fclose(stream);
    return false;
  }
  const int first = getc(stream);
  ungetc(first, stream);
  const bool fine = first == (unsigned char)magic[0] ? read_npy(path, stream, file) : read_csv(path, stream, file);
  fclose(stream);
  return fine;
}

void ray_file_release(RayFile *file) {
  free(file->rays);
  *file = (RayFile){0};
}

TetcastRays ray_file_rays(const RayFile *file) {
  TetcastRays rays = tetcast_rays_default();
  if (file->count == 0)
    return rays;
  TetcastArray *const arrays[] = {&rays.origins, &rays.directions, &rays.begins, &rays.ends};
  static const int at[] = {RAY_ORIGIN, RAY_DIRECTION, RAY_BEGIN, RAY_END};
  for (int i = 0; i < 4; i++)
    *arrays[i] = (TetcastArray){&file->rays[0][at[i]], TETCAST_TYPE_FLOAT64, file->count, sizeof *file->rays};
  return rays;
}

static bool ends_with(const char *path, const char *extension) {
  const size_t length = strlen(path), tail = strlen(extension);
  return length > tail && !strcasecmp(path + length - tail, extension);
}

bool ray_file_is_writable(const char *path) {
  return ends_with(path, ".csv") || ends_with(path, ".npy");
}

static void print_csv(FILE *out, const RayColumn *columns, int column_count, int64_t rays) {
  for (int c = 0; c < column_count; c++)
    fprintf(out, "%s%c", columns[c].name, c + 1 < column_count ? ',' : '\n');
  for (int64_t i = 0; i < rays; i++)
    for (int c = 0; c < column_count; c++)
      fprintf(out, "%.17g%c", columns[c].numbers[i * columns[c].stride], c + 1 < column_count ? ',' : '\n');
}

static void print_npy(FILE *out, const RayColumn *columns, int column_count, int64_t rays) {
  char *header =
      cli_print("{'descr': '<f8', 'fortran_order': False, 'shape': (%lld, %d), }", (long long)rays, column_count);
  const int length = (int)strlen(header), whole = NPY_START + length + 1,
            blanks = (NPY_ALIGNMENT - whole % NPY_ALIGNMENT) % NPY_ALIGNMENT, rest = length + blanks + 1;
  fwrite(magic, 1, sizeof magic, out);
  fputc(rest & 255, out);
  fputc(rest >> 8, out);
  fprintf(out, "%s%*s\n", header, blanks, "");
  free(header);
  for (int64_t i = 0; i < rays; i++)
    for (int c = 0; c < column_count; c++)
      fwrite(&columns[c].numbers[i * columns[c].stride], sizeof(double), 1, out);
}

bool ray_file_write(const char *path, const RayColumn *columns, int column_count, int64_t rays) {
  CliText *text = cli_text_begin();
  if (ends_with(path, ".npy"))
    print_npy(text->file, columns, column_count, rays);
  else
    print_csv(text->file, columns, column_count, rays);
  return cli_text_write(text, NULL, path);
}
