/* SPDX-License-Identifier: Apache-2.0 */
#include "completion.h"

#include <getopt.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

int completion_of_words(const struct option *words, CompletionOption list[COMPLETION_OPTIONS]) {
  int count = 0;
  for (; words->name && count < COMPLETION_OPTIONS; words++) {
    const bool output = !strcmp(words->name, "output");
    list[count++] = (CompletionOption){.name = words->name,
                                       .letter = output                        ? 'o'
                                                 : strcmp(words->name, "help") ? '\0'
                                                                               : 'h',
                                       .kind = output           ? COMPLETION_PATH
                                               : words->has_arg ? COMPLETION_VALUE
                                                                : COMPLETION_FLAG};
  }
  return count;
}

const char *const *completion_words(const char *(*name)(int i), const char *words[COMPLETION_WORDS]) {
  int count = 0;
  for (; count < COMPLETION_WORDS - 1 && name(count); count++)
    words[count] = name(count);
  words[count] = NULL;
  return words;
}
