/* SPDX-License-Identifier: Apache-2.0 */
/* Runs a fuzz target without libFuzzer: over files, or over its seeds, whole, cut short and changed in ways that are
 * the same each time.
 * --write FOLDER writes the seeds, for libFuzzer to begin with. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"

enum { CHANGES = 400 };

static uint32_t random_state = 1;
static uint32_t next_random(void) {
  random_state = random_state * 1664525u + 1013904223u;
  return random_state >> 8;
}

/* In memory of its own size, so that a sanitizer sees what is read beyond. */
static void run(const char *text, size_t size) {
  uint8_t *data = malloc(size ? size : 1);
  if (!data)
    abort();
  memcpy(data, text, size);
  LLVMFuzzerTestOneInput(data, size);
  free(data);
}

static void run_seed(const char *seed) {
  static const char *const words[] = {"-1", "0", "99999999999999999999", "1e999", "nan",    "{", "[", "\"",
                                      "\n", "$", "4294967296",           "<",     "\\u0000"};
  const size_t size = strlen(seed);
  char *text = malloc(size + 64);
  if (!text)
    abort();
  for (size_t i = 0; i < 40; ++i)
    run(seed, size * i / 39);
  for (int i = 0; i < CHANGES && size > 0; ++i) {
    size_t length = size;
    memcpy(text, seed, size);
    for (unsigned j = 0; j <= next_random() % 3; ++j) {
      const size_t at = next_random() % length;
      if (i % 3 == 0) {
        text[at] = (char)(text[at] ^ (1 << next_random() % 8));
      } else if (i % 3 == 1) {
        const char *word = words[next_random() % (sizeof words / sizeof *words)];
        const size_t room = size + 64 - at, n = strlen(word) < room ? strlen(word) : room;
        memcpy(text + at, word, n);
        length = at + n > length ? at + n : length;
      } else {
        const size_t from = next_random() % length, n = next_random() % 16, most = length - (from > at ? from : at);
        memmove(text + at, text + from, n < most ? n : most);
      }
    }
    run(text, length);
  }
  free(text);
}

static int run_file(const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file) {
    perror(path);
    return 1;
  }
  char *text = NULL;
  size_t size = 0, got = 1;
  while (got > 0) {
    text = realloc(text, size + 65536);
    if (!text)
      abort();
    got = fread(text + size, 1, 65536, file);
    size += got;
  }
  fclose(file);
  run(text, size);
  free(text);
  return 0;
}

int main(int argc, char **argv) {
  int failed = 0;
  if (argc == 3 && strcmp(argv[1], "--write") == 0) {
    for (int i = 0; fuzz_seeds[i]; ++i) {
      char path[512];
      snprintf(path, sizeof path, "%s/seed-%d", argv[2], i);
      FILE *file = fopen(path, "wb");
      if (!file || fputs(fuzz_seeds[i], file) < 0 || fclose(file) != 0) {
        perror(path);
        failed = 1;
      }
    }
    return failed;
  }
  for (int i = 1; i < argc; ++i)
    failed |= run_file(argv[i]);
  for (int i = 0; argc == 1 && fuzz_seeds[i]; ++i)
    run_seed(fuzz_seeds[i]);
  return failed;
}
