/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fuzz.h"

static char folder[256], path[512];

static void remove_folder(void) {
  char command[300];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  if (system(command) != 0)
    fputs("the folder of the fuzz target stays\n", stderr);
}

const char *fuzz_file(const char *name, const void *data, size_t size) {
  if (!*folder) {
    const char *temporary = getenv("TMPDIR");
    if (!temporary)
      temporary = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(folder, sizeof folder, "%s/tetcast-fuzz-XXXXXX", temporary);
    if (!mkdtemp(folder))
      abort();
    atexit(remove_folder);
  }
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "wb");
  if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
    abort();
  return path;
}
