/* SPDX-License-Identifier: Apache-2.0 */
/* The table of options, for what sets them and for what reads the command line. */
#ifndef TETCAST_CLI_RENDER_TABLE_H
#define TETCAST_CLI_RENDER_TABLE_H

#include <stddef.h>

#include "render_options.h"

typedef enum OptionKind { KIND_TEXT, KIND_PATH, KIND_NUMBERS, KIND_INTEGERS, KIND_CHOICE, KIND_FLAG } OptionKind;

#define BIT(id)    (UINT64_C(1) << (id))
#define AT(member) offsetof(RenderOptions, member)

typedef struct RenderRow {
  const char *name;
  OptionKind kind;
  size_t at;                /* where the value goes in RenderOptions */
  int least, most;          /* how many numbers */
  double low, high;         /* bounds of each */
  const char *const *names; /* of a choice */
  uint64_t excludes;
  RenderCommand only; /* of this command alone, 0: of both */
  const char *form;   /* what is expected */
} RenderRow;

extern const RenderRow render_table[OPTION_COUNT];

bool render_option_of_command(OptionId id, RenderCommand command);

/* What the name of a picture ends with. */
bool render_option_has_extension(const char *path, const char *extension);
bool render_option_is_tiff(const char *path);

/* Whether --groups is given and says yes. */
bool render_options_groups(const RenderOptions *options);

#endif
