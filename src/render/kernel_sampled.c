/* SPDX-License-Identifier: Apache-2.0 */
#include "optics/sampled.h"

#define ADD_POINT(light, pieces, length, s0, s1) tc_light_add_sampled(light, pieces, worker->sampler, length, s0, s1)
#define CAST tc_cast_sampled
#define KERNEL tc_kernel_sampled
#include "render/kernel_tmpl.h"
