/* SPDX-License-Identifier: Apache-2.0 */
#define PACKET_KERNEL tc_kernel_baseline
#define PACKET_CAST tc_packet_baseline
#include "render/packet_tmpl.h"
