/* SPDX-License-Identifier: Apache-2.0 */
/* A fuzz target: one entry that takes texts by anybody. With libFuzzer, or replayed by replay.c over changed seeds. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* Good inputs, a NULL at the end. */
extern const char *const fuzz_seeds[];

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Writes a file in a folder of this process and returns its path, which stays as it is until the next call. */
const char *fuzz_file(const char *name, const void *data, size_t size);

#endif
