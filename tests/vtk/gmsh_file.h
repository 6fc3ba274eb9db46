/* SPDX-License-Identifier: Apache-2.0 */
/* Writes Gmsh's files: MSH 2.2 and 4.1, as text or as bytes of either order. */
#ifndef TEST_VTK_GMSH_FILE_H
#define TEST_VTK_GMSH_FILE_H

#include <inttypes.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef enum GmshEncoding { GMSH_TEXT, GMSH_LITTLE, GMSH_BIG } GmshEncoding;

typedef struct GmshFile {
  FILE *file;
  int version; /* 2 or 4 */
  GmshEncoding encoding;
} GmshFile;

static inline void gmsh_text(GmshFile *to, const char *format, ...) __attribute__((format(printf, 2, 3)));
static inline void gmsh_text(GmshFile *to, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vfprintf(to->file, format, arguments);
  va_end(arguments);
}

static inline void gmsh_bytes(GmshFile *to, const void *value, size_t size) {
  const unsigned char *bytes = (const unsigned char *)value;
  const uint16_t one = 1;
  const int little = *(const unsigned char *)&one;
  for (size_t i = 0; i < size; ++i)
    fputc(bytes[(to->encoding == GMSH_LITTLE) == little ? i : size - 1 - i], to->file);
}

static inline void gmsh_int(GmshFile *to, int32_t value) {
  if (to->encoding)
    gmsh_bytes(to, &value, sizeof value);
  else
    fprintf(to->file, "%" PRId32 " ", value);
}

/* Of nodes and elements, and counts: version 4 has them in eight bytes. */
static inline void gmsh_size(GmshFile *to, int64_t value) {
  if (to->version == 2)
    gmsh_int(to, (int32_t)value);
  else if (to->encoding)
    gmsh_bytes(to, &value, sizeof value);
  else
    fprintf(to->file, "%" PRId64 "\n", value);
}

static inline void gmsh_double(GmshFile *to, double value) {
  if (to->encoding)
    gmsh_bytes(to, &value, sizeof value);
  else
    fprintf(to->file, "%.17g ", value);
}

static inline GmshFile gmsh_open(const char *path, int version, GmshEncoding encoding) {
  GmshFile to = {fopen(path, "wb"), version, encoding};
  gmsh_text(&to, "$MeshFormat\n%s %d 8\n", version == 2 ? "2.2" : "4.1", encoding != GMSH_TEXT);
  if (encoding)
    gmsh_int(&to, 1), gmsh_text(&to, "\n");
  gmsh_text(&to, "$EndMeshFormat\n");
  return to;
}

/* One block; node i has number tags[i]. `parameters`: version 4 has as many more numbers after the coordinates, and
 * calls the block one of an entity of that dimension. */
static inline void gmsh_nodes(GmshFile *to, int64_t count, const int64_t *tags, const double (*p)[3], int parameters) {
  gmsh_text(to, "$Nodes\n");
  if (to->version == 2) {
    gmsh_text(to, "%" PRId64 "\n", count);
  } else {
    const int64_t header[4] = {2, count, 1, 1 << 20};
    for (int i = 0; i < 4; ++i)
      gmsh_size(to, header[i]);
    for (int i = 0; i < 3; ++i)
      gmsh_int(to, i == 0 ? 2 : i); /* an empty block: dimension 2, entity 1, with parameters */
    gmsh_size(to, 0);
    gmsh_int(to, parameters ? parameters : 3);
    gmsh_int(to, 1);
    gmsh_int(to, parameters > 0);
    gmsh_size(to, count);
    for (int64_t i = 0; i < count; ++i)
      gmsh_size(to, tags[i]);
  }
  for (int64_t i = 0; i < count; ++i) {
    if (to->version == 2)
      gmsh_size(to, tags[i]);
    for (int k = 0; k < 3; ++k)
      gmsh_double(to, p[i][k]);
    for (int k = 0; to->version == 4 && k < parameters; ++k)
      gmsh_double(to, 0.5);
    if (!to->encoding)
      gmsh_text(to, "\n");
  }
  gmsh_text(to, "\n$EndNodes\n");
}

