/* SPDX-License-Identifier: Apache-2.0 */
#define PSI_LANES psi_avx2
#include "psi_lanes.h"
