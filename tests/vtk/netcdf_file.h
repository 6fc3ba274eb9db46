/* SPDX-License-Identifier: Apache-2.0 */
/* Writes files in NetCDF's classic format: dimensions, attributes of text, variables of letters, integers and doubles.
 */
#ifndef TEST_VTK_NETCDF_FILE_H
#define TEST_VTK_NETCDF_FILE_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct NetcdfDimension {
  const char *name;
  int size; /* 0: of records */
} NetcdfDimension;

typedef struct NetcdfVariable {
  const char *name;
  int dimensions[3];             /* numbers, −1 behind the last; that of records comes first */
  char type;                     /* 'c', 'i', 'd' */
  const void *data;              /* record after record */
  const char *attribute, *value; /* NULL: none */
} NetcdfVariable;

typedef struct NetcdfAttribute {
  const char *name, *text; /* text NULL: a number */
  int type;                /* of the number: 4, an integer, or 5, single precision */
  double number;
} NetcdfAttribute;

typedef struct NetcdfFile {
  FILE *file;
  const NetcdfDimension *dimensions;
  int dimension_count, records;
} NetcdfFile;

static inline void netcdf_integer(FILE *file, uint32_t value) {
  for (int k = 3; k >= 0; --k)
    fputc((int)(value >> 8 * k & 255), file);
}

static inline void netcdf_number(FILE *file, char type, const void *data, long i) {
  unsigned char bytes[8];
  if (type == 'c') {
    fputc(((const char *)data)[i], file);
    return;
  }
  const size_t size = type == 'i' ? 4 : 8;
  memcpy(bytes, (const char *)data + (size_t)i * size, size);
  for (size_t k = size; k-- > 0;)
    fputc(bytes[k], file); /* the most significant byte comes first */
}

static inline void netcdf_pad(FILE *file) {
  while (ftell(file) % 4)
    fputc(0, file);
}

static inline void netcdf_text(FILE *file, const char *text) {
  netcdf_integer(file, (uint32_t)strlen(text));
  fputs(text, file);
  netcdf_pad(file);
}

/* Values of a variable, or of a record of it. */
static inline long netcdf_count(const NetcdfFile *to, const NetcdfVariable *variable) {
  long count = 1;
  for (int k = 0; k < 3 && variable->dimensions[k] >= 0; ++k) {
    const int size = to->dimensions[variable->dimensions[k]].size;
    count *= size ? size : 1;
  }
  return count;
}

static inline int netcdf_is_record(const NetcdfFile *to, const NetcdfVariable *variable) {
  return variable->dimensions[0] >= 0 && to->dimensions[variable->dimensions[0]].size == 0;
}

static inline long netcdf_bytes(const NetcdfFile *to, const NetcdfVariable *variable) {
  const long bytes = netcdf_count(to, variable) * (variable->type == 'c' ? 1 : variable->type == 'i' ? 4 : 8);
  return (bytes + 3) / 4 * 4;
}

static inline void netcdf_header(NetcdfFile *to, const NetcdfAttribute *attributes, int attribute_count,
                                 const NetcdfVariable *variables, int count, const long *begin) {
  FILE *file = to->file;
  fputs("CDF\x01", file);
  netcdf_integer(file, (uint32_t)to->records);
  netcdf_integer(file, 10);
  netcdf_integer(file, (uint32_t)to->dimension_count);
  for (int i = 0; i < to->dimension_count; ++i) {
    netcdf_text(file, to->dimensions[i].name);
    netcdf_integer(file, (uint32_t)to->dimensions[i].size);
  }
  netcdf_integer(file, 12);
  netcdf_integer(file, (uint32_t)attribute_count);
  for (int i = 0; i < attribute_count; ++i) {
    const float number = (float)attributes[i].number;
    uint32_t bits = (uint32_t)attributes[i].number;
    if (attributes[i].type == 5)
      memcpy(&bits, &number, sizeof bits);
    netcdf_text(file, attributes[i].name);
    netcdf_integer(file, attributes[i].text ? 2 : (uint32_t)attributes[i].type);
    if (attributes[i].text)
      netcdf_text(file, attributes[i].text);
    else
      netcdf_integer(file, 1), netcdf_integer(file, bits);
  }
  netcdf_integer(file, 11);
  netcdf_integer(file, (uint32_t)count);
  for (int i = 0; i < count; ++i) {
    int rank = 0;
    while (rank < 3 && variables[i].dimensions[rank] >= 0)
      ++rank;
    netcdf_text(file, variables[i].name);
    netcdf_integer(file, (uint32_t)rank);
    for (int k = 0; k < rank; ++k)
      netcdf_integer(file, (uint32_t)variables[i].dimensions[k]);
    netcdf_integer(file, variables[i].attribute ? 12 : 0);
    netcdf_integer(file, variables[i].attribute ? 1 : 0);
    if (variables[i].attribute) {
      netcdf_text(file, variables[i].attribute);
      netcdf_integer(file, 2);
      netcdf_text(file, variables[i].value);
    }
    netcdf_integer(file, variables[i].type == 'c' ? 2 : variables[i].type == 'i' ? 4 : 6);
    netcdf_integer(file, (uint32_t)netcdf_bytes(to, &variables[i]));
    netcdf_integer(file, (uint32_t)begin[i]);
  }
}

static inline void netcdf_write(const char *path, const NetcdfDimension *dimensions, int dimension_count, int records,
                                const NetcdfAttribute *attributes, int attribute_count, const NetcdfVariable *variables,
                                int count) {
  NetcdfFile to = {fopen(path, "wb"), dimensions, dimension_count, records};
  long *begin = calloc((size_t)count, sizeof *begin);
  netcdf_header(&to, attributes, attribute_count, variables, count, begin);
  long at = ftell(to.file);
  for (int records_turn = 0; records_turn < 2; ++records_turn) {
    for (int i = 0; i < count; ++i) {
      if (netcdf_is_record(&to, &variables[i]) != records_turn)
        continue;
      begin[i] = at;
      at += netcdf_bytes(&to, &variables[i]);
    }
  }
  rewind(to.file);
  netcdf_header(&to, attributes, attribute_count, variables, count, begin);
  for (int i = 0; i < count; ++i) {
    for (long k = 0; !netcdf_is_record(&to, &variables[i]) && k < netcdf_count(&to, &variables[i]); ++k)
      netcdf_number(to.file, variables[i].type, variables[i].data, k);
    netcdf_pad(to.file);
  }
  for (int record = 0; record < records; ++record) {
    for (int i = 0; i < count; ++i) {
      const long values = netcdf_count(&to, &variables[i]);
      for (long k = 0; netcdf_is_record(&to, &variables[i]) && k < values; ++k)
        netcdf_number(to.file, variables[i].type, variables[i].data, record * values + k);
      netcdf_pad(to.file);
    }
  }
  fclose(to.file);
  free(begin);
}

#endif
