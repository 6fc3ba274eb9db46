/* SPDX-License-Identifier: Apache-2.0 */
#define ADD_POINT tc_light_add
#define CAST tc_cast
#define KERNEL tc_kernel_exact
#include "render/kernel_tmpl.h"
