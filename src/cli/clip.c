/* SPDX-License-Identifier: Apache-2.0 */
#include "clip.h"

#include <stdlib.h>

#include "cli.h"

const char *clip_add_all(RenderOptions *options, const json_t *json) {
  const bool list = json_is_array(json_array_get(json, 0));
  const char *reason = NULL;
  for (size_t i = 0; (list ? i < json_array_size(json) : i == 0) && !reason; i++) {
    OptionValue value = {.text = NULL};
    value.count = cli_json_numbers(list ? json_array_get(json, i) : json, 4, value.numbers);
    reason = render_options_set(options, OPTION_CLIP, &value);
  }
  return reason;
}

TetcastHalfSpace *clip_half_spaces(const RenderOptions *options, int *count) {
  const int planes = render_options_given(options, OPTION_CLIP) ? options->clip_count : 0;
  *count = planes + (render_options_given(options, OPTION_CLIP_BOX) ? 6 : 0);
  if (*count == 0)
    return NULL;
  TetcastHalfSpace *all = cli_allocate(sizeof *all * (size_t)*count);
  for (int i = 0; i < planes; i++)
    all[i] = options->clip[i];
  for (int i = planes; i < *count; i++) {
    const int side = i - planes;
    const double sign = side % 2 ? -1 : 1;
    all[i] = (TetcastHalfSpace){.offset = sign * options->clip_box[side]};
    all[i].normal[side / 2] = sign;
  }
  return all;
}

TetcastStatus clip_scene(TetcastScene *scene, const RenderOptions *options) {
  int count;
  TetcastHalfSpace *all = clip_half_spaces(options, &count);
  const TetcastStatus status = tetcast_scene_set_clip(scene, all, count);
  free(all);
  return status;
}

void clip_write(const RenderOptions *options, json_t *scene) {
  if (render_options_given(options, OPTION_CLIP)) {
    json_t *list = json_array();
    for (int i = 0; i < options->clip_count; i++) {
      const TetcastHalfSpace *h = &options->clip[i];
      const double row[4] = {h->normal[0], h->normal[1], h->normal[2], h->offset};
      json_array_append_new(list, cli_json_array(row, 4));
    }
    json_object_set_new(scene, "clip", list);
  }
  if (render_options_given(options, OPTION_CLIP_BOX))
    json_object_set_new(scene, "clip_box", cli_json_array(options->clip_box, 6));
}
