/* SPDX-License-Identifier: Apache-2.0 */
#include "preset_name.h"

#include <string.h>
#include <strings.h>

#include "cli.h"

/* Where FILE ends in FILE or FILE:NAME; 0: it is neither. */
static size_t path_length(const char *preset) {
  static const char *const extensions[] = {".json", ".xml"};
  for (size_t at = 0; preset[at]; at++)
    for (int i = 0; i < 2; i++) {
      const size_t length = strlen(extensions[i]);
      if (!strncasecmp(preset + at, extensions[i], length) && (!preset[at + length] || preset[at + length] == ':'))
        return at + length;
    }
  return 0;
}

bool preset_name_is_file(const char *preset) {
  return path_length(preset) > 0;
}

char *preset_name_path(const char *preset) {
  return cli_print("%.*s", (int)path_length(preset), preset);
}
