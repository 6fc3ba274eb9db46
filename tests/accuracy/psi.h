/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PSI_H
#define PSI_H

#include <stdint.h>

#include "optics/segment.h"

/* tc_segment() of `count` segments by the packets' code. */
typedef void PsiLanes(const double *a, const double *a1, int64_t count, TcSegment *out);
PsiLanes psi_baseline, psi_avx2, psi_avx512;

#endif
