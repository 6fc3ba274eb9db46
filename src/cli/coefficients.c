/* SPDX-License-Identifier: Apache-2.0 */
#include "coefficients.h"

#include <stdlib.h>
#include <string.h>

#include "adapter.h"
#include "cli.h"

/* Whether the selector is of the array as a whole: its name, perhaps with the word for where it is. */
static bool names_all_of(const char *selector, const TetcastDatasetArray *array) {
  const size_t length = strlen(array->name);
  const char *where = array->association == TETCAST_CELL ? ":cell" : ":point";
  return !strncmp(selector, array->name, length) && (!selector[length] || !strcmp(selector + length, where));
}

/* How many components the array has that is named like this as a whole; 1 for anything else, e.g. one component of it.
 */
static int components_of(const TetcastDataset *dataset, const char *selector) {
  TetcastDatasetArray array;
  for (int i = 0; cli_vtk()->dataset_array(dataset, i, &array); i++)
    if (names_all_of(selector, &array))
      return array.components;
  return 1;
}

static bool check_count(const char *option, const char *selector, int count, const RenderOptions *options) {
  if (count > TETCAST_MAX_GROUPS) {
    cli_error("--%s: array '%s' has %d components, more than the %d groups that are possible", option, selector, count,
              TETCAST_MAX_GROUPS);
    return false;
  }
  const bool color = count == 3 && !strcmp(option, "emission");
  if (count == 1 || color || render_options_given(options, OPTION_GROUPS))
    return true;
  cli_error("--%s: array '%s' has %d components; choose one, '%s:0', or the magnitude, '%s:mag', or take each as a "
            "group, --groups",
            option, selector, count, selector, selector);
  return false;
}

/* Reads the array's components as fields and counts their values that are not finite. */
static bool read_array(const TetcastDataset *dataset, const RenderOptions *options, const char *option,
                       const char *selector, TetcastField **fields, int *count) {
  const int components = components_of(dataset, selector);
  if (!check_count(option, selector, components, options))
    return false;
  int64_t nonfinite = 0;
  for (*count = 0; *count < components; ++*count) {
    char *name = components == 1 ? cli_duplicate(selector) : cli_print("%s:%d", selector, *count);
    const TetcastStatus status = cli_vtk()->dataset_field(dataset, name, &fields[*count], NULL);
    free(name);
    if (status != TETCAST_OK)
      return false;
    int64_t here;
    tetcast_field_range(fields[*count], NULL, &here);
    nonfinite += here;
  }
  if (nonfinite > 0)
    cli_warning("array %s: %lld values are NaN or infinite; the cells they touch are transparent", selector,
                (long long)nonfinite);
  return true;
}

bool coefficients_read(const TetcastDataset *dataset, const RenderOptions *options, Coefficients *c) {
  return (!render_options_given(options, OPTION_EXTINCTION) ||
          read_array(dataset, options, "extinction", options->extinction, c->extinction, &c->extinction_count)) &&
         (!render_options_given(options, OPTION_EMISSION) ||
          read_array(dataset, options, "emission", options->emission, c->emission, &c->emission_count));
}

TetcastStatus coefficients_set(TetcastScene *scene, const RenderOptions *options, const Coefficients *c) {
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = (const TetcastField *const *)c->extinction;
  desc.emission = (const TetcastField *const *)c->emission;
  desc.extinction_count = c->extinction_count;
  desc.emission_count = c->emission_count;
  char *extinction = cli_print("array %s", options->extinction ? options->extinction : "");
  char *emission = cli_print("array %s", options->emission ? options->emission : "");
  desc.extinction_name = extinction;
  desc.emission_name = emission;
  const TetcastStatus status = tetcast_scene_set_coefficients(scene, &desc);
  free(extinction);
  free(emission);
  return status;
}

void coefficients_release(Coefficients *c) {
  for (; c->extinction_count > 0; --c->extinction_count)
    tetcast_field_destroy(&c->extinction[c->extinction_count - 1]);
  for (; c->emission_count > 0; --c->emission_count)
    tetcast_field_destroy(&c->emission[c->emission_count - 1]);
}
