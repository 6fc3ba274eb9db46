/* SPDX-License-Identifier: Apache-2.0 */
/* Messages to the host, as base.h declares them. */
#include <stdio.h>

#include "base/call.h"

void tc_message_v(TetcastContext *context, TetcastSeverity severity, const char *format, va_list arguments) {
  if (!context || !context->message)
    return;
  char text[1024]; /* no allocation: the message may be about one that failed */
  vsnprintf(text, sizeof text, format, arguments);
  for (char *c = text; *c; ++c) {
    if (*c == '\n' || *c == '\r')
      *c = ' '; /* one line, whatever a file's name or another library's words hold */
  }
  tc_call_message(context, severity, text);
}

TetcastStatus tc_error(TetcastContext *context, TetcastStatus status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  tc_message_v(context, TETCAST_SEVERITY_ERROR, format, arguments);
  va_end(arguments);
  return status;
}

void tc_warning(TetcastContext *context, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  tc_message_v(context, TETCAST_SEVERITY_WARNING, format, arguments);
  va_end(arguments);
}
