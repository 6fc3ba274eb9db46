/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the command over changed files, for as long as it is told: fuzz_command COMMAND FOLDER SECONDS SEED FILE…
 *
 * Each FILE is valid. One after the other is chosen at random, changed at random, written to FOLDER and read by
 * `COMMAND info` or, more seldom, drawn by `COMMAND render`. That has to end by itself, after at most ten seconds of a
 * processor (and a minute in all, as others may use the machine), with status 0, or with status 1 and one line that
 * begins with "tetcast: error:". What ends as an error may take four times the file's memory and 256 MB. A file that
 * breaks this is kept in FOLDER, as found-0, found-1 …, and told of. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Whether the command has AddressSanitizer, as this has, which takes memory for itself. */
#ifdef __SANITIZE_ADDRESS__
#define SANITIZED 1
#elif defined(__has_feature)
#define SANITIZED __has_feature(address_sanitizer)
#else
#define SANITIZED 0
#endif

enum { PROCESSOR_SECONDS = 10, PATIENCE = 60 };

static uint64_t state;

static uint32_t random_below(uint32_t limit) { /* splitmix64 */
  uint64_t z = state += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return (uint32_t)((z ^ (z >> 31)) >> 11) % limit;
}

typedef struct Bytes {
  char *at;
  size_t size, room;
} Bytes;

static void reserve(Bytes *bytes, size_t room) {
  if (room <= bytes->room)
    return;
  bytes->room = 2 * room;
  bytes->at = realloc(bytes->at, bytes->room);
  if (!bytes->at)
    abort();
}

static Bytes read_file(const char *path) {
  Bytes bytes = {NULL, 0, 0};
  FILE *file = fopen(path, "rb");
  if (!file) {
    perror(path);
    exit(2);
  }
  for (size_t got = 1; got > 0; bytes.size += got) {
    reserve(&bytes, bytes.size + 65536);
    got = fread(bytes.at + bytes.size, 1, 65536, file);
  }
  fclose(file);
  return bytes;
}

static void write_file(const char *path, const Bytes *bytes) {
  FILE *file = fopen(path, "wb");
  if (!file || fwrite(bytes->at, 1, bytes->size, file) != bytes->size || fclose(file) != 0) {
    perror(path);
    exit(2);
  }
}

/* ── changes ── */

static const char *const words[] = {"-1",
                                    "0",
                                    "1",
                                    "2147483647",
                                    "2147483648",
                                    "-2147483648",
                                    "4294967295",
                                    "4294967296",
                                    "9223372036854775807",
                                    "18446744073709551615",
                                    "1e308",
                                    "1e999",
                                    "-1e308",
                                    "nan",
                                    "inf",
                                    "String",
                                    "Int8",
                                    "UInt8",
                                    "Float32",
                                    "Float64",
                                    "Bit",
                                    "IdType",
                                    "binary",
                                    "ascii",
                                    "appended",
                                    "vtkLZ4DataCompressor",
                                    "vtkLZMADataCompressor",
                                    "vtkZLibDataCompressor",
                                    "BigEndian",
                                    "UInt64",
                                    "connectivity",
                                    "offsets",
                                    "types",
                                    "faces",
                                    "faceoffsets",
                                    "vtkGhostType",
                                    "TimeStep=\"0\"",
                                    "NumberOfComponents=\"1000000\"",
                                    "NumberOfTuples=\"1000000\"",
                                    "<FieldData>",
                                    "</DataArray>",
                                    "<Piece>",
                                    "\"",
                                    ">",
                                    "<"};

/* Cuts `cut` bytes out at a place and puts others there. */
static void replace(Bytes *bytes, size_t at, size_t cut, const char *text, size_t size) {
  if (cut > bytes->size - at)
    cut = bytes->size - at;
  reserve(bytes, bytes->size + size);
  memmove(bytes->at + at + size, bytes->at + at + cut, bytes->size - at - cut);
  memcpy(bytes->at + at, text, size);
  bytes->size += size - cut;
}

