/* SPDX-License-Identifier: Apache-2.0 */
#include "json.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "file.h"

json_t *cli_json_read_any(const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file) {
    cli_error("cannot open '%s': %s", path, strerror(errno));
    return NULL;
  }
  json_error_t error;
  errno = 0;
  json_t *object = json_loadf(file, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &error);
  const int read_error = ferror(file) ? errno : 0;
  fclose(file);
  if (read_error) {
    cli_error("cannot read '%s': %s", path, strerror(read_error));
    json_decref(object);
    return NULL;
  }
  if (!object)
    cli_error("%s:%d: %s", path, error.line, error.text);
  return object;
}

json_t *cli_json_read(const char *path) {
  json_t *object = cli_json_read_any(path);
  if (object && !json_is_object(object)) {
    cli_error("%s: expected a JSON object", path);
    json_decref(object);
    object = NULL;
  }
  return object;
}

int cli_json_numbers(const json_t *value, int most, double *values) {
  if (json_is_number(value)) {
    values[0] = json_number_value(value);
    return 1;
  }
  if (!json_is_array(value) || json_array_size(value) > (size_t)most)
    return 0;
  const int count = (int)json_array_size(value);
  for (int i = 0; i < count; i++) {
    const json_t *item = json_array_get(value, (size_t)i);
    if (!json_is_number(item))
      return 0;
    values[i] = json_number_value(item);
  }
  return count;
}

json_t *cli_json_text(const char *text) {
  json_t *value = json_string(text);
  return value ? value : json_null();
}

json_t *cli_json_array(const double *values, int count) {
  json_t *array = json_array();
  for (int i = 0; i < count; i++)
    json_array_append_new(array, json_real(values[i]));
  return array;
}

/* Laid out as people write it, with a line for each key and for each row of numbers. */
static void put(FILE *file, const json_t *value, int indent) {
  if (json_is_object(value)) {
    const char *separator = "{";
    void *position = json_object_iter((json_t *)value);
    for (; position; position = json_object_iter_next((json_t *)value, position)) {
      fprintf(file, "%s\n%*s\"%s\": ", separator, indent + 2, "", json_object_iter_key(position));
      put(file, json_object_iter_value(position), indent + 2);
      separator = ",";
    }
    fprintf(file, "\n%*s}", indent, "");
  } else if (json_is_array(value) && json_array_size(value) > 0 && !json_is_number(json_array_get(value, 0))) {
    for (size_t i = 0; i < json_array_size(value); i++) {
      fprintf(file, "%s\n%*s", i ? "," : "[", indent + 2, "");
      put(file, json_array_get(value, i), indent + 2);
    }
    fprintf(file, "\n%*s]", indent, "");
  } else {
    char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
    if (!text)
      cli_out_of_memory();
    fputs(text, file);
    free(text);
  }
}

bool cli_json_write(const char *path, json_t *object) {
  CliText *text = cli_text_begin();
  put(text->file, object, 0);
  fputc('\n', text->file);
  json_decref(object);
  return cli_text_write(text, NULL, path);
}
