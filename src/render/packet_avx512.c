/* SPDX-License-Identifier: Apache-2.0 */
#define PACKET_KERNEL tc_kernel_avx512
#define PACKET_CAST tc_packet_avx512
#include "render/packet_tmpl.h"
