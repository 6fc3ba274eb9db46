/* SPDX-License-Identifier: Apache-2.0 */
#include "cli.h"

#include <ctype.h>
#include <getopt.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "progress.h"

static struct {
  bool quiet;
  const char *place, *hint;
  bool failed; /* an error has been shown; guarded by the lock of stderr, as is the list */
  bool once, strict;
  bool refused; /* a warning was an error */
  char **warnings; /* that were shown, without their digits */
  int count, capacity;
  bool held;
  pthread_t holder;
  struct Message *kept; /* of other threads */
  int kept_count, kept_capacity;
} messages;

typedef struct Message {
  enum { MESSAGE_ERROR, MESSAGE_WARNING, MESSAGE_NOTE } kind;
  char *place, *text;
} Message;

void cli_set_quiet(bool quiet) {
  messages.quiet = quiet;
}

void cli_set_strict(bool strict) {
  messages.strict = strict;
}

int cli_verdict(int code) {
  return code == CLI_DONE && messages.refused ? CLI_FAILED : code;
}

void cli_warn_once(void) {
  messages.once = true;
}

bool cli_quiet(void) {
  return messages.quiet;
}

void cli_set_place(const char *place) {
  messages.place = place;
}

void cli_set_hint(const char *hint) {
  messages.hint = hint;
}

/* One call of fprintf, as lines may come from several threads; control characters of file and array names stay out of
 * the line. */
static void show(const char *kind, const char *place, const char *text) {
  char *line = cli_print("%s%s%s", place ? place : "", place ? ": " : "", text);
  for (char *c = line; *c; c++)
    if (iscntrl((unsigned char)*c))
      *c = ' ';
  cli_progress_clear();
  fprintf(stderr, "tetcast: %s: %s\n", kind, line);
  free(line);
}

/* Keeps a message for later where another thread holds them; false: it is to be shown. */
static bool keep(int kind, const char *place, const char *text) {
  if (!messages.held || pthread_equal(messages.holder, pthread_self()))
    return false;
  messages.kept =
      cli_grow(messages.kept, messages.kept_count, &messages.kept_capacity, sizeof *messages.kept);
  messages.kept[messages.kept_count++] =
      (Message){kind, place ? cli_duplicate(place) : NULL, cli_duplicate(text)};
  return true;
}

static void show_error(const char *place, const char *text) {
  flockfile(stderr);
  if (!keep(MESSAGE_ERROR, place, text)) {
    if (!cli_interrupted() && !messages.failed)
      show("error", place, text);
    messages.failed = true;
  }
  funlockfile(stderr);
}

/* Whether a warning of these words has been shown. */
static bool is_repeated(const char *text) {
  char *words = cli_duplicate(text), *end = words;
  for (const char *c = text; *c; c++)
    if (!isdigit((unsigned char)*c))
      *end++ = *c;
  *end = '\0';
  for (int i = 0; i < messages.count; i++) {
    if (!strcmp(messages.warnings[i], words)) {
      free(words);
      return true;
    }
  }
  messages.warnings = cli_grow(messages.warnings, messages.count, &messages.capacity, sizeof *messages.warnings);
  messages.warnings[messages.count++] = words;
  return false;
}

static void show_warning(const char *text) {
  flockfile(stderr);
  if (messages.strict) {
    messages.refused = true;
    show_error(messages.place, text);
  } else if (keep(MESSAGE_WARNING, NULL, text)) {
    /* later */
  } else if (!messages.quiet && !(messages.once && is_repeated(text))) {
    show("warning", NULL, text);
  }
  funlockfile(stderr);
}

static void show_note(const char *text) {
  flockfile(stderr);
  if (!keep(MESSAGE_NOTE, NULL, text) && !messages.quiet && !messages.refused && !messages.failed)
    show("note", NULL, text);
  funlockfile(stderr);
}

void cli_messages_hold(bool hold) {
  flockfile(stderr);
  messages.held = hold;
  messages.holder = pthread_self();
  for (int i = 0; !hold && i < messages.kept_count; i++) {
    Message *message = &messages.kept[i];
    if (message->kind == MESSAGE_ERROR)
      show_error(message->place, message->text);
    else if (message->kind == MESSAGE_WARNING)
      show_warning(message->text);
    else
      show_note(message->text);
    free(message->place);
    free(message->text);
  }
  if (!hold)
    messages.kept_count = 0;
  funlockfile(stderr);
}

static void receive(void *user, TetcastSeverity severity, const char *text) {
  (void)user;
  if (severity == TETCAST_SEVERITY_ERROR) {
    char *whole = cli_print("%s%s", text, messages.hint ? messages.hint : "");
    show_error(messages.place, whole);
    free(whole);
  }
  if (severity == TETCAST_SEVERITY_WARNING)
    show_warning(text);
}

static char *print_list(const char *format, va_list list) {
  char *text = NULL;
  if (vasprintf(&text, format, list) < 0) {
    fputs("tetcast: error: out of memory\n", stderr);
    exit(CLI_FAILED);
  }
  return text;
}

char *cli_print(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = print_list(format, list);
  va_end(list);
  return text;
}

void cli_error(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = print_list(format, list);
  va_end(list);
  show_error(NULL, text);
  free(text);
}

void cli_warning(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = print_list(format, list);
  va_end(list);
  show_warning(text);
  free(text);
}

void cli_note(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = print_list(format, list);
  va_end(list);
  show_note(text);
  free(text);
}

int cli_usage_error(const char *command, const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = print_list(format, list);
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
  /* Words of a few letters are near to everything: they have to begin alike. */
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

TetcastContext *cli_context_create(int threads) {
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.threads = threads;
  desc.message = receive;
  TetcastContext *context = NULL;
  const TetcastStatus status = tetcast_context_create(&desc, &context);
  if (status != TETCAST_OK)
    cli_failed(status);
  return context;
}

int cli_failed(TetcastStatus status) {
  if (cli_interrupted())
    return 128 + cli_interrupted();
  show_error(messages.place, tetcast_status_string(status));
  return CLI_FAILED;
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
  if (!memory) {
    fputs("tetcast: error: out of memory\n", stderr);
    exit(CLI_FAILED);
  }
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
  if (poll(&end, 1, 0) > 0 && end.revents & POLLERR) /* as with "| head": the reader has enough, which is no fault */
    return 128 + SIGPIPE;
  cli_error("cannot write to standard output");
  return CLI_FAILED;
}
