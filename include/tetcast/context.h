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
 * count) whatever that of the calling thread is, which comes back as it was, flags included.
 * - Stack: less than 32 KiB of the calling thread's. Long work is done on threads of the library's own, which live no
 * longer than the call and take no signals, while the calling one waits. Where the system lets no thread start, the
 * calling one does the work alone; that takes up to 256 KiB.
 * - Threads: as many as there are. What can't be started is done without, and changes no bit of a result. */
typedef struct TetcastContext TetcastContext;

typedef enum TetcastSeverity {
  TETCAST_SEVERITY_ERROR,   /* the call fails; its status says how */
  TETCAST_SEVERITY_WARNING, /* the call goes on; something about the input is worth knowing */
  TETCAST_SEVERITY_INFO
} TetcastSeverity;

/* Receives one line of UTF-8 without newline; `text` is valid during the call only. It comes on the thread that made
 * the call which the message is about, in that thread's own floating-point environment; from several at a time when
 * several threads make calls with this context. It must return: no exception, no longjmp(). */
typedef void TetcastMessageFunction(void *user, TetcastSeverity severity, const char *text);

/* `size` > 0 bytes aligned to `alignment` (a power of two ≤ 64), or NULL. Called from any thread. */
typedef void *TetcastAllocateFunction(void *user, size_t size, size_t alignment);
/* Gives back what the allocate function returned; never called with NULL. */
typedef void TetcastReleaseFunction(void *user, void *memory);

/* Called now and then during long work, on the thread that made the call and in its own floating-point environment,
 * with the fraction done in [0, 1], non-decreasing within one call, a thousand times at most. It must return, too.
 * Return false to cancel: the call then soon ends with TETCAST_ERROR_CANCELLED. */
typedef bool TetcastProgressFunction(void *user, double fraction);

typedef struct TetcastProgress {
  TetcastProgressFunction *function; /* NULL: none */
  void *user;
} TetcastProgress;

typedef struct TetcastContextDesc {
  uint32_t cookie; /* set by tetcast_context_desc_default(); catches an uninitialised struct */
  int threads;     /* how many threads may work in a call, while the caller's waits; 0: as many as processors */
  TetcastMessageFunction *message; /* NULL: messages are dropped */
  void *message_user;
  TetcastAllocateFunction *allocate; /* both or neither; NULL: the C library's. Embree, VTK, TetGen and OpenImageIO */
  TetcastReleaseFunction *release;   /* allocate for themselves. */
  void *memory_user;
} TetcastContextDesc;

TETCAST_API TetcastContextDesc tetcast_context_desc_default(void);

/* Makes a context. `desc` may be NULL (defaults). Any thread. */
TETCAST_API TetcastStatus tetcast_context_create(const TetcastContextDesc *desc, TetcastContext **context);

/* Frees the context and sets *context to NULL. NULL and pointer to NULL do nothing. */
TETCAST_API void tetcast_context_destroy(TetcastContext **context);

/* Changes the number of threads for calls that start later (0: all processors). Results do not depend on it. */
TETCAST_API TetcastStatus tetcast_context_set_threads(TetcastContext *context, int threads);

/* The number of threads in force, ≥ 1. */
TETCAST_API int tetcast_context_threads(const TetcastContext *context);

/* For the adapters and for clients that want their own words in the same stream: sends a printf-formatted message
 * to the context's callback and returns `status`, so that `return tetcast_context_error(…)` reads well.
 * `context` may be NULL (nothing is sent). */
TETCAST_API TetcastStatus tetcast_context_error(TetcastContext *context, TetcastStatus status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;
TETCAST_API void tetcast_context_message(TetcastContext *context, TetcastSeverity severity, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;

#ifdef __cplusplus
}
#endif

#endif
