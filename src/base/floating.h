/* SPDX-License-Identifier: Apache-2.0 */
/* The floating-point environment: how results are rounded, which exceptions are trapped, whether denormal numbers
 * count, and the flags. A host may have set any of it as it likes; the library computes in the default one and gives
 * the host's back as it was. */
#ifndef TC_BASE_FLOATING_H
#define TC_BASE_FLOATING_H

#include <fenv.h>
#include <stdint.h>

#if defined(__x86_64__) && defined(__GNUC__)

#include <xmmintrin.h>

/* SSE computes with double and float; its control bits and flags are one register. The x87, which is hardly used, is
 * only changed if its control word isn't the default one. fegetenv() and fesetenv() would take fifteen times as long,
 * too long for functions that return one number out of many. */
typedef struct TcFloating {
  uint32_t mxcsr;
  uint16_t control, status; /* x87 */
} TcFloating;

enum { TC_DEFAULT_MXCSR = 0x1f80, TC_DEFAULT_X87 = 0x37f, TC_X87_FLAGS = 0xff };

/* Keeps the present environment in *floating, and sets the default one. */
static inline void tc_floating_begin(TcFloating *floating) {
  floating->mxcsr = _mm_getcsr();
  __asm__ volatile("fnstcw %0" : "=m"(floating->control));
  __asm__ volatile("fnstsw %0" : "=m"(floating->status));
  _mm_setcsr(TC_DEFAULT_MXCSR);
  if (floating->control == TC_DEFAULT_X87)
    return;
  const uint16_t control = TC_DEFAULT_X87;
  __asm__ volatile("fldcw %0" : : "m"(control));
}

/* Sets the environment that was kept. */
static inline void tc_floating_end(const TcFloating *floating) {
  uint16_t control, status;
  __asm__ volatile("fnstcw %0" : "=m"(control));
  __asm__ volatile("fnstsw %0" : "=m"(status));
  if (control != floating->control || ((status ^ floating->status) & TC_X87_FLAGS)) {
    uint16_t environment[14]; /* 28 bytes: control, -, status, -, … */
    __asm__ volatile("fnstenv %0" : "=m"(environment));
    environment[0] = floating->control;
    environment[2] = (uint16_t)((environment[2] & ~TC_X87_FLAGS) | (floating->status & TC_X87_FLAGS));
    __asm__ volatile("fldenv %0" : : "m"(environment));
  }
  _mm_setcsr(floating->mxcsr);
}

#else

typedef struct TcFloating {
  fenv_t environment;
} TcFloating;

static inline void tc_floating_begin(TcFloating *floating) {
  fegetenv(&floating->environment);
  fesetenv(FE_DFL_ENV);
}

static inline void tc_floating_end(const TcFloating *floating) {
  fesetenv(&floating->environment);
}

#endif

#endif
