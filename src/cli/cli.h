/* SPDX-License-Identifier: Apache-2.0 */
/* What the commands share: messages, exit codes, strict parsing of arguments. The command uses libtetcast's public
 * headers only. */
#ifndef TETCAST_CLI_H
#define TETCAST_CLI_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>

#include <tetcast/context.h>

enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_USAGE = 2 }; /* exit codes; 128 + signal when interrupted */

/* The commands: argv[0] is the command's name, getopt's global state is fresh; they return the exit code. */
int tetcast_cli_render(int argc, char **argv);
int tetcast_cli_converge(int argc, char **argv);
int tetcast_cli_transfer(int argc, char **argv);
int tetcast_cli_cast(int argc, char **argv);
int tetcast_cli_info(int argc, char **argv);
int tetcast_cli_mesh(int argc, char **argv);
int tetcast_cli_completion(int argc, char **argv);

/* One line on stderr, "tetcast: error: …", "tetcast: warning: …" or "tetcast: note: …", which says what was chosen
 * where nothing was said. Only the first error of a run is shown, and none after an interruption; warnings and notes
 * are dropped after cli_set_quiet(true). */
void cli_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void cli_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));
void cli_note(const char *format, ...) __attribute__((format(printf, 1, 2)));
void cli_set_quiet(bool quiet);

/* Makes errors of warnings from here on. A step that may have given one ends with `return cli_verdict(CLI_DONE)`, which
 * is CLI_FAILED if it has, else the code it is given. */
void cli_set_strict(bool strict);
int cli_verdict(int code);

/* Shows only the first of warnings that are the same but for numbers from here on: for work that does the same many
 * times. */
void cli_warn_once(void);
bool cli_quiet(void);

/* Makes the process one of several that run the same command line. What number 0 says the others don't say as well: of
 * them, only what is about their share of the work is shown, with "rank N: " before it, which is what comes between
 * cli_set_apart(true) and (false). */
void cli_set_rank(int rank);
void cli_set_apart(bool apart);
int cli_rank(void);

/* Whether an error has been shown. */
bool cli_said(void);

/* Makes warnings of errors from here on, until it is called with false: for what one can do without. */
void cli_set_lenient(bool lenient);

/* While a thread holds them, messages of the others are kept, to be shown when it lets go. */
void cli_messages_hold(bool hold);

/* Lets the next error be shown though there was one: for a process that goes on after errors. */
void cli_forget_errors(void);

/* Puts "PLACE: " before the library's errors on this thread (NULL: nothing): for calls whose arguments came from a
 * file.
 */
void cli_set_place(const char *place);

/* Puts `hint` behind the library's errors (NULL: nothing): what may have been meant. */
void cli_set_hint(const char *hint);

/* An error in the way the command was called; names the command's --help and returns CLI_USAGE. */
int cli_usage_error(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The message for the option that getopt_long() refused by returning '?' or ':' (with opterr = 0 and an option string
 * that starts with ':'), with the nearest of those that there are; returns CLI_USAGE. */
struct option;
int cli_bad_option(const char *command, int result, int argc, char **argv, const struct option *words);

/* What somebody who misspelt `word` may have meant: of the names given to cli_guess() the nearest, by the number of
 * letters to be changed, added, left out or exchanged with the next. */
typedef struct CliGuess {
  const char *word;
  const char *best; /* NULL: none is near */
  size_t distance;
} CliGuess;

void cli_guess(CliGuess *guess, const char *name);

/* "; did you mean 'best'?", or "" if none is near; for free(). */
char *cli_guess_text(const CliGuess *guess);

/* A context whose messages go to stderr as above, or NULL after a message. threads 0: all processors. */
TetcastContext *cli_context_create(int threads);

/* The exit code for a status that is not TETCAST_OK; says what it is if the library has not. */
int cli_failed(TetcastStatus status);

/* Whether all of `text` is a finite decimal number. No blanks, no "inf", no hexadecimal; independent of the locale. */
bool cli_parse_number(const char *text, double *value);

/* Numbers with `separator` between them, e.g. "1,2,3": how many there are, or 0 if the text is anything else or has
 * more than `most`. */
int cli_parse_numbers(const char *text, char separator, int most, double *values);

/* Ends the process, or what stands for it where pictures are made inside another program (src/catalyst), with a
 * message.
 */
void cli_out_of_memory(void) __attribute__((noreturn));

/* malloc(), strdup() and asprintf() that end so when there is no memory. */
void *cli_allocate(size_t size);
char *cli_duplicate(const char *text);

/* An array of elements of this size with room for one more than its `count`: `data` itself, or what takes its place. */
void *cli_grow(void *data, int count, int *capacity, size_t size);
char *cli_print(const char *format, ...) __attribute__((format(printf, 1, 2)));
char *cli_print_list(const char *format, va_list list);

/* The seconds of a clock that only goes forward. */
double cli_seconds(void);

/* Flushes standard output; CLI_DONE, or CLI_FAILED after a message if something could not be written. */
int cli_finish_output(void);

#endif
