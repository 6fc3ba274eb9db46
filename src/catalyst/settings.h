/* SPDX-License-Identifier: Apache-2.0 */
/* What the node of initialize says under catalyst/tetcast. */
#ifndef TETCAST_CATALYST_SETTINGS_H
#define TETCAST_CATALYST_SETTINGS_H

#include "cli/render_options.h"
#include "conduit.h"

typedef struct Settings {
  RenderOptions options;
  char *channel, *topology; /* NULL: the first */
  int64_t every;            /* a picture of each step whose number this divides */
} Settings;

/* False after a message. Either way it is to be released. */
bool settings_read(Settings *settings, const ConduitNode *params);
void settings_release(Settings *settings);

#endif
