/* SPDX-License-Identifier: Apache-2.0 */
/* What every function of the public boundary begins with. */
#ifndef TC_BASE_BOUNDARY_H
#define TC_BASE_BOUNDARY_H

#include <tetcast/tetcast.h>

#include "base/base.h"
#include "base/call.h"

#define ARGUMENT(context, ...) tc_error(context, TETCAST_ERROR_ARGUMENT, __VA_ARGS__)

/* The checks that every function which makes something begins with. */
#define CHECK_OUT(context, out)                                                                                        \
  do {                                                                                                                 \
    if (!(out))                                                                                                        \
      return ARGUMENT(context, "%s: no place for the result", __func__);                                               \
    *(out) = NULL;                                                                                                     \
  } while (0)
#define CHECK_GIVEN(context, pointer)                                                                                  \
  do {                                                                                                                 \
    if (!(pointer))                                                                                                    \
      return ARGUMENT(context, "%s: " #pointer " is NULL", __func__);                                                  \
  } while (0)
#define CHECK_DESC(context, desc)                                                                                      \
  do {                                                                                                                 \
    CHECK_GIVEN(context, desc);                                                                                        \
    if ((desc)->cookie != TC_COOKIE) {                                                                                 \
      return ARGUMENT(context, "%s: the description was not made with its ..._default() function", __func__);          \
    }                                                                                                                  \
  } while (0)

#endif
