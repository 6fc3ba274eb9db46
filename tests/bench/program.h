/* SPDX-License-Identifier: Apache-2.0 */
/* The other programs of the benchmark, and processes. */
#ifndef BENCH_PROGRAM_H
#define BENCH_PROGRAM_H

#include <stdbool.h>
#include <sys/types.h>

/* The folder of the program whose argv[0] this is, to be freed. */
char *program_folder(const char *argv0);

/* FOLDER/NAME if that can be run, to be freed; else NULL and a line on stderr. */
char *program_find(const char *folder, const char *name);

/* Waits for a child; whether it was started and ended well. */
bool program_wait(pid_t child);

#endif
