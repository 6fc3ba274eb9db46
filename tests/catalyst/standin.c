/* SPDX-License-Identifier: Apache-2.0 */
#include "standin.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Node {
  char *name;
  struct Node **children; /* [count] */
  int64_t count;
  bool list;
  StandinType type;
  char *data;
  bool own, swapped;
  int64_t elements, stride;
} Node;

static void stop(const char *what) {
  fprintf(stderr, "stand-in: %s\n", what);
  abort();
}

static const int sizes[] = {0, 1, 2, 4, 8, 1, 2, 4, 8, 4, 8, 1};

int standin_size(StandinType type) {
  return sizes[type];
}

conduit_node *conduit_node_create(void) {
  return calloc(1, sizeof(Node));
}

static void clear_leaf(Node *node) {
  if (node->own)
    free(node->data);
  node->data = NULL;
  node->own = false;
  node->type = STANDIN_EMPTY;
  node->elements = 0;
}

void conduit_node_destroy(conduit_node *pointer) {
  Node *node = pointer;
  for (int64_t i = 0; i < node->count; i++)
    conduit_node_destroy(node->children[i]);
  clear_leaf(node);
  free(node->children);
  free(node->name);
  free(node);
}

static Node *add(Node *node, char *name) {
  clear_leaf(node);
  Node *child = conduit_node_create();
  child->name = name;
  node->children = realloc(node->children, sizeof *node->children * (size_t)(node->count + 1));
  return node->children[node->count++] = child;
}

static Node *find(const Node *node, const char *name, size_t length) {
  for (int64_t i = 0; i < node->count; i++)
    if (node->children[i]->name && strlen(node->children[i]->name) == length &&
        !strncmp(node->children[i]->name, name, length))
      return node->children[i];
  return NULL;
}

conduit_node *conduit_node_fetch(conduit_node *pointer, const char *path) {
  Node *node = pointer;
  while (*path) {
    const size_t length = strcspn(path, "/");
    Node *child = find(node, path, length);
    node = child ? child : add(node, strndup(path, length));
    path += length + (path[length] == '/');
  }
  return node;
}

conduit_node *conduit_node_append(conduit_node *pointer) {
  Node *child = add(pointer, NULL);
  ((Node *)pointer)->list = true;
  return child;
}

int conduit_node_has_path(const conduit_node *pointer, const char *path) {
  const Node *node = pointer;
  while (node && *path) {
    const size_t length = strcspn(path, "/");
    node = find(node, path, length);
    path += length + (path[length] == '/');
  }
  return node != NULL;
}

conduit_index_t conduit_node_number_of_children(conduit_node *node) {
  return ((Node *)node)->count;
}

conduit_node *conduit_node_child(conduit_node *node, conduit_index_t i) {
  if (i < 0 || i >= ((Node *)node)->count)
    stop("there is no such child");
  return ((Node *)node)->children[i];
}

char *conduit_node_name(const conduit_node *node) {
  return strdup(((const Node *)node)->name ? ((const Node *)node)->name : "");
}

char *conduit_node_as_char8_str(conduit_node *node) {
  if (((Node *)node)->type != STANDIN_TEXT)
    stop("as_char8_str() of what is no text");
  return ((Node *)node)->data;
}

void *conduit_node_element_ptr(conduit_node *pointer, conduit_index_t i) {
  Node *node = pointer;
  if (node->type == STANDIN_EMPTY || i < 0 || i >= node->elements)
    stop("there is no such element");
  return node->data + i * node->stride;
}

const conduit_datatype *conduit_node_dtype(const conduit_node *node) {
  return node;
}

void standin_set(conduit_node *pointer, const char *path, StandinType type, void *data, int64_t count, int64_t stride) {
  Node *node = conduit_node_fetch(pointer, path);
  if (node->count > 0)
    stop("a leaf in place of an object");
  clear_leaf(node);
  node->type = type;
  node->data = data;
  node->elements = count;
  node->stride = stride ? stride : sizes[type];
}

void standin_swap(conduit_node *node, const char *path) {
  ((Node *)conduit_node_fetch(node, path))->swapped = true;
}

static void set_own(conduit_node *node, const char *path, StandinType type, const void *data, int64_t count) {
  const size_t size = (size_t)count * (size_t)sizes[type];
  void *copy = memcpy(malloc(size), data, size);
  standin_set(node, path, type, copy, count, 0);
  ((Node *)conduit_node_fetch(node, path))->own = true;
}

