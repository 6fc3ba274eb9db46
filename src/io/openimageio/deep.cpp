// SPDX-License-Identifier: Apache-2.0
// Deep pictures: several samples a pixel, each with the part of the ray that it stands for.
#include <tetcast/image.h>
#include <tetcast/version.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>

#include "failure.hpp"
#include "io/floating.hpp"
#include "output.hpp"

using OIIO::DeepData;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using tetcast::error_text;
using tetcast::fail;

namespace {

enum { COLORS = 4, CHANNEL_Z = COLORS, CHANNEL_Z_BACK, CHANNELS };

constexpr int64_t batch_rows = 16;

bool is_exr(const std::string &path) {
  std::string end = path.size() > 4 ? path.substr(path.size() - 4) : "";
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return end == ".exr";
}

ImageSpec deep_spec(const TetcastDeep &deep, TypeDesc type) {
  ImageSpec spec(int(deep.width), int(deep.height), CHANNELS, TypeDesc::FLOAT);
  spec.channelnames = {"R", "G", "B", "A", "Z", "ZBack"};
  spec.channelformats = {type, type, type, type, TypeDesc::FLOAT, TypeDesc::FLOAT};
  spec.alpha_channel = 3;
  spec.z_channel = CHANNEL_Z;
  spec.deep = true;
  spec.attribute("Software", "tetcast " TETCAST_VERSION_STRING);
  spec.attribute("DateTime", "    :  :     :  :  "); // the same picture gives the same file
  spec.attribute("compression", "zips");             // of those that deep pictures may have
  return spec;
}

const float *color_of(const TetcastDeep &deep, int layer, int64_t pixel) {
  return deep.layers[layer] + COLORS * pixel;
}

bool shows(const float *color) {
  return std::any_of(color, color + COLORS, [](float value) { return value != 0; });
}

// Where layer `layer` of a pixel begins, or the one before it ends.
float depth_of(const TetcastDeep &deep, int layer, int64_t pixel) {
  const double begin = deep.begin[pixel], end = deep.end[pixel];
  return float(layer == deep.layer_count ? end : begin + (end - begin) * layer / deep.layer_count);
}

// The samples of rows [first, last): of each pixel the layers that show something.
void fill_rows(const TetcastDeep &deep, int64_t first, int64_t last, const ImageSpec &spec, DeepData &data) {
  const int64_t from = first * deep.width, count = (last - first) * deep.width;
  data.init(count, CHANNELS, spec.channelformats, spec.channelnames);
  for (int64_t i = 0; i < count; ++i) {
    int samples = 0;
    for (int layer = 0; layer < deep.layer_count; ++layer)
      samples += shows(color_of(deep, layer, from + i));
    data.set_samples(i, samples);
  }
  for (int64_t i = 0; i < count; ++i) {
    int sample = 0;
    for (int layer = 0; layer < deep.layer_count; ++layer) {
      const float *color = color_of(deep, layer, from + i);
      if (!shows(color))
        continue;
      for (int c = 0; c < COLORS; ++c)
        data.set_deep_value(i, c, sample, color[c]);
      data.set_deep_value(i, CHANNEL_Z, sample, depth_of(deep, layer, from + i));
      data.set_deep_value(i, CHANNEL_Z_BACK, sample, depth_of(deep, layer + 1, from + i));
      ++sample;
    }
  }
}

bool write_rows(ImageOutput &output, const TetcastDeep &deep, const ImageSpec &spec) {
  for (int64_t first = 0; first < deep.height; first += batch_rows) {
    const int64_t last = std::min(first + batch_rows, deep.height);
    DeepData data;
    fill_rows(deep, first, last, spec, data);
    if (!output.write_deep_scanlines(int(first), int(last), 0, data))
      return false;
  }
  return true;
}

void write(TetcastContext *context, const char *path, const TetcastDeep &deep, TypeDesc type) {
  tetcast::NewFile file; // outlives the proxy, which outlives the output
  std::unique_ptr<tetcast::CheckedProxy> proxy;
  std::unique_ptr<ImageOutput> output = ImageOutput::create("exr");
  (void)OIIO::geterror();
  if (!is_exr(path) || !output || !output->supports("deepdata"))
    fail(context, TETCAST_ERROR_ARGUMENT, path, "only .exr holds deep pictures");
  if (deep.width > 1 << 20 || deep.height > 1 << 20)
    fail(context, TETCAST_ERROR_ARGUMENT, path, "the format holds at most 1048576 pixels a side");
  output->threads(tetcast_context_threads(context));
  if (const int error = file.open(path))
    fail(context, TETCAST_ERROR_IO, path, error_text(error));
  proxy = std::make_unique<tetcast::CheckedProxy>(file.file(), file.temporary());
  ImageSpec spec = deep_spec(deep, type);
  void *pointer = static_cast<OIIO::Filesystem::IOProxy *>(proxy.get());
  spec.attribute("oiio:ioproxy", TypeDesc::PTR, &pointer);
  bool done = output->open(file.temporary(), spec);
  if (done) {
    done = write_rows(*output, deep, spec);
    done = output->close() && done;
  }
  tetcast::check_written(context, path, output->geterror(), proxy->error_number(), done);
  output.reset();
  if (const int error = file.publish())
    fail(context, TETCAST_ERROR_IO, path, error_text(error));
}

} // namespace

TetcastStatus tetcast_image_write_deep(TetcastContext *context, const char *path, const TetcastDeep *deep,
                                       TetcastPixelType pixel_type) {
  const FloatingPoint guard;
  if (!context || !path || !deep || !deep->layers || !deep->begin || !deep->end)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_image_write_deep: context, path, layers, begin and end are needed");
  if (deep->width < 1 || deep->height < 1 || deep->layer_count < 1)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "a deep picture without pixels or layers");
  int type; // an enumeration that C code set may have any value
  std::memcpy(&type, &pixel_type, sizeof type);
  if (type != TETCAST_PIXEL_DEFAULT && type != TETCAST_PIXEL_FLOAT && type != TETCAST_PIXEL_HALF)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "cannot write image '%s': deep pixels are of type half or float", path);
  return tetcast::guard_writing(context, path, [&] {
    write(context, path, *deep, type == TETCAST_PIXEL_HALF ? TypeDesc::HALF : TypeDesc::FLOAT);
  });
}
