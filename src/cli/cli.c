/* SPDX-License-Identifier: Apache-2.0 */
#include "cli.h"

#include <ctype.h>
#include <getopt.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

char *cli_print_list(const char *format, va_list list) {
  char *text = NULL;
  if (vasprintf(&text, format, list) < 0)
    cli_out_of_memory();
  return text;
}

char *cli_print(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = cli_print_list(format, list);
  va_end(list);
  return text;
}

int cli_usage_error(const char *command, const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = cli_print_list(format, list);
  va_end(list);
  cli_error("%s (see tetcast %s%s--help)", text, command, *command ? " " : "");
  free(text);
  return CLI_USAGE;
}

/* The number of letters to be changed, added, left out or exchanged with the next, whatever their case. */
static size_t distance_between(const char *a, const char *b) {
  const size_t m = strlen(a), n = strlen(b), width = n + 1;
  size_t *d = cli_allocate(sizeof *d * (m + 1) * width);
  for (size_t i = 0; i <= m; i++)
    for (size_t j = 0; j <= n; j++) {
      if (i == 0 || j == 0) {
        d[i * width + j] = i + j;
        continue;
      }
      const int x = tolower((unsigned char)a[i - 1]), y = tolower((unsigned char)b[j - 1]);
      size_t least = d[(i - 1) * width + j - 1] + (x != y);
      if (d[(i - 1) * width + j] + 1 < least)
        least = d[(i - 1) * width + j] + 1;
      if (d[i * width + j - 1] + 1 < least)
        least = d[i * width + j - 1] + 1;
      if (i > 1 && j > 1 && x == tolower((unsigned char)b[j - 2]) && y == tolower((unsigned char)a[i - 2]) &&
          d[(i - 2) * width + j - 2] + 1 < least)
        least = d[(i - 2) * width + j - 2] + 1;
      d[i * width + j] = least;
    }
  const size_t result = d[m * width + n];
  free(d);
  return result;
}

void cli_guess(CliGuess *guess, const char *name) {
  const size_t length = strlen(guess->word), other = strlen(name), most = 200; /* of what is a word at all */
  if (length == 0 || other == 0 || length > most || other > most)
    return;
  const size_t distance = distance_between(guess->word, name), near = (length > other ? length : other) / 3;
  /* Words of a few letters are near to everything, so they have to begin with the same letter. */
  const bool like =
      distance <= near || (distance == 1 && tolower((unsigned char)*guess->word) == tolower((unsigned char)*name));
  if (like && (!guess->best || distance < guess->distance)) {
    guess->best = name;
    guess->distance = distance;
  }
}

char *cli_guess_text(const CliGuess *guess) {
  return guess->best ? cli_print("; did you mean '%s'?", guess->best) : cli_duplicate("");
}

/* `name` without dashes, as a message about it. */
static int unknown_option(const char *command, const char *shown, int length, const char *name,
                          const struct option *words) {
  char *word = cli_print("%.*s", (int)strcspn(name, "="), name);
  CliGuess guess = {.word = word};
  for (; words->name; words++)
    cli_guess(&guess, words->name);
  char *hint = guess.best ? cli_print("; did you mean --%s?", guess.best) : cli_duplicate("");
  const int code = cli_usage_error(command, "unknown or ambiguous option %.*s%s", length, shown, hint);
  free(hint);
  free(word);
  return code;
}

int cli_bad_option(const char *command, int result, int argc, char **argv, const struct option *words) {
  const char *option = argv[optind - 1];
  if (optopt > 0 && optopt < 128 && optind < argc && argv[optind][0] == '-' && argv[optind][1] == optopt)
    option = argv[optind]; /* the first letter of several */
  if (optopt > 0 && optopt < 128 && option[1] != '-') {
    if (result == ':')
      return cli_usage_error(command, "option -%c needs an argument", optopt);
    if (option[0] == '-' && option[1] && option[2]) /* a long option with one dash */
      return unknown_option(command, option, (int)strlen(option), option + 1, words);
    return cli_usage_error(command, "unknown option -%c", optopt);
  }
  const int length = (int)strcspn(option, "=");
  if (result == ':')
    return cli_usage_error(command, "option %s needs an argument", option);
  if (optopt != 0)
    return cli_usage_error(command, "option %.*s takes no argument", length, option);
  return unknown_option(command, option, length, option + 2, words);
}

bool cli_parse_number(const char *text, double *value) {
  if (!*text || text[strspn(text, "+-.0123456789eE")])
    return false;
  char *end;
  *value = strtod(text, &end);
  return *end == '\0' && isfinite(*value);
}

int cli_parse_numbers(const char *text, char separator, int most, double *values) {
  const char separators[] = {separator, '\0'};
  for (int count = 0; count < most;) {
    char item[64];
    const size_t length = strcspn(text, separators);
    if (length >= sizeof item)
      return 0;
    memcpy(item, text, length);
    item[length] = '\0';
    if (!cli_parse_number(item, &values[count++]))
      return 0;
    if (!text[length])
      return count;
    text += length + 1;
  }
  return 0;
}

void *cli_allocate(size_t size) {
  void *memory = malloc(size ? size : 1);
  if (!memory)
    cli_out_of_memory();
  return memory;
}

void *cli_grow(void *data, int count, int *capacity, size_t size) {
  if (count < *capacity)
    return data;
  *capacity = *capacity ? 2 * *capacity : 128;
  void *more = cli_allocate(size * (size_t)*capacity);
  if (count)
    memcpy(more, data, size * (size_t)count);
  free(data);
  return more;
}

char *cli_duplicate(const char *text) {
  const size_t size = strlen(text) + 1;
  return memcpy(cli_allocate(size), text, size);
}

double cli_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int cli_finish_output(void) {
  if (fflush(stdout) == 0 && !ferror(stdout))
    return CLI_DONE;
  struct pollfd end = {.fd = STDOUT_FILENO};
  if (poll(&end, 1, 0) > 0 && end.revents & POLLERR) /* as with "| head", the reader wants no more, which is no fault */
    return 128 + SIGPIPE;
  cli_error("cannot write to standard output");
  return CLI_FAILED;
}
