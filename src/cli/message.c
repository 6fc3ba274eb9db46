/* SPDX-License-Identifier: Apache-2.0 */
/* Messages of the command and of the library, as cli.h declares them. */
#include <ctype.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "progress.h"

static struct {
  bool quiet;
  const char *hint;
  bool failed; /* an error has been shown; guarded by the lock of stderr, as is the list */
  bool once, strict;
  bool refused; /* a warning was an error */
  bool apart, lenient;
  bool said; /* an error has come on standard error */
  int rank;
  char **warnings; /* that were shown, without their digits */
  int count, capacity;
  bool held;
  pthread_t holder;
  struct Message *kept; /* of other threads */
  int kept_count, kept_capacity;
} messages;

static _Thread_local const char *place_now; /* others write former pictures, or load libraries, beside it */

enum { MESSAGE_ERROR, MESSAGE_WARNING, MESSAGE_NOTE };

typedef struct Message {
  int kind;
  char *place, *text;
} Message;

void cli_set_quiet(bool quiet) {
  messages.quiet = quiet;
}

void cli_set_strict(bool strict) {
  messages.strict = strict;
}

int cli_verdict(int code) {
  flockfile(stderr);
  bool refused = messages.refused;
  for (int i = 0; messages.strict && i < messages.kept_count && !pthread_equal(messages.holder, pthread_self()); i++)
    refused = refused || messages.kept[i].kind == MESSAGE_WARNING;
  funlockfile(stderr);
  return code == CLI_DONE && refused ? CLI_FAILED : code;
}

void cli_set_rank(int rank) {
  messages.rank = rank;
}

void cli_set_apart(bool apart) {
  messages.apart = apart;
}

bool cli_said(void) {
  return messages.said;
}

int cli_rank(void) {
  return messages.rank;
}

void cli_set_lenient(bool lenient) {
  messages.lenient = lenient;
}

void cli_warn_once(void) {
  flockfile(stderr);
  messages.once = true;
  while (messages.count > 0)
    free(messages.warnings[--messages.count]);
  funlockfile(stderr);
}

bool cli_quiet(void) {
  return messages.quiet;
}

void cli_forget_errors(void) {
  flockfile(stderr);
  messages.failed = messages.refused = false;
  funlockfile(stderr);
}

void cli_set_place(const char *place) {
  place_now = place;
}

void cli_set_hint(const char *hint) {
  messages.hint = hint;
}

/* One call of fprintf, as lines may come from several threads; control characters of file and array names stay out of
 * the line. */
static void show(const char *kind, const char *place, const char *text) {
  if (messages.rank > 0 && !messages.apart) /* another process says it */
    return;
  messages.said = messages.said || !strcmp(kind, "error");
  char *rank = messages.rank > 0 ? cli_print("rank %d: ", messages.rank) : NULL;
  char *line = cli_print("%s%s%s%s", rank ? rank : "", place ? place : "", place ? ": " : "", text);
  free(rank);
  for (char *c = line; *c; c++)
    if (iscntrl((unsigned char)*c))
      *c = ' ';
  cli_progress_clear();
  fprintf(stderr, "tetcast: %s: %s\n", kind, line);
  free(line);
}

/* Keeps a message for later if another thread holds messages. False if it is to be shown now. */
static bool keep(int kind, const char *place, const char *text) {
  if (!messages.held || pthread_equal(messages.holder, pthread_self()))
    return false;
  messages.kept = cli_grow(messages.kept, messages.kept_count, &messages.kept_capacity, sizeof *messages.kept);
  messages.kept[messages.kept_count++] = (Message){kind, place ? cli_duplicate(place) : NULL, cli_duplicate(text)};
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

static void show_warning(const char *place, const char *text) {
  flockfile(stderr);
  if (keep(MESSAGE_WARNING, place, text)) {
    /* later */
  } else if (messages.strict) {
    messages.refused = true;
    show_error(place, text);
  } else if (!messages.quiet && !(messages.once && is_repeated(text))) {
    show("warning", NULL, text);
  }
  funlockfile(stderr);
}

static void show_note(const char *text) {
  flockfile(stderr);
  if (!keep(MESSAGE_NOTE, NULL, text) && !messages.quiet && !messages.refused && !messages.failed && messages.rank == 0)
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
      show_warning(message->place, message->text);
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
    (messages.lenient ? show_warning : show_error)(place_now, whole);
    free(whole);
  }
  if (severity == TETCAST_SEVERITY_WARNING)
    show_warning(place_now, text);
}

void cli_error(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = cli_print_list(format, list);
  va_end(list);
  show_error(NULL, text);
  free(text);
}

void cli_warning(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = cli_print_list(format, list);
  va_end(list);
  show_warning(place_now, text);
  free(text);
}

void cli_note(const char *format, ...) {
  va_list list;
  va_start(list, format);
  char *text = cli_print_list(format, list);
  va_end(list);
  show_note(text);
  free(text);
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
  show_error(place_now, tetcast_status_string(status));
  return CLI_FAILED;
}
