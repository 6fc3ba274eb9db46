/* SPDX-License-Identifier: Apache-2.0 */
#define _DEFAULT_SOURCE /* madvise */
#include "base/base.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { ALIGNMENT = 64 };

/* Large blocks come from the system and go back to it at once, where malloc() may keep what is freed; in huge pages if
 * there are any, which saves a tenth to a half of the time of preparing a mesh. What AddressSanitizer watches stays
 * with it. */
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
enum { LARGE = 1 << 20, HUGE_FROM = 1 << 24 };

static void *c_allocate(void *user, size_t size, size_t alignment) {
  (void)user;
  if (size > SIZE_MAX / 2)
    return NULL;
  const size_t whole =
      (size + 2 * alignment - 1) / alignment * alignment; /* a line before the block holds the size of the mapping */
  char *block;
  if (whole >= LARGE) {
    block = mmap(NULL, whole, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED)
      return NULL;
    if (whole >= HUGE_FROM)
      madvise(block, whole, MADV_HUGEPAGE);
  } else {
    block = aligned_alloc(alignment, whole);
    if (!block)
      return NULL;
  }
  *(size_t *)(void *)block = whole >= LARGE ? whole : 0;
  return block + alignment;
}

static void c_release(void *user, void *memory) {
  (void)user;
  char *block = (char *)memory - ALIGNMENT;
  const size_t mapped = *(const size_t *)(const void *)block;
  if (mapped)
    munmap(block, mapped);
  else
    free(block);
}
#else
static void *c_allocate(void *user, size_t size, size_t alignment) {
  (void)user;
  if (size > SIZE_MAX - alignment)
    return NULL;
  return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void c_release(void *user, void *memory) {
  (void)user;
  free(memory);
}
#endif

TetcastStatus tc_context_create(const TetcastContextDesc *desc, TetcastContext **out) {
  TetcastAllocateFunction *allocate = desc->allocate ? desc->allocate : c_allocate;
  TetcastContext *context = allocate(desc->memory_user, sizeof *context, ALIGNMENT);
  if (!context)
    return TETCAST_ERROR_MEMORY;
  context->message = desc->message;
  context->message_user = desc->message_user;
  context->allocate = allocate;
  context->release = desc->release ? desc->release : c_release;
  context->memory_user = desc->memory_user;
  atomic_init(&context->threads, desc->threads);
  *out = context;
  return TETCAST_OK;
}

void tc_context_destroy(TetcastContext *context) {
  if (context)
    context->release(context->memory_user, context);
}

int tc_context_threads(const TetcastContext *context) {
  int threads = atomic_load(&context->threads);
  if (threads > 0)
    return threads;
  const long processors = sysconf(_SC_NPROCESSORS_ONLN);
  return processors < 1 ? 1 : processors > 1024 ? 1024 : (int)processors;
}

void *tc_allocate(TetcastContext *context, int64_t count, size_t size) {
  if (count < 0 || (size != 0 && (uint64_t)count > (SIZE_MAX - ALIGNMENT) / size))
    return NULL;
  const size_t bytes = (size_t)count * size;
  return context->allocate(context->memory_user, bytes ? bytes : 1, ALIGNMENT);
}

void tc_release(TetcastContext *context, void *memory) {
  if (memory)
    context->release(context->memory_user, memory);
}

bool tc_allocate_array(TetcastContext *context, void **array, int64_t count, size_t size, const char *what) {
  *array = tc_allocate(context, count, size);
  if (!*array)
    tc_error(context, TETCAST_ERROR_MEMORY, "out of memory: %s (%" PRId64 " × %zu bytes)", what, count, size);
  return *array != NULL;
}

/* ── arrays ── */

size_t tc_type_size(TetcastType type) {
  switch (type) {
  case TETCAST_TYPE_FLOAT32:
  case TETCAST_TYPE_INT32:
  case TETCAST_TYPE_UINT32:
    return 4;
  case TETCAST_TYPE_FLOAT64:
  case TETCAST_TYPE_INT64:
  case TETCAST_TYPE_UINT64:
    return 8;
  case TETCAST_TYPE_NONE:
    break;
  }
  return 0;
}

bool tc_type_is_float(TetcastType type) {
  return type == TETCAST_TYPE_FLOAT32 || type == TETCAST_TYPE_FLOAT64;
}

int64_t tc_array_stride(const TetcastArray *array, int components) {
  return array->stride ? array->stride : (int64_t)tc_type_size(array->type) * components;
}

/* Elements are read through memcpy: strided arrays need not be aligned. */
#define READ(type_name, variable)                                                                                      \
  type_name variable;                                                                                                  \
  memcpy(&variable, element, sizeof variable)

double tc_array_double(const TetcastArray *array, int64_t stride, int64_t i, int component) {
  const char *element = (const char *)array->data + i * stride + (int64_t)tc_type_size(array->type) * component;
  if (array->type == TETCAST_TYPE_FLOAT64) {
    READ(double, value);
    return value;
  }
  if (array->type == TETCAST_TYPE_FLOAT32) {
    READ(float, value);
    return (double)value;
  }
  if (array->type == TETCAST_TYPE_UINT64) {
    READ(uint64_t, value);
    return (double)value;
  }
  return (double)tc_array_int64(array, stride, i, component);
}

int64_t tc_array_int64(const TetcastArray *array, int64_t stride, int64_t i, int component) {
  const char *element = (const char *)array->data + i * stride + (int64_t)tc_type_size(array->type) * component;
  switch (array->type) {
  case TETCAST_TYPE_INT32: {
    READ(int32_t, value);
    return value;
  }
  case TETCAST_TYPE_UINT32: {
    READ(uint32_t, value);
    return value;
  }
  case TETCAST_TYPE_INT64: {
    READ(int64_t, value);
    return value;
  }
  case TETCAST_TYPE_UINT64: {
    READ(uint64_t, value);
    return value > INT64_MAX ? INT64_MAX : (int64_t)value; /* out of any index range, and stays so */
  }
  default:
    return 0;
  }
}

TetcastStatus tc_array_keep(TetcastContext *context, const TetcastArray *source, int components,
                            TetcastOwnership ownership, const char *what, TetcastArray *view, void **memory) {
  *view = *source;
  *memory = NULL;
  const int64_t stride = tc_array_stride(source, components);
  view->stride = stride;
  if (ownership == TETCAST_BORROW)
    return TETCAST_OK;
  const size_t tuple = tc_type_size(source->type) * (size_t)components;
  if (!tc_allocate_array(context, memory, source->count, tuple, what))
    return TETCAST_ERROR_MEMORY;
  if (stride == (int64_t)tuple) {
    if (source->count)
      memcpy(*memory, source->data, (size_t)source->count * tuple);
  } else {
    for (int64_t i = 0; i < source->count; ++i) {
      memcpy((char *)*memory + i * (int64_t)tuple, (const char *)source->data + i * stride, tuple);
    }
  }
  view->data = *memory;
  view->stride = (int64_t)tuple;
  return TETCAST_OK;
}
