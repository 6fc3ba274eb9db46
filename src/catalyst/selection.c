/* SPDX-License-Identifier: Apache-2.0 */
/* Which array is drawn, by the rules that files have (tetcast/dataset.h). */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/cli.h"
#include "dataset.h"

double selection_length(const double *values, int count) {
  double sum = 0, largest = 0;
  for (int i = 0; i < count; i++) {
    sum += values[i] * values[i];
    largest = fmax(largest, fabs(values[i]));
  }
  if ((sum > 1e-280 && sum < 1e280) || largest == 0 || !isfinite(largest))
    return sqrt(sum);
  sum = 0; /* the squares' sum is out of range: again with scaled numbers */
  for (int i = 0; i < count; i++)
    sum += (values[i] / largest) * (values[i] / largest);
  return largest * sqrt(sum);
}

double selection_value(const Selection *selection, int64_t i) {
  const Column *column = selection->column;
  if (selection->component != SELECTION_MAGNITUDE)
    return view_value(&column->component[selection->component], i);
  double few[9] = {0},
         *values = column->components > 9 ? cli_allocate(sizeof *values * (size_t)column->components) : few;
  for (int k = 0; k < column->components; k++)
    values[k] = view_value(&column->component[k], i);
  const double length = selection_length(values, column->components);
  if (values != few)
    free(values);
  return length;
}

/* ── the array that is drawn if none is named ── */

/* Whether the numbers that would be drawn differ from each other. */
static bool varies(const TetcastDataset *dataset, const Column *column) {
  const Selection selection = {.column = column, .component = column->components == 1 ? 0 : SELECTION_MAGNITUDE};
  const TetcastArray sources = dataset->cut ? tetcast_cut_sources(dataset->cut) : (TetcastArray){.data = NULL};
  const int32_t *cells = column->association == TETCAST_CELL ? sources.data : NULL;
  const int64_t count = cells ? sources.count : column->component[0].count;
  double first = (double)NAN;
  for (int64_t i = 0; i < count; i++) {
    const double value = selection_value(&selection, cells ? cells[i] : i);
    if (!isfinite(value))
      continue;
    if (isnan(first))
      first = value;
    if (value != first)
      return true;
  }
  return false;
}

static bool numbers_things(const Column *column) {
  return column->numbers || !strcmp(column->name, "vtkOriginalPointIds") || !strcmp(column->name, "vtkOriginalCellIds");
}

static const Column *default_column(const TetcastDataset *dataset) {
  const Column *best = NULL;
  int best_rank = 0;
  for (int i = 0; i < dataset->part.column_count; i++) {
    const Column *column = &dataset->part.columns[i];
    if (column->fault)
      continue;
    if (column->active && column->components == 1)
      return column;
    const bool things = numbers_things(column), shows = !things && varies(dataset, column);
    const int rank =
        1 + 8 * !things + 4 * shows + 2 * (column->association == TETCAST_POINT) + (column->components == 1);
    if (rank > best_rank) {
      best = column;
      best_rank = rank;
    }
  }
  return best;
}

/* ── the one that is named ── */

typedef struct Suffixes {
  char association, component[64]; /* 'p' or 'c', and the text; zeros: nothing is said */
} Suffixes;

static const Column *find_column(const TetcastDataset *dataset, const char *name, char association) {
  for (int i = 0; i < dataset->part.column_count; i++) { /* those of points come first */
    const Column *column = &dataset->part.columns[i];
    if (!strcmp(column->name, name) && (!association || (association == 'c') == (column->association == TETCAST_CELL)))
      return column;
  }
  return NULL;
}

