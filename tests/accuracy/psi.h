/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PSI_H
#define PSI_H

#include <stdint.h>

#include "optics/segment.h"

/* tc_segment() and tc_segment_moments() of `count` segments by the kernels' code for some lanes (psi_lanes.c). Either
 * result may be NULL; there are no moments in single precision. */
typedef void PsiLanes(const double *a, const double *a1, int64_t count, TcSegment *segments, TcMoments *moments);
PsiLanes psi_one, psi_avx2, psi_avx2_f32, psi_avx512, psi_avx512_f32;

#endif
