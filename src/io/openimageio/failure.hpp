// SPDX-License-Identifier: Apache-2.0
// What goes wrong when images are written, and how it is told.
#ifndef TETCAST_OPENIMAGEIO_FAILURE_HPP
#define TETCAST_OPENIMAGEIO_FAILURE_HPP

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <string>
#include <system_error>

#include <tetcast/context.h>

namespace tetcast {

// One error, already sent to the context.
struct Failure {
  TetcastStatus status;
};

[[noreturn]] inline void fail(TetcastContext *context, TetcastStatus status, const char *path,
                              const std::string &reason) {
  tetcast_context_error(context, status, "cannot write image '%s': %s", path, reason.c_str());
  throw Failure{status};
}

inline std::string error_text(int error) {
  switch (error) {
  case ENOENT:
    return "its folder does not exist";
  case EINVAL:
    return "it exists and is not a regular file";
  default:
    return std::strerror(error);
  }
}

// After the last byte: fails with the system's error, or with what OpenImageIO said, unless all was written.
inline void check_written(TetcastContext *context, const char *path, std::string reason, int error, bool done) {
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  if (error != 0)
    fail(context, TETCAST_ERROR_IO, path, error_text(error));
  if (!done)
    fail(context, TETCAST_ERROR_IO, path, reason.empty() ? "OpenImageIO failed without saying why" : reason);
}

// Writes, and turns every exception into a status and a message.
template <class Write> TetcastStatus guard_writing(TetcastContext *context, const char *path, Write write) {
  try {
    write();
    return TETCAST_OK;
  } catch (const Failure &failure) {
    return failure.status;
  } catch (const std::bad_alloc &) {
    return tetcast_context_error(context, TETCAST_ERROR_MEMORY, "cannot write image '%s': out of memory", path);
  } catch (const std::system_error &error) {
    const bool no_thread = error.code() == std::errc::resource_unavailable_try_again;
    return tetcast_context_error(
        context, TETCAST_ERROR_IO, "cannot write image '%s': %s%s", path, error.what(),
        no_thread ? ": OpenImageIO needs a thread of its own for this format; .png and .jpg don't" : "");
  } catch (const std::exception &error) {
    return tetcast_context_error(context, TETCAST_ERROR_IO, "cannot write image '%s': %s", path, error.what());
  } catch (...) {
    return tetcast_context_error(context, TETCAST_ERROR_IO, "cannot write image '%s': unknown failure", path);
  }
}

} // namespace tetcast

#endif