/* The array with the longest name that the selector begins with, and what the selector says behind the name. */
static const Column *find_named(const TetcastDataset *dataset, const char *selector, Suffixes *suffixes) {
  char *name = cli_duplicate(selector);
  const Column *column;
  while (!(column = find_column(dataset, name, suffixes->association))) {
    char *colon = strrchr(name, ':');
    if (!colon)
      break;
    const char *suffix = colon + 1;
    if ((!strcmp(suffix, "point") || !strcmp(suffix, "cell")) && !suffixes->association)
      suffixes->association = *suffix;
    else if (!*suffixes->component && *suffix && strlen(suffix) < sizeof suffixes->component)
      strcpy(suffixes->component, suffix);
    else
      break;
    *colon = '\0';
  }
  free(name);
  return column;
}

static TetcastStatus refuse(const TetcastDataset *dataset, const char *selector) {
  char *list = cli_duplicate("");
  const Column *bad = NULL;
  for (int i = 0; i < dataset->part.column_count; i++) {
    const Column *column = &dataset->part.columns[i];
    bad = column->fault && !bad ? column : bad;
    char *longer = cli_print("%s%s%s%s", list, *list ? ", " : "", column->name,
                             column->fault                         ? " (can't be drawn)"
                             : column->association == TETCAST_CELL ? " (element)"
                                                                   : "");
    free(list);
    list = longer;
  }
  /* by the context, so that the stage may say more of it: its messages are about the mesh */
  const TetcastStatus status = TETCAST_ERROR_ARGUMENT;
  if (!*list)
    tetcast_context_error(dataset->context, status, "has no fields of topology '%s'", dataset->part.topology_name);
  else if (!selector)
    tetcast_context_error(dataset->context, status, "fields/%s: %s", bad->name, bad->fault);
  else
    tetcast_context_error(dataset->context, status, "has no field '%s'; there are: %s", selector, list);
  free(list);
  return status;
}

/* What components are called, NULL: they have numbers only. */
static const char *component_name(const Column *column, int k) {
  static const char *const two[] = {"x", "y"}, *const three[] = {"x", "y", "z"}, *const six[] = {"xx", "yy", "zz",
                                                                                                 "xy", "yz", "xz"},
                           *const nine[] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  if (column->names)
    return column->names[k];
  const int n = column->components;
  return n == 2 ? two[k] : n == 3 ? three[k] : n == 6 ? six[k] : n == 9 ? nine[k] : NULL;
}

static bool find_component(const TetcastDataset *dataset, const Column *column, const char *part, int *component) {
  *component = SELECTION_MAGNITUDE;
  if (!strcmp(part, "mag"))
    return true;
  if (strlen(part) < 9 && part[strspn(part, "0123456789")] == '\0' && atoi(part) < column->components) {
    *component = atoi(part);
    return true;
  }
  char *list = cli_duplicate("");
  for (int k = 0; k < column->components; k++) {
    const char *name = component_name(column, k);
    if (!name)
      continue;
    if (!strcasecmp(name, part)) {
      *component = k;
      free(list);
      return true;
    }
    char *longer = cli_print("%s, %s", list, name);
    free(list);
    list = longer;
  }
  cli_error("%s/fields/%s: has no component '%s'; there are: 0 to %d%s and mag", dataset->path, column->name, part,
            column->components - 1, list);
  free(list);
  return false;
}

TetcastStatus selection_find(const TetcastDataset *dataset, const char *selector, Selection *selection) {
  Suffixes suffixes = {0};
  *selection = (Selection){.component = SELECTION_MAGNITUDE, .whole = true};
  const Column *column = selector ? find_named(dataset, selector, &suffixes) : default_column(dataset);
  if (!column)
    return refuse(dataset, selector);
  if (column->fault) {
    cli_error("%s/fields/%s: %s", dataset->path, column->name, column->fault);
    return TETCAST_ERROR_DATA;
  }
  selection->column = column;
  selection->whole = !*suffixes.component;
  if (!selection->whole)
    return find_component(dataset, column, suffixes.component, &selection->component) ? TETCAST_OK
                                                                                      : TETCAST_ERROR_ARGUMENT;
  if (column->components == 1)
    selection->component = 0;
  return TETCAST_OK;
}