void standin_shorten(conduit_node *node) {
  ((Node *)node)->elements--;
}

void standin_copy(conduit_node *to, const conduit_node *pointer) {
  const Node *from = pointer;
  if (from->own)
    set_own(to, "", from->type, from->data, from->elements);
  else if (from->type != STANDIN_EMPTY)
    standin_set(to, "", from->type, from->data, from->elements, from->stride);
}

void conduit_node_set_path_char8_str(conduit_node *node, const char *path, const char *text) {
  set_own(node, path, STANDIN_TEXT, text, (int64_t)strlen(text) + 1);
}

void conduit_node_set_path_int64(conduit_node *node, const char *path, int64_t value) {
  set_own(node, path, STANDIN_INT64, &value, 1);
}

void conduit_node_set_path_float64(conduit_node *node, const char *path, double value) {
  set_own(node, path, STANDIN_FLOAT64, &value, 1);
}

void conduit_node_set_path_external_float64_ptr(conduit_node *node, const char *path, double *data,
                                                conduit_index_t count) {
  standin_set(node, path, STANDIN_FLOAT64, data, count, 0);
}

void conduit_node_set_path_external_int32_ptr(conduit_node *node, const char *path, int32_t *data,
                                              conduit_index_t count) {
  standin_set(node, path, STANDIN_INT32, data, count, 0);
}

conduit_index_t conduit_datatype_number_of_elements(const conduit_datatype *type) {
  return ((const Node *)type)->elements;
}

conduit_index_t conduit_datatype_stride(const conduit_datatype *type) {
  return ((const Node *)type)->stride;
}

int conduit_datatype_endianness_matches_machine(const conduit_datatype *type) {
  return !((const Node *)type)->swapped;
}

int conduit_datatype_is_list(const conduit_datatype *type) {
  return ((const Node *)type)->list;
}

#define IS(name, which)                                                                                                \
  int conduit_datatype_is_##name(const conduit_datatype *type) {                                                       \
    return ((const Node *)type)->type == STANDIN_##which;                                                              \
  }
IS(char8_str, TEXT)
IS(int8, INT8)
IS(int16, INT16)
IS(int32, INT32)
IS(int64, INT64)
IS(uint8, UINT8)
IS(uint16, UINT16)
IS(uint32, UINT32)
IS(uint64, UINT64)
IS(float32, FLOAT32)
IS(float64, FLOAT64)

/* ── MPI ── */

#ifndef STANDIN_WITHOUT_MPI

int standin_processes = 1;
static int world;

void *MPI_Comm_f2c(int communicator) {
  return communicator == 9 ? &world : NULL;
}

int MPI_Comm_size(void *communicator, int *size) {
  *size = standin_processes;
  return communicator != &world;
}

#endif

/* ── Catalyst: how its library finds an implementation by name ── */

struct catalyst_impl {
  int version;
  int (*initialize)(const conduit_node *);
  int (*execute)(const conduit_node *);
  int (*finalize)(const conduit_node *);
  int (*about)(conduit_node *);
  int (*results)(conduit_node *);
};

static const struct catalyst_impl *implementation;

static int load(void) {
  const char *name = getenv("CATALYST_IMPLEMENTATION_NAME"), *paths = getenv("CATALYST_IMPLEMENTATION_PATHS");
  char file[4096];
  if (!name || !paths)
    return 2;
  snprintf(file, sizeof file, "%s/libcatalyst-%s.so", paths, name);
  void *library = dlopen(file, RTLD_LAZY | RTLD_GLOBAL);
  if (!library) {
    fprintf(stderr, "stand-in: %s\n", dlerror());
    return 2;
  }
  implementation = dlsym(library, "catalyst_api_impl");
  if (!implementation)
    return 3;
  if (implementation->version != 1)
    return 6;
  return implementation->initialize && implementation->execute && implementation->finalize && implementation->about &&
                 implementation->results
             ? 0
             : 5;
}

int catalyst_initialize(const conduit_node *params) {
  const int code = implementation ? 0 : load();
  return code ? code : implementation->initialize(params);
}

int catalyst_execute(const conduit_node *params) {
  return implementation ? implementation->execute(params) : 1;
}

int catalyst_finalize(const conduit_node *params) {
  return implementation ? implementation->finalize(params) : 1;
}

int catalyst_about(conduit_node *params) {
  return implementation ? implementation->about(params) : 1;
}

int catalyst_results(conduit_node *params) {
  return implementation ? implementation->results(params) : 1;
}