typedef struct GmshElement {
  int64_t tag;
  int type, nodes;     /* Gmsh's number of the type, and how many nodes that has */
  int entity, group;   /* version 4: of the entity that gmsh_entities() puts into that group */
  const int64_t *node; /* numbers */
} GmshElement;

/* Surface 1 in no group, volumes 1 … count in these. Nothing in version 2. */
static inline void gmsh_entities(GmshFile *to, int count, const int *groups) {
  if (to->version == 2)
    return;
  gmsh_text(to, "$Entities\n");
  for (int dimension = 0; dimension < 4; ++dimension)
    gmsh_size(to, dimension == 0 ? 1 : dimension == 2 ? 1 : dimension == 3 ? count : 0);
  gmsh_int(to, 7);
  for (int k = 0; k < 3; ++k)
    gmsh_double(to, 0);
  gmsh_size(to, 0);
  for (int i = 0; i <= count; ++i) {
    gmsh_int(to, i == 0 ? 1 : i);
    for (int k = 0; k < 6; ++k)
      gmsh_double(to, k);
    gmsh_size(to, i > 0 && groups[i - 1] ? 2 : 0);
    if (i > 0 && groups[i - 1])
      gmsh_int(to, groups[i - 1]), gmsh_int(to, 99);
    gmsh_size(to, 1); /* bounded by */
    gmsh_int(to, -7);
  }
  gmsh_text(to, "\n$EndEntities\n");
}

/* Each a block of its own. */
static inline void gmsh_elements(GmshFile *to, int64_t count, const GmshElement *elements) {
  gmsh_text(to, "$Elements\n");
  if (to->version == 2) {
    gmsh_text(to, "%" PRId64 "\n", count);
  } else {
    const int64_t header[4] = {count, count, 1, 1 << 20};
    for (int i = 0; i < 4; ++i)
      gmsh_size(to, header[i]);
  }
  for (int64_t i = 0; i < count; ++i) {
    const GmshElement *one = &elements[i];
    if (to->version == 4) {
      gmsh_int(to, one->type <= 3 ? 2 : 3);
      gmsh_int(to, one->entity);
      gmsh_int(to, one->type);
      gmsh_size(to, 1);
      gmsh_size(to, one->tag);
    } else if (to->encoding) {
      const int32_t header[6] = {one->type, 1, 2, (int32_t)one->tag, one->group, one->entity};
      for (int k = 0; k < 6; ++k)
        gmsh_int(to, header[k]);
    } else {
      gmsh_text(to, "%" PRId64 " %d 2 %d %d ", one->tag, one->type, one->group, one->entity);
    }
    for (int k = 0; k < one->nodes; ++k)
      gmsh_size(to, one->node[k]);
    if (!to->encoding)
      gmsh_text(to, "\n");
  }
  gmsh_text(to, "\n$EndElements\n");
}

/* values: [count][components], or of "ElementNodeData" [count][nodes][components]. */
static inline void gmsh_data(GmshFile *to, const char *section, const char *name, double time, int components,
                             int64_t count, const int64_t *tags, int nodes, const double *values) {
  gmsh_text(to, "$%s\n2\n\"%s\"\n\"scheme\"\n1\n%.17g\n3\n0\n%d\n%" PRId64 "\n", section, name, time, components,
            count);
  const int each = (nodes ? nodes : 1) * components;
  for (int64_t i = 0; i < count; ++i) {
    gmsh_int(to, (int32_t)tags[i]);
    if (nodes)
      gmsh_int(to, nodes);
    for (int k = 0; k < each; ++k)
      gmsh_double(to, values[i * each + k]);
    if (!to->encoding)
      gmsh_text(to, "\n");
  }
  gmsh_text(to, "\n$End%s\n", section);
}

#endif
