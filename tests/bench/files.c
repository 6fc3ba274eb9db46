/* SPDX-License-Identifier: Apache-2.0 */
#include "jobs.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <tetcast/dataset.h>

static void write_mesh(const Job *job, const char *path) {
  Tet tet;
  tet_open(&tet, job->mesh, 2);
  const char *name = "wave";
  const TetcastField *field = tet.field;
  must(tetcast_dataset_write(tet.context, path, tet.mesh, 1, &name, &field) == TETCAST_OK, "the mesh can't be written");
  tet_close(&tet);
}

static Clock read_mesh(const char *path) {
  TetcastContext *context = NULL;
  TetcastDataset *dataset = NULL;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  Clock start = clock_now();
  must(tetcast_context_create(NULL, &context) == TETCAST_OK &&
           tetcast_dataset_read(context, path, NULL, &dataset) == TETCAST_OK &&
           tetcast_dataset_mesh(dataset, &mesh) == TETCAST_OK &&
           tetcast_dataset_field(dataset, NULL, &field, NULL) == TETCAST_OK,
       "the mesh can't be read");
  Clock time = clock_since(start);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  tetcast_context_destroy(&context);
  return time;
}

static double seconds(struct timeval time) {
  return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

/* Runs a program to its end. */
static Clock run(char *const arguments[]) {
  struct rusage before, after;
  getrusage(RUSAGE_CHILDREN, &before);
  Clock start = clock_now();
  pid_t child = fork();
  must(child >= 0, "no process can be started");
  if (child == 0) {
    execv(arguments[0], arguments);
    _exit(127);
  }
  int status = 0;
  must(waitpid(child, &status, 0) == child, "a program is lost");
  Clock time = clock_since(start);
  getrusage(RUSAGE_CHILDREN, &after);
  time.cpu = seconds(after.ru_utime) + seconds(after.ru_stime) - seconds(before.ru_utime) - seconds(before.ru_stime);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    fprintf(stderr, "tetcast_bench: %s failed\n", arguments[0]);
    exit(1);
  }
  return time;
}

void job_file(const Job *job) {
  char mesh[4096], picture[4096], size[64];
  snprintf(mesh, sizeof mesh, "%s/%s.vtu", job->options->scratch, job->scene->name);
  snprintf(picture, sizeof picture, "%s/%s.png", job->options->scratch, job->scene->name);
  snprintf(size, sizeof size, "%dx%d", job->options->pixels, job->options->pixels);
  write_mesh(job, mesh);
  char *command[] = {(char *)job->options->tetcast, "render", mesh, "-o", picture, "--size", size, NULL};
  char *plain[] = {(char *)job->options->plain, mesh, picture, size, NULL};
  Times read = {0}, total[2] = {0};
  for (int round = 0; round < job->scene->rounds; round++) {
    times_add(&read, read_mesh(mesh));
    if (command[0] && plain[0]) {
      times_add(&total[0], run(command));
      times_add(&total[1], run(plain));
    }
  }
  Row row = job->row;
  row.task = "read";
  row.renderer = "tetcast";
  row.times = &read;
  row_write(&row);
  row.task = "file to picture";
  row.pixels = job->options->pixels;
  for (int i = 0; i < 2 && total[0].wall.count > 0; i++) {
    row.renderer = i == 0 ? "tetcast" : "reading and writing";
    row.times = &total[i];
    row_write(&row);
  }
  remove(mesh);
  remove(picture);
}
