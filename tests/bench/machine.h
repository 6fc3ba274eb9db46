/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BENCH_MACHINE_H
#define BENCH_MACHINE_H

#include <stdio.h>

/* What results depend on, as lines "# name: value"; what can't be found out is left out. */
void machine_describe(FILE *file);

/* How busy the machine is, as such a line. */
void machine_load(FILE *file, const char *when);

#endif
