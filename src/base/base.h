/* SPDX-License-Identifier: Apache-2.0 */
/* The context, messages, and the functions by which all memory of the library is allocated and freed. */
#ifndef TC_BASE_BASE_H
#define TC_BASE_BASE_H

#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <tetcast/array.h>
#include <tetcast/context.h>

struct TetcastContext {
  TetcastMessageFunction *message;
  void *message_user;
  TetcastAllocateFunction *allocate;
  TetcastReleaseFunction *release;
  void *memory_user;
  atomic_int threads; /* 0: all processors */
};

/* What each …_desc_default() writes into `cookie`, so that a struct which was not made by it is told apart. */
enum { TC_COOKIE = 0x7e7ca57 };

TetcastStatus tc_context_create(const TetcastContextDesc *desc, TetcastContext **context);
void tc_context_destroy(TetcastContext *context);
int tc_context_threads(const TetcastContext *context);

void tc_message_v(TetcastContext *context, TetcastSeverity severity, const char *format, va_list arguments);
/* Sends an error message and returns `status`. */
TetcastStatus tc_error(TetcastContext *context, TetcastStatus status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;
void tc_warning(TetcastContext *context, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/* Memory for `count` things of `size` bytes, aligned to 64, not cleared; NULL when there is none (or the product
 * overflows). At least one byte is allocated, so that NULL always means failure. */
void *tc_allocate(TetcastContext *context, int64_t count, size_t size);
void tc_release(TetcastContext *context, void *memory); /* NULL does nothing */

/* As tc_allocate(), but reports failure: returns false and sends a message that names `what`. */
bool tc_allocate_array(TetcastContext *context, void **array, int64_t count, size_t size, const char *what);

/* ── views of typed arrays ── */

size_t tc_type_size(TetcastType type); /* 0 if there is no such type */
bool tc_type_is_float(TetcastType type);
/* The bytes from tuple to tuple of an array of so many components. */
int64_t tc_array_stride(const TetcastArray *array, int components);
double tc_array_double(const TetcastArray *array, int64_t stride, int64_t i, int component);
int64_t tc_array_int64(const TetcastArray *array, int64_t stride, int64_t i, int component); /* integer types only */

/* Keeps `source` as `ownership` says: *view refers to it, or to a packed copy in *memory (NULL when borrowed). */
TetcastStatus tc_array_keep(TetcastContext *context, const TetcastArray *source, int components,
                            TetcastOwnership ownership, const char *what, TetcastArray *view, void **memory);

#endif
