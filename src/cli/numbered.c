/* SPDX-License-Identifier: Apache-2.0 */
#include "numbered.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

static const char digits[] = "0123456789";

/* A path, and where its number lies in it. */
typedef struct Numbered {
  char *path;
  const char *number;
  size_t whole, fraction; /* how many digits: before a point, and with the point behind them */
} Numbered;

/* How much all paths have in common at their starts, without the number that they part in. */
static size_t common_start(char **paths, int count) {
  size_t length = strlen(paths[0]);
  for (int i = 1; i < count; i++)
    for (size_t k = 0; k < length; k++)
      if (paths[i][k] != paths[0][k])
        length = k;
  while (length > 0 && isdigit((unsigned char)paths[0][length - 1]))
    length--;
  const bool part = length > 1 && paths[0][length - 1] == '.' && paths[0][length - 2] == '0' &&
                    (length == 2 || !isdigit((unsigned char)paths[0][length - 3])); /* "0.", of a fraction */
  return part ? length - 2 : length;
}

/* The number at `start`; false: there is none, or what comes behind it is not `rest`. */
static bool read_number(char *path, size_t start, const char *rest, Numbered *numbered) {
  const char *number = path + start;
  const size_t whole = strspn(number, digits);
  size_t fraction = number[whole] == '.' ? strspn(number + whole + 1, digits) : 0;
  if (fraction > 0)
    fraction++;
  *numbered = (Numbered){path, number, whole, fraction};
  return whole > 0 && (!rest || !strcmp(number + whole + fraction, rest));
}

/* As numbers, however long they are. */
static int order(const void *a, const void *b) {
  const Numbered *x = a, *y = b;
  const char *m = x->number, *n = y->number;
  size_t i = x->whole, j = y->whole;
  for (; i > 1 && *m == '0'; i--)
    m++;
  for (; j > 1 && *n == '0'; j--)
    n++;
  if (i != j)
    return i < j ? -1 : 1;
  const int whole = strncmp(m, n, i);
  if (whole)
    return whole;
  const size_t shorter = x->fraction < y->fraction ? x->fraction : y->fraction;
  const int fraction = strncmp(x->number + x->whole, y->number + y->whole, shorter);
  if (fraction)
    return fraction;
  return x->fraction != y->fraction ? (x->fraction < y->fraction ? -1 : 1) : strcmp(x->path, y->path);
}

bool numbered_sort(char **paths, int count) {
  const size_t start = common_start(paths, count);
  Numbered *list = cli_allocate(sizeof *list * (size_t)count);
  bool fine = read_number(paths[0], start, NULL, &list[0]);
  const char *rest = paths[0] + start + list[0].whole + list[0].fraction;
  for (int i = 1; i < count && fine; i++)
    fine = read_number(paths[i], start, rest, &list[i]);
  if (fine)
    qsort(list, (size_t)count, sizeof *list, order);
  for (int i = 1; i < count && fine; i++)
    fine = strcmp(list[i - 1].path, list[i].path) != 0;
  for (int i = 0; i < count && fine; i++)
    paths[i] = list[i].path;
  free(list);
  return fine;
}