/* A place in the file; most often in its head, where what is claimed stands, or where a letter of this kind is. */
static size_t place(const Bytes *bytes, const char *letters) {
  const size_t limit = random_below(3) && bytes->size > 4096 ? 4096 : bytes->size;
  size_t at = random_below((uint32_t)limit);
  for (int tries = 0; letters && tries < 2000 && !strchr(letters, bytes->at[at] ? bytes->at[at] : '~'); ++tries)
    at = random_below((uint32_t)limit);
  return at;
}

static void change(Bytes *bytes) {
  if (bytes->size == 0)
    return;
  const char *word = words[random_below(sizeof words / sizeof *words)];
  size_t at;
  switch (random_below(9)) {
  case 0: /* a bit */
    at = place(bytes, NULL);
    bytes->at[at] = (char)(bytes->at[at] ^ (1 << random_below(8)));
    break;
  case 1: /* a digit */
    bytes->at[place(bytes, "0123456789")] = "0123456789-.e"[random_below(13)];
    break;
  case 2: /* a whole number */
    at = place(bytes, "0123456789");
    while (at > 0 && strchr("0123456789", bytes->at[at - 1]) && bytes->at[at - 1])
      --at;
    replace(bytes, at, strspn(bytes->at + at, "0123456789"), word, strlen(word));
    break;
  case 3: /* the value of an attribute */
    at = place(bytes, "\"") + 1;
    if (at < bytes->size) {
      const char *end = memchr(bytes->at + at, '"', bytes->size - at);
      replace(bytes, at, end && end - bytes->at - (ptrdiff_t)at < 64 ? (size_t)(end - bytes->at) - at : 0, word,
              strlen(word));
    }
    break;
  case 4: /* a word anywhere */
    replace(bytes, place(bytes, NULL), random_below(8), word, strlen(word));
    break;
  case 5: /* the end is missing */
    bytes->size = random_below((uint32_t)bytes->size);
    break;
  case 6: { /* a part twice, or somewhere else */
    const size_t from = place(bytes, "<"), size = 1 + random_below(400),
                 part = size < bytes->size - from ? size : bytes->size - from;
    char *copy = malloc(part);
    if (!copy)
      abort();
    memcpy(copy, bytes->at + from, part);
    replace(bytes, place(bytes, "<"), random_below(2) ? 0 : random_below(200), copy, part);
    free(copy);
    break;
  }
  case 7: /* a part is missing */
    replace(bytes, place(bytes, "< \""), random_below(200), "", 0);
    break;
  default: /* bytes that may be any */
    for (uint32_t i = 0, n = 1 + random_below(16); i < n; ++i)
      bytes->at[place(bytes, NULL)] = (char)random_below(256);
  }
}

/* ── the command ── */

