/* SPDX-License-Identifier: Apache-2.0 */
/* What the tests of reading and writing share: a context that remembers what it was told, and files that come and go.
 */
#ifndef TEST_VTK_COMMON_H
#define TEST_VTK_COMMON_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <dirent.h>
#include <unistd.h>

#include <cmocka.h>

#include <tetcast/dataset.h>

typedef struct Fixture {
  TetcastContext *context;
  int errors, warnings;
  char message[4096]; /* the last error */
  char warning[4096]; /* the last warning */
  char folder[256];
  char path[512]; /* the last that in_folder() made */
} Fixture;

static void remember(void *user, TetcastSeverity severity, const char *text) {
  Fixture *fixture = user;
  assert_null(strchr(text, '\n'));
  fixture->warnings += severity == TETCAST_SEVERITY_WARNING;
  if (severity == TETCAST_SEVERITY_WARNING)
    snprintf(fixture->warning, sizeof fixture->warning, "%s", text);
  if (severity != TETCAST_SEVERITY_ERROR)
    return;
  ++fixture->errors;
  snprintf(fixture->message, sizeof fixture->message, "%s", text);
}

static void open_context(Fixture *fixture) {
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.message = remember;
  desc.message_user = fixture;
  assert_int_equal(tetcast_context_create(&desc, &fixture->context), TETCAST_OK);
}

static int set_up(void **state) {
  Fixture *fixture = calloc(1, sizeof *fixture);
  const char *temporary = getenv("TMPDIR");
  snprintf(fixture->folder, sizeof fixture->folder, "%s/tetcast-vtk-XXXXXX", temporary ? temporary : "/tmp");
  assert_non_null(mkdtemp(fixture->folder));
  open_context(fixture);
  *state = fixture;
  return 0;
}

/* Removes every file of the folder and says how many there were. */
static inline int empty_folder(const Fixture *fixture) {
  int count = 0;
  DIR *folder = opendir(fixture->folder);
  assert_non_null(folder);
  for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
      continue;
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", fixture->folder, entry->d_name);
    unlink(path);
    ++count;
  }
  closedir(folder);
  return count;
}

static int tear_down(void **state) {
  Fixture *fixture = *state;
  tetcast_context_destroy(&fixture->context);
  empty_folder(fixture);
  rmdir(fixture->folder);
  free(fixture);
  return 0;
}

static inline const char *in_folder(Fixture *fixture, const char *name) {
  snprintf(fixture->path, sizeof fixture->path, "%s/%s", fixture->folder, name);
  return fixture->path;
}

static inline const char *file_of(Fixture *fixture, const char *name, const void *bytes, size_t size) {
  FILE *file = fopen(in_folder(fixture, name), "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
  return fixture->path;
}

static inline const char *text_file(Fixture *fixture, const char *name, const char *text) {
  return file_of(fixture, name, text, strlen(text));
}

static inline char *contents(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  char *bytes = malloc(*size);
  assert_int_equal(fread(bytes, 1, *size, file), *size);
  fclose(file);
  return bytes;
}

/* A path in the folder of datasets by others; the test is skipped when that is missing. */
static inline const char *data_path(Fixture *fixture, const char *name) {
  const char *folder = getenv("TETCAST_DATA");
  if (folder)
    snprintf(fixture->path, sizeof fixture->path, "%s/%s", folder, name);
  if (!folder || access(fixture->path, R_OK) != 0) {
    print_message("skipped: no %s in TETCAST_DATA\n", name);
    skip();
  }
  return fixture->path;
}

/* Calls `use` for each file in a folder of the data whose name ends so. Returns how many there were. */
static inline int each_file(Fixture *fixture, const char *folder, const char *ending,
                            void (*use)(Fixture *, const char *)) {
  char path[1024], base[512];
  snprintf(base, sizeof base, "%s", data_path(fixture, folder));
  int count = 0;
  DIR *files = opendir(base);
  assert_non_null(files);
  for (struct dirent *entry = readdir(files); entry; entry = readdir(files)) {
    const size_t length = strlen(entry->d_name), tail = strlen(ending);
    if (entry->d_name[0] == '.' || length <= tail || strcmp(entry->d_name + length - tail, ending) != 0)
      continue;
    snprintf(path, sizeof path, "%s/%s", base, entry->d_name);
    use(fixture, path);
    ++count;
  }
  closedir(files);
  return count;
}

static inline TetcastDataset *read_good(Fixture *fixture, const char *path) {
  TetcastDataset *dataset = NULL;
  fixture->errors = 0;
  fixture->message[0] = '\0';
  const TetcastStatus status = tetcast_dataset_read(fixture->context, path, NULL, &dataset);
  if (status)
    print_error("%s\n", fixture->message);
  assert_int_equal(status, TETCAST_OK);
  assert_non_null(dataset);
  assert_int_equal(fixture->errors, 0);
  return dataset;
}

/* One message that names the file and says `words`. */
static inline void assert_complaint(const Fixture *fixture, const char *path, const char *words) {
  assert_int_equal(fixture->errors, 1);
  if (!strstr(fixture->message, path) || !strstr(fixture->message, words)) {
    print_error("'%s' lacks '%s'\n", fixture->message, words);
    fail();
  }
}

static inline void read_bad(Fixture *fixture, const char *path, TetcastStatus status, const char *words) {
  TetcastDataset *dataset = (TetcastDataset *)fixture;
  fixture->errors = 0;
  assert_int_equal(tetcast_dataset_read(fixture->context, path, NULL, &dataset), status);
  assert_null(dataset);
  assert_complaint(fixture, path, words);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

#endif
