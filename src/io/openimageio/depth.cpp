// SPDX-License-Identifier: Apache-2.0
// Depths from images of other programs.
#include <tetcast/image.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include <OpenImageIO/imageio.h>

#include "io/floating.hpp"

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

namespace {

TetcastStatus refuse(TetcastContext *context, TetcastStatus status, const char *path, std::string reason) {
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return tetcast_context_error(context, status, "cannot read depths from '%s': %s", path, reason.c_str());
}

bool ends_with(const std::string &text, const std::string &tail) {
  return text.size() >= tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
}

// The place of a channel that is called so; −1: there is none.
int channel_named(const ImageSpec &spec, bool whole) {
  for (int i = 0; i < spec.nchannels; ++i)
    if (whole ? spec.channelnames[size_t(i)] == "Z" : ends_with(spec.channelnames[size_t(i)], ".Z"))
      return i;
  return -1;
}

// Goes to the part of the file with the channel, and says which it is.
int find_channel(ImageInput &input) {
  for (const bool whole : {true, false})
    for (int part = 0; input.seek_subimage(part, 0); ++part)
      if (const int channel = channel_named(input.spec(), whole); channel >= 0)
        return channel;
  input.seek_subimage(0, 0);
  return 0;
}

bool is_float(const TypeDesc &type) {
  return type == TypeDesc::HALF || type == TypeDesc::FLOAT || type == TypeDesc::DOUBLE;
}

TetcastStatus read_depth(TetcastContext *context, const char *path, int64_t width, int64_t height, double *depth) {
  std::error_code error; // what isn't there is said by OpenImageIO
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    return refuse(context, TETCAST_ERROR_IO, path, "it is not a regular file");
  const std::unique_ptr<ImageInput> input = ImageInput::open(path);
  if (!input) {
    const std::string reason = OIIO::geterror();
    return refuse(context, TETCAST_ERROR_IO, path, reason.empty() ? "OpenImageIO failed without saying why" : reason);
  }
  input->threads(tetcast_context_threads(context));
  const int channel = find_channel(*input);
  const ImageSpec &spec = input->spec();
  (void)input->geterror(); // of parts that there are not
  if (spec.deep)
    return refuse(context, TETCAST_ERROR_DATA, path, "its pixels are deep: expected one depth a pixel");
  if (spec.width != width || spec.height != height || spec.depth > 1)
    return refuse(context, TETCAST_ERROR_DATA, path,
                  "it has " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                      " pixels, the picture " + std::to_string(width) + " x " + std::to_string(height));
  if (!is_float(spec.channelformat(channel)))
    return refuse(context, TETCAST_ERROR_DATA, path,
                  std::string("its pixels are ") + spec.channelformat(channel).c_str() +
                      ": expected floating-point numbers, as .exr and .tif have them");
  const std::string &name = spec.channelnames[size_t(channel)];
  if (spec.nchannels > 1 && name != "Z" && !ends_with(name, ".Z"))
    tetcast_context_message(context, TETCAST_SEVERITY_WARNING,
                            "depths '%s': of %d channels none is named Z; the first, %s, is taken", path,
                            spec.nchannels, name.c_str());
  if (!input->read_image(input->current_subimage(), 0, channel, channel + 1, TypeDesc::DOUBLE, depth)) {
    const std::string reason = input->geterror();
    return refuse(context, TETCAST_ERROR_IO, path, reason.empty() ? "OpenImageIO failed without saying why" : reason);
  }
  return TETCAST_OK;
}

} // namespace

TetcastStatus tetcast_image_read_depth(TetcastContext *context, const char *path, int64_t width, int64_t height,
                                       double *depth) {
  if (!context || !path || !depth)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_image_read_depth: context, path and depth are needed");
  const FloatingPoint guard;
  try {
    return read_depth(context, path, width, height, depth);
  } catch (const std::bad_alloc &) {
    return refuse(context, TETCAST_ERROR_MEMORY, path, "out of memory");
  } catch (const std::exception &error) {
    return refuse(context, TETCAST_ERROR_IO, path, error.what());
  } catch (...) {
    return refuse(context, TETCAST_ERROR_IO, path, "unknown failure");
  }
}
