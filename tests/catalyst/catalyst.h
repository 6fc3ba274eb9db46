/* SPDX-License-Identifier: Apache-2.0 */
/* What programs include of Catalyst. */
#include "standin.h"