typedef struct Outcome {
  int status; /* as of waitpid() */
  bool late;
  long kilobytes;
  double seconds;
  char error[512]; /* the start of standard error, and how many lines it begins with "tetcast: error: " */
  int errors;
} Outcome;

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void become(const char *command, const char *folder, const char *file, bool render, const char *error_path) {
  char picture[1024];
  snprintf(picture, sizeof picture, "%s/picture.png", folder);
  const int nothing = open("/dev/null", O_WRONLY), errors = open(error_path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(nothing, 1);
  dup2(errors, 2);
  const struct rlimit space = {(rlim_t)16 << 30, (rlim_t)16 << 30}, cores = {0, 0},
                      time = {PROCESSOR_SECONDS, PROCESSOR_SECONDS + 1};
  setrlimit(RLIMIT_CPU, &time);
  if (!SANITIZED)
    setrlimit(RLIMIT_AS, &space);
  setrlimit(RLIMIT_CORE, &cores);
  if (render)
    execl(command, command, "render", file, "-o", picture, "--size", "16x12", "--threads", "1", (char *)NULL);
  else
    execl(command, command, "info", file, (char *)NULL);
  _exit(127);
}

static Outcome run(const char *command, const char *folder, const char *file, bool render) {
  char error_path[1024];
  snprintf(error_path, sizeof error_path, "%s/errors", folder);
  Outcome outcome = {.status = -1};
  const double start = now();
  const pid_t child = fork();
  if (child < 0) {
    perror("fork");
    exit(2);
  }
  if (child == 0)
    become(command, folder, file, render, error_path);
  struct rusage usage;
  pid_t ended = 0;
  while ((ended = wait4(child, &outcome.status, WNOHANG, &usage)) == 0) {
    if (now() - start > PATIENCE) {
      outcome.late = true;
      kill(child, SIGKILL);
      wait4(child, &outcome.status, 0, &usage);
      break;
    }
    const struct timespec pause = {0, 2000000};
    nanosleep(&pause, NULL);
  }
  outcome.seconds = now() - start;
  outcome.kilobytes = usage.ru_maxrss;
  const Bytes errors = read_file(error_path);
  snprintf(outcome.error, sizeof outcome.error, "%.*s", (int)(errors.size < 500 ? errors.size : 500),
           errors.size ? errors.at : "");
  for (const char *line = outcome.error; line; line = strchr(line, '\n')) {
    line += line != outcome.error;
    outcome.errors += strncmp(line, "tetcast: error: ", 16) == 0;
  }
  free(errors.at);
  return outcome;
}

/* What is wrong with how it ended; NULL: nothing. */
static const char *fault_of(const Outcome *outcome, size_t size) {
  if (outcome->late || (WIFSIGNALED(outcome->status) && (WTERMSIG(outcome->status) == SIGXCPU)))
    return "does not end";
  if (WIFSIGNALED(outcome->status))
    return "crashes";
  const int code = WEXITSTATUS(outcome->status);
  if (code == 0)
    return outcome->errors ? "an error, and status 0" : NULL;
  if (code != 1)
    return "has another status than 0 and 1";
  if (outcome->errors != 1)
    return "has not one line of error";
  if (!SANITIZED && outcome->kilobytes > (long)(4 * size / 1024 + 256 * 1024))
    return "takes too much memory for an error";
  return NULL;
}

int main(int argc, char **argv) {
  if (argc < 6) {
    fputs("usage: fuzz_command COMMAND FOLDER SECONDS SEED FILE...\n", stderr);
    return 2;
  }
  const char *command = argv[1], *folder = argv[2];
  const double end = now() + atof(argv[3]);
  state = strtoull(argv[4], NULL, 10);
  const int files = argc - 5;
  long runs = 0, refused = 0;
  int found = 0;
  double longest = 0;
  long most = 0;
  Bytes bytes = {NULL, 0, 0};
  while (now() < end) {
    const char *source = argv[5 + random_below((uint32_t)files)], *dot = strrchr(source, '.');
    Bytes whole = read_file(source);
    bytes.size = 0;
    replace(&bytes, 0, 0, whole.at, whole.size);
    free(whole.at);
    for (uint32_t i = 0, n = 1 + random_below(4); i < n; ++i)
      change(&bytes);
    char path[1024], kept[1024];
    snprintf(path, sizeof path, "%s/changed%s", folder, dot ? dot : "");
    write_file(path, &bytes);
    const bool render = random_below(16) == 0; /* which loads many libraries more */
    const Outcome outcome = run(command, folder, path, render);
    const char *fault = fault_of(&outcome, bytes.size);
    ++runs;
    refused += WIFEXITED(outcome.status) && WEXITSTATUS(outcome.status) == 1;
    longest = outcome.seconds > longest ? outcome.seconds : longest;
    most = outcome.kilobytes > most ? outcome.kilobytes : most;
    if (!fault)
      continue;
    snprintf(kept, sizeof kept, "%s/found-%d%s", folder, found++, dot ? dot : "");
    write_file(kept, &bytes);
    printf("%s: %s of it %s (status %#x, %.1f s, %ld MB; from %s): %s\n", kept, render ? "render" : "info", fault,
           (unsigned)outcome.status, outcome.seconds, outcome.kilobytes / 1024, source, outcome.error);
    fflush(stdout);
  }
  printf("%ld runs, %ld refused, %d found; longest %.1f s, most %ld MB\n", runs, refused, found, longest, most / 1024);
  free(bytes.at);
  return found > 0;
}
