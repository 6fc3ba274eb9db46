/* SPDX-License-Identifier: Apache-2.0 */
#define PSI_LANES psi_baseline
#include "psi_lanes.h"
