// SPDX-License-Identifier: Apache-2.0
// A context that keeps what it was told, and a folder of the test's own.
#pragma once

#include <filesystem>
#include <string>

#include <stdlib.h>

#include <tetcast/tetcast.h>

static TetcastContext *context;
[[maybe_unused]] static std::string last_error, last_warning;
static std::filesystem::path folder;

static void remember(void *, TetcastSeverity severity, const char *text) {
  (severity == TETCAST_SEVERITY_ERROR ? last_error : last_warning) = text;
}

static int setup(void **) {
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.message = remember;
  char name[] = "/tmp/tetcast-images-XXXXXX";
  if (tetcast_context_create(&desc, &context) != TETCAST_OK || !mkdtemp(name))
    return 1;
  folder = name;
  return 0;
}

static int teardown(void **) {
  tetcast_context_destroy(&context);
  std::filesystem::remove_all(folder);
  return 0;
}
