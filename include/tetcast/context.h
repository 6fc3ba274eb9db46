/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TETCAST_CONTEXT_H
#define TETCAST_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <tetcast/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A context holds what its objects share: where messages go, where memory comes from, how many threads work.
 * It must outlive every object made from it. Objects of one context may be used from several threads as each
 * function documents; objects of different contexts are independent of each other.
 *
 * What the library asks of its host, in every function:
 * - Floating point: nothing. It computes in the default environment (round to nearest, no traps, denormal numbers
 *   count) whatever the calling thread's environment is, and gives that back as it was, flags included.
 * - Stack: less than 32 KiB of the calling thread's. Long work is done on threads of the library's own, while the
 *   calling thread waits; they end with the call and take no signals. Where the system lets no thread start, the
 * calling thread does the work alone, which takes up to 256 KiB.
 * - Threads: as many as can be started. With fewer of them, calls take longer, and results are the same to the bit. */
typedef struct TetcastContext TetcastContext;

/* What kind of message it is. */
typedef enum TetcastSeverity {
  TETCAST_SEVERITY_ERROR,   /* the call fails; its status says how */
  TETCAST_SEVERITY_WARNING, /* the call goes on; something about the input is worth knowing */
  TETCAST_SEVERITY_INFO     /* nothing is wrong */
} TetcastSeverity;

/* Receives a message: one line of UTF-8 without newline; `text` is valid during the call only. It is called on the
 * thread that made the call which the message is about, in that thread's own floating-point environment; so if several
 * threads make calls with this context, it is called from several of them at a time. It must return: no exception, no
 * longjmp(). */
typedef void TetcastMessageFunction(void *user, TetcastSeverity severity, const char *text);

/* Returns `size` > 0 bytes aligned to `alignment` (a power of two ≤ 64), or NULL. Called from any thread. */
typedef void *TetcastAllocateFunction(void *user, size_t size, size_t alignment);
/* Gives back what the allocate function returned; never called with NULL. */
typedef void TetcastReleaseFunction(void *user, void *memory);

/* Called now and then during long work, on the thread that made the call and in its own floating-point environment,
 * with the fraction done in [0, 1], non-decreasing within one call, a thousand times at most, and, but for each tenth,
 * at most once a millisecond. It must return, too. Return false to cancel: the call then soon ends with
 * TETCAST_ERROR_CANCELLED. */
typedef bool TetcastProgressFunction(void *user, double fraction);

/* Who is told how far long work has come. */
typedef struct TetcastProgress {
  /* Is called during long work. NULL (the default): nobody is told. */
  TetcastProgressFunction *function;
  /* Is handed to the function. May be NULL (the default). */
  void *user;
} TetcastProgress;

/* What a context is made from. */
typedef struct TetcastContextDesc {
  /* Set by tetcast_context_desc_default(), so that a struct which was not made by it is told apart. */
  uint32_t cookie;
  /* The number of threads that work in a call, while the calling thread waits; ≥ 0. Default: 0, one per processor. */
  int threads;
  /* Receives messages. NULL (the default): messages are dropped. */
  TetcastMessageFunction *message;
  /* Is handed to the message function. May be NULL (the default). */
  void *message_user;
  /* Allocates the library's memory. Given together with `release`, or NULL (the default) for the C library's functions.
   * Embree, VTK, TetGen and OpenImageIO allocate for themselves. */
  TetcastAllocateFunction *allocate;
  /* Frees what `allocate` has returned. NULL (the default) if and only if `allocate` is NULL. */
  TetcastReleaseFunction *release;
  /* Is handed to `allocate` and `release`. May be NULL (the default). */
  void *memory_user;
} TetcastContextDesc;

/* Makes a desc with every setting at its default. */

TETCAST_API TetcastContextDesc tetcast_context_desc_default(void);

/* Makes a context. `desc` may be NULL (defaults). Any thread. */
TETCAST_API TetcastStatus tetcast_context_create(const TetcastContextDesc *desc, TetcastContext **context);

/* Frees the context and sets *context to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_context_destroy(TetcastContext **context);

/* Changes the number of threads for calls that start later (0: all processors). Results do not depend on it. */
TETCAST_API TetcastStatus tetcast_context_set_threads(TetcastContext *context, int threads);

/* The number of threads in force, ≥ 1. */
TETCAST_API int tetcast_context_threads(const TetcastContext *context);

/* Sends a printf-formatted error message to the context's callback and returns `status`, so that callers can write
 * `return tetcast_context_error(…)`. For the adapters, and for clients that want their own messages to go the same way.
 * `context` may be NULL: nothing is sent then. */
TETCAST_API TetcastStatus tetcast_context_error(TetcastContext *context, TetcastStatus status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Sends a printf-formatted message of any severity likewise. */
TETCAST_API void tetcast_context_message(TetcastContext *context, TetcastSeverity severity, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;

#ifdef __cplusplus
}
#endif

#endif
