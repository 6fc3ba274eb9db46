/* SPDX-License-Identifier: Apache-2.0 */
/* What shells complete: each command states its options from the table that it parses them by. */
#ifndef TETCAST_CLI_COMPLETION_H
#define TETCAST_CLI_COMPLETION_H

struct option;

typedef enum CompletionKind {
  COMPLETION_FLAG,  /* takes no value */
  COMPLETION_VALUE, /* a value of which nothing is known */
  COMPLETION_PATH   /* the path of a file or folder, or one of the words if there are any */
} CompletionKind;

typedef struct CompletionOption {
  const char *name; /* long, without dashes */
  char letter;      /* short, 0: none */
  CompletionKind kind;
  const char *const *words; /* of a value some that it may have, NULL at the end; NULL: none are known */
} CompletionOption;

enum { COMPLETION_OPTIONS = 128 /* of a command, at most */, COMPLETION_WORDS = 64 };

/* The options of each command; how many there are. */
int completion_of_render(CompletionOption list[COMPLETION_OPTIONS]);
int completion_of_transfer(CompletionOption list[COMPLETION_OPTIONS]);
int completion_of_converge(CompletionOption list[COMPLETION_OPTIONS]);
int completion_of_cast(CompletionOption list[COMPLETION_OPTIONS]);
int completion_of_info(CompletionOption list[COMPLETION_OPTIONS]);
int completion_of_mesh(CompletionOption list[COMPLETION_OPTIONS]);

/* What getopt_long() is given, as options without words; values are paths where the name is "output". */
int completion_of_words(const struct option *words, CompletionOption list[COMPLETION_OPTIONS]);

/* A list of words from a function that names word i = 0, 1, …; `words` has static storage and is returned. */
const char *const *completion_words(const char *(*name)(int i), const char *words[COMPLETION_WORDS]);

#endif
