/* SPDX-License-Identifier: Apache-2.0 */
#include "conduit.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

/* X(result, name, parameters): the functions conduit_NAME, as Conduit declares them; its index type has 64 bits. */
#define CONDUIT_FUNCTIONS(X)                                                                                           \
  X(int, node_has_path, (const ConduitNode *, const char *))                                                           \
  X(ConduitNode *, node_fetch, (ConduitNode *, const char *))                                                          \
  X(int64_t, node_number_of_children, (ConduitNode *))                                                                 \
  X(ConduitNode *, node_child, (ConduitNode *, int64_t))                                                               \
  X(char *, node_name, (const ConduitNode *))                                                                          \
  X(char *, node_as_char8_str, (ConduitNode *))                                                                        \
  X(void *, node_element_ptr, (ConduitNode *, int64_t))                                                                \
  X(const void *, node_dtype, (const ConduitNode *))                                                                   \
  X(void, node_set_path_char8_str, (ConduitNode *, const char *, const char *))                                        \
  X(void, node_set_path_int64, (ConduitNode *, const char *, int64_t))                                                 \
  X(void, node_set_path_float64, (ConduitNode *, const char *, double))                                                \
  X(int64_t, datatype_number_of_elements, (const void *))                                                              \
  X(int64_t, datatype_stride, (const void *))                                                                          \
  X(int, datatype_endianness_matches_machine, (const void *))                                                          \
  X(int, datatype_is_list, (const void *))                                                                             \
  X(int, datatype_is_char8_str, (const void *))                                                                        \
  X(int, datatype_is_int8, (const void *))                                                                             \
  X(int, datatype_is_int16, (const void *))                                                                            \
  X(int, datatype_is_int32, (const void *))                                                                            \
  X(int, datatype_is_int64, (const void *))                                                                            \
  X(int, datatype_is_uint8, (const void *))                                                                            \
  X(int, datatype_is_uint16, (const void *))                                                                           \
  X(int, datatype_is_uint32, (const void *))                                                                           \
  X(int, datatype_is_uint64, (const void *))                                                                           \
  X(int, datatype_is_float32, (const void *))                                                                          \
  X(int, datatype_is_float64, (const void *))

static struct {
#define MEMBER(result, name, parameters) result(*name) parameters;
  CONDUIT_FUNCTIONS(MEMBER)
#undef MEMBER
} conduit;

static const char prefix[] = "catalyst_";

static bool find(void *library, const char *name, void *function) {
  char symbol[128];
  snprintf(symbol, sizeof symbol, "%sconduit_%s", prefix, name);
  void *found = dlsym(library, symbol);
  if (!found)
    found = dlsym(library, symbol + sizeof prefix - 1);
  memcpy(function, &found, sizeof found);
  return found != NULL;
}

/* The name of the first function that is missing there; NULL: none is. */
static const char *find_all(void *library) {
#define FIND(result, name, parameters)                                                                                 \
  if (!find(library, #name, &conduit.name))                                                                            \
    return #name;
  CONDUIT_FUNCTIONS(FIND)
#undef FIND
  return NULL;
}

bool conduit_bind(void *caller) {
  Dl_info info;
  void *library = dladdr(caller, &info) && info.dli_fname ? dlopen(info.dli_fname, RTLD_NOLOAD | RTLD_LAZY) : NULL;
  const char *missing = library ? find_all(library) : "";
  if (library)
    dlclose(library); /* it is in use for as long as it calls */
  if (missing)
    missing = find_all(RTLD_DEFAULT);
  if (!missing)
    return true;
  cli_error("the Catalyst that has loaded tetcast has no function %sconduit_%s, nor conduit_%s", prefix, missing,
            missing);
  return false;
}

/* Conduit's functions take what they only read without const as well. */
static ConduitNode *loose(const ConduitNode *node) {
  ConduitNode *result;
  memcpy(&result, &node, sizeof result);
  return result;
}

ConduitNode *conduit_at(const ConduitNode *node, const char *path) {
  return node && conduit.node_has_path(node, path) ? conduit.node_fetch(loose(node), path) : NULL;
}

int64_t conduit_children(const ConduitNode *node) {
  return node ? conduit.node_number_of_children(loose(node)) : 0;
}

ConduitNode *conduit_child(const ConduitNode *node, int64_t i) {
  return conduit.node_child(loose(node), i);
}

bool conduit_is_list(const ConduitNode *node) {
  return conduit.datatype_is_list(conduit.node_dtype(node));
}

char *conduit_name(const ConduitNode *node) {
  char *name = conduit.node_name(node);
  return name ? name : cli_duplicate("");
}

const char *conduit_text(const ConduitNode *node) {
  return node && conduit.datatype_is_char8_str(conduit.node_dtype(node)) ? conduit.node_as_char8_str(loose(node))
                                                                         : NULL;
}

static ViewType type_of(const void *type) {
  return conduit.datatype_is_float64(type)   ? VIEW_FLOAT64
         : conduit.datatype_is_float32(type) ? VIEW_FLOAT32
         : conduit.datatype_is_int32(type)   ? VIEW_INT32
         : conduit.datatype_is_int64(type)   ? VIEW_INT64
         : conduit.datatype_is_uint8(type)   ? VIEW_UINT8
         : conduit.datatype_is_uint32(type)  ? VIEW_UINT32
         : conduit.datatype_is_uint64(type)  ? VIEW_UINT64
         : conduit.datatype_is_int8(type)    ? VIEW_INT8
         : conduit.datatype_is_int16(type)   ? VIEW_INT16
         : conduit.datatype_is_uint16(type)  ? VIEW_UINT16
                                             : VIEW_NONE;
}

bool conduit_view(const ConduitNode *node, View *view) {
  *view = (View){.data = NULL};
  const void *type = node ? conduit.node_dtype(node) : NULL;
  if (!type || (view->type = type_of(type)) == VIEW_NONE)
    return false;
  if (!conduit.datatype_endianness_matches_machine(type)) {
    view->type = VIEW_NONE;
    return false;
  }
  view->count = conduit.datatype_number_of_elements(type);
  view->stride = conduit.datatype_stride(type);
  view->data = view->count > 0 ? conduit.node_element_ptr(loose(node), 0) : NULL;
  return view->count >= 0 && (view->data || view->count == 0);
}

bool conduit_number(const ConduitNode *node, double *value) {
  View view;
  if (!conduit_view(node, &view) || view.count < 1)
    return false;
  *value = view_value(&view, 0);
  return true;
}

bool conduit_integer(const ConduitNode *node, int64_t *value) {
  View view;
  if (!conduit_view(node, &view) || view.count < 1)
    return false;
  const double number = view_value(&view, 0);
  if (view_is_real(&view) && !(number >= -0x1p53 && number <= 0x1p53 && number == (double)(int64_t)number))
    return false;
  *value = view_is_real(&view) ? (int64_t)number : view_index(&view, 0);
  return true;
}

void conduit_set_text(ConduitNode *node, const char *path, const char *text) {
  conduit.node_set_path_char8_str(node, path, text);
}

void conduit_set_integer(ConduitNode *node, const char *path, int64_t value) {
  conduit.node_set_path_int64(node, path, value);
}

void conduit_set_number(ConduitNode *node, const char *path, double value) {
  conduit.node_set_path_float64(node, path, value);
}
