/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CLI_JSON_H
#define TETCAST_CLI_JSON_H

#include <stdbool.h>

#include <jansson.h>

/* The object in a file, for json_decref(); NULL after a message with file and line. Every number comes as a real. */
json_t *cli_json_read(const char *path);

/* The same of a file whose value is of any kind. */
json_t *cli_json_read_any(const char *path);

/* The numbers of an array of up to `most`, or of a single number: how many, 0 if the value is anything else. */
int cli_json_numbers(const json_t *value, int most, double *values);

/* A string, or null if it is not UTF-8: names in data and of files may be any bytes. */
json_t *cli_json_text(const char *text);

/* An array of numbers. */
json_t *cli_json_array(const double *values, int count);

/* Writes and releases `object`, whose keys need no escapes: numbers with the 17 digits that restore a double. False
 * after a message. */
bool cli_json_write(const char *path, json_t *object);

#endif
