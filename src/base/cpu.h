/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TC_BASE_CPU_H
#define TC_BASE_CPU_H

#include <stdbool.h>

#include <tetcast/integrator.h>

/* Whether this processor runs what is compiled for `isa`. */
static inline bool tc_cpu_has(TetcastIsa isa) {
  switch (isa) {
#ifdef TC_HAVE_X86
  case TETCAST_ISA_AVX512:
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("fma");
  case TETCAST_ISA_AVX2:
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
  case TETCAST_ISA_SCALAR:
    return true;
  default:
    return false;
  }
}

#endif
