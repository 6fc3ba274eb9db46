/* SPDX-License-Identifier: Apache-2.0 */
#include "fileset.h"

#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "preset_name.h"

void fileset_add(FileSet *set, const char *what, const char *path, bool written) {
  if (!path)
    return;
  set->entries = cli_grow(set->entries, set->count, &set->capacity, sizeof *set->entries);
  set->entries[set->count++] = (FileSetEntry){what, cli_duplicate(path), cli_file_identify(path), written};
}

void fileset_add_options(FileSet *set, const RenderOptions *options) {
  fileset_add(set, "the input", options->input, false);
  for (int i = 1; i < options->input_count; i++)
    fileset_add(set, "the input", options->inputs[i], false);
  fileset_add(set, "--scene", options->scene, false);
  fileset_add(set, "--transfer", options->transfer_object ? NULL : options->transfer, false);
  char *preset = preset_name_is_file(render_options_preset(options)) ? preset_name_path(options->preset) : NULL;
  fileset_add(set, "--preset", preset, false);
  free(preset);
  fileset_add(set, "--stop-depth", options->stop_depth, false);
  fileset_add(set, "--stats", options->stats, true);
  fileset_add(set, "--save-scene", options->save_scene, true);
  fileset_add(set, "--rays", options->rays, false);
  fileset_add(set, "--matrix", options->matrix, true);
}

/* Brings those that are the same next to each other. */
static int order(const void *a, const void *b) {
  const CliFile *x = &((const FileSetEntry *)a)->file, *y = &((const FileSetEntry *)b)->file;
  if (x->exists != y->exists)
    return x->exists ? -1 : 1;
  if (!x->exists)
    return strcmp(x->path ? x->path : "", y->path ? y->path : "");
  if (x->device != y->device)
    return x->device < y->device ? -1 : 1;
  return (x->number > y->number) - (x->number < y->number);
}

static int complain(const char *command, const FileSetEntry *a, const FileSetEntry *b) {
  const FileSetEntry *written = a->written ? a : b, *other = a->written ? b : a;
  if (!strcmp(written->what, other->what))
    return cli_usage_error(command, "two of the pictures are the same file, '%s': -o names them otherwise",
                           written->name);
  if (other->written)
    return cli_usage_error(command, "%s and %s are the same file, '%s'", written->what, other->what, written->name);
  return cli_usage_error(command, "%s '%s' would replace %s, '%s'", written->what, written->name, other->what,
                         other->name);
}

int fileset_check(FileSet *set, const char *command) {
  int code = -1;
  if (set->count > 0)
    qsort(set->entries, (size_t)set->count, sizeof *set->entries, order);
  for (int i = 0; i < set->count && code < 0; i++) /* inputs may be the same, however many */
    for (int j = i + 1; j < set->count && code < 0 && cli_file_same(&set->entries[i].file, &set->entries[j].file); j++)
      if (set->entries[i].written || set->entries[j].written)
        code = complain(command, &set->entries[i], &set->entries[j]);
  for (int i = 0; i < set->count; i++) {
    cli_file_forget(&set->entries[i].file);
    free(set->entries[i].name);
  }
  free(set->entries);
  *set = (FileSet){0};
  return code;
}
