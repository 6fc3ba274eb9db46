// SPDX-License-Identifier: Apache-2.0
#include <tetcast/image.h>
#include <tetcast/version.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <OpenImageIO/imageio.h>

#include "failure.hpp"
#include "io/floating.hpp"
#include "output.hpp"

using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using tetcast::error_text;
using tetcast::fail;

namespace {

constexpr uint32_t desc_cookie = 0x7463696d; // "tcim"
constexpr int64_t batch_rows = 64; // handed to OpenImageIO at a time: a multiple of what EXR and TIFF compress together

// What is stored beside colour and alpha, or instead.
struct Extra {
  const char *name;
  const void *data; // [height][width][count]
  int count;
  bool vector; // of X, Y, Z
};

// The frame's pixels, or the one pixel of a check.
struct Pixels {
  const void *data;
  int64_t width, height, row_stride;
  bool is_double;
  std::vector<Extra> extras;
  bool extras_only;

  int colors() const { return extras_only ? 0 : 4; }
  int channels() const {
    int count = colors();
    for (const Extra &extra : extras)
      count += extra.count;
    return count;
  }
};

void add_extra(const TetcastFrame *frame, const TetcastChannelInfo &info, std::vector<Extra> &extras) {
  if (const void *data = tetcast_frame_channel(frame, info.channel))
    extras.push_back(
        {info.file_name, data, info.of_groups ? tetcast_frame_groups(frame) : info.components, info.components == 3});
}

// The channels in the order that is asked for, or in that of the table.
std::vector<Extra> extras_of(const TetcastFrame *frame, const TetcastImageDesc *desc) {
  std::vector<Extra> extras;
  const TetcastChannelInfo *info;
  const bool listed = desc && desc->channels;
  for (int k = 0; k < (listed ? desc->channel_count : 1); ++k)
    for (int i = 0; (info = tetcast_channel_info(i)); ++i)
      if (!listed || info->channel == desc->channels[k])
        add_extra(frame, *info, extras);
  return extras;
}

std::string extension_of(const std::string &path) {
  const size_t slash = path.rfind('/');
  const size_t dot = path.rfind('.');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash))
    return "";
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

// The formats that were tried: all write through a proxy and report what goes wrong. Beyond the limit some print, write
// a damaged file or, as libjpeg does, end the process.
struct Format {
  const char *name; // OpenImageIO's
  TypeDesc::BASETYPE standard;
  int64_t limit; // pixels a side
};

// From 2.5 on, OpenImageIO itself has a limit for PNG, BMP and PNM, below what the formats or libpng have.
constexpr int64_t limited(int64_t limit) {
  return OIIO_VERSION >= OIIO_MAKE_VERSION(2, 5, 0) ? 65535 : limit;
}

constexpr Format formats[] = {{"png", TypeDesc::UINT8, limited(1000000)}, {"openexr", TypeDesc::HALF, 1 << 20},
                              {"tiff", TypeDesc::FLOAT, 1 << 20},         {"jpeg", TypeDesc::UINT8, 65500},
                              {"bmp", TypeDesc::UINT8, limited(1 << 20)}, {"targa", TypeDesc::UINT8, 65535},
                              {"webp", TypeDesc::UINT8, 16383},           {"pnm", TypeDesc::UINT8, limited(1 << 20)},
                              {"hdr", TypeDesc::FLOAT, 1 << 20}};

// Names that OpenImageIO takes for one of these formats, but that promise what would not be in the file: grey values,
// single bits or floating-point numbers, tiled textures, several views.
constexpr const char *misleading[] = {"pgm", "pbm", "pfm", "tx", "env", "sm", "vsm", "sxr", "mxr"};

const Format &find_format(TetcastContext *context, const char *path, std::unique_ptr<ImageOutput> &output) {
  const std::string extension = extension_of(path);
  if (extension.empty())
    fail(context, TETCAST_ERROR_ARGUMENT, path, "the name has no extension to tell the format by, such as .png");
  output = ImageOutput::create(extension);
  (void)OIIO::geterror(); // or it would be printed at the end of the process
  const bool fitting = std::find(std::begin(misleading), std::end(misleading), extension) == std::end(misleading);
  for (const Format &format : formats)
    if (output && fitting && !std::strcmp(output->format_name(), format.name))
      return format;
  if (extension == "exr") // OpenEXR starts threads before it knows what for
    std::thread([] {}).join();
  fail(context, TETCAST_ERROR_ARGUMENT, path,
       "images of format '." + extension + "' are not supported; .png .exr .tif .jpg are");
}

const char *type_name(TetcastPixelType type) {
  switch (type) {
  case TETCAST_PIXEL_UINT8:
    return "uint8";
  case TETCAST_PIXEL_UINT16:
    return "uint16";
  case TETCAST_PIXEL_HALF:
    return "half";
  case TETCAST_PIXEL_FLOAT:
    return "float";
  case TETCAST_PIXEL_DOUBLE:
    return "double";
  default:
    return "default";
  }
}

bool is_float(TypeDesc type) {
  return type.basetype == TypeDesc::HALF || type.basetype == TypeDesc::FLOAT || type.basetype == TypeDesc::DOUBLE;
}

double component(const Pixels &pixels, int64_t y, int64_t i) {
  const char *at = static_cast<const char *>(pixels.data) + y * pixels.row_stride + i * (pixels.is_double ? 8 : 4);
  double wide;
  float narrow;
  if (pixels.is_double) {
    std::memcpy(&wide, at, 8);
    return wide;
  }
  std::memcpy(&narrow, at, 4);
  return narrow;
}

// The least and the largest finite colour of the picture, 0 included.
std::pair<double, double> color_range(const Pixels &pixels) {
  std::pair<double, double> range = {0, 0};
  for (int64_t y = 0; y < pixels.height; y++)
    for (int64_t i = 0; i < 4 * pixels.width; i++) {
      const double value = component(pixels, y, i);
      if (i % 4 == 3 || !std::isfinite(value))
        continue;
      range.first = std::min(range.first, value);
      range.second = std::max(range.second, value);
    }
  return range;
}

constexpr double half_largest = 65504, half_least = 0x1p-14; // with all of its bits

// A format's own type, or float where half would make infinities or nothing of the colours.
TypeDesc suitable_type(TypeDesc standard, const Pixels &pixels) {
  if (standard != TypeDesc::HALF || pixels.colors() == 0)
    return standard;
  const auto range = color_range(pixels);
  const double largest = std::max(-range.first, range.second);
  return largest <= half_largest && (largest == 0 || largest >= half_least) ? TypeDesc::HALF : TypeDesc::FLOAT;
}

TypeDesc requested_type(TetcastPixelType type, const Format &format, const Pixels &pixels) {
  switch (type) {
  case TETCAST_PIXEL_UINT8:
    return TypeDesc::UINT8;
  case TETCAST_PIXEL_UINT16:
    return TypeDesc::UINT16;
  case TETCAST_PIXEL_HALF:
    return TypeDesc::HALF;
  case TETCAST_PIXEL_FLOAT:
    return TypeDesc::FLOAT;
  case TETCAST_PIXEL_DOUBLE:
    return TypeDesc::DOUBLE;
  default:
    return suitable_type(format.standard, pixels);
  }
}

// What of the picture a format or type can't hold, "": nothing.
std::string unfit(const char *format, TypeDesc type, const Pixels &pixels, bool opaque) {
  if (!std::strcmp(format, "webp") && !opaque) // OpenImageIO's writer divides them by alpha, which we have done
    return "the format takes colours over an opaque background alone; .png and .tif hold alpha";
  // OpenImageIO 2.5 makes a .pfm of these, whatever the name, and upside down.
  if (!std::strcmp(format, "pnm") && is_float(type))
    return "the format cannot hold pixels of type half, float or double; .exr and .tif do";
  const bool radiance = !std::strcmp(format, "hdr");
  if (pixels.colors() == 0 || (type != TypeDesc::HALF && !radiance))
    return "";
  const auto range = color_range(pixels);
  std::ostringstream reason;
  if (radiance && range.first < 0)
    reason << "the format holds no values below 0, as " << range.first << " is; .exr and .tif do";
  else if (radiance && range.second >= 0x1p127)
    reason << "the format holds no values as large as " << range.second;
  else if (!radiance && std::max(-range.first, range.second) > half_largest)
    reason << "pixels of type half hold no values beyond 65504, as " << std::max(-range.first, range.second)
           << " is; float does";
  return reason.str();
}

template <class T> T quantize(double value, double top) {
  return static_cast<T>(value > 0 ? std::floor(std::min(value, 1.0) * top + 0.5) : 0.0); // NaN becomes 0
}

// Composites rows [begin, end) over the background. With an alpha channel colours are not premultiplied, as PNG wants
// them; without one a translucent background itself lies over black.
template <class T>
void integer_rows(const Pixels &pixels, int64_t begin, int64_t end, int channels, const double background[4], T *out) {
  const double top = sizeof(T) == 1 ? 255.0 : 65535.0;
  for (int64_t y = begin; y < end; y++) {
    for (int64_t x = 0; x < pixels.width; x++, out += channels) {
      const double behind = (1 - component(pixels, y, 4 * x + 3)) * background[3];
      const double alpha = component(pixels, y, 4 * x + 3) + behind;
      const double scale = channels == 4 ? (alpha > 0 ? 1 / alpha : 0) : 1;
      for (int c = 0; c < 3; c++)
        out[c] = quantize<T>((component(pixels, y, 4 * x + c) + behind * background[c]) * scale, top);
      if (channels == 4)
        out[3] = quantize<T>(alpha, top);
    }
  }
}

// Rows [begin, end) with all channels of a pixel next to each other.
void many_channel_rows(const Pixels &pixels, int64_t begin, int64_t end, unsigned char *out) {
  const size_t size = pixels.is_double ? 8 : 4, colors = size_t(pixels.colors()) * size;
  for (int64_t y = begin; y < end; y++) {
    const char *row = static_cast<const char *>(pixels.data) + y * pixels.row_stride;
    for (size_t x = 0; x < size_t(pixels.width); x++) {
      std::memcpy(out, row + x * 4 * size, colors);
      out += colors;
      for (const Extra &extra : pixels.extras) {
        const size_t bytes = size_t(extra.count) * size;
        std::memcpy(out, static_cast<const char *>(extra.data) + (size_t(y * pixels.width) + x) * bytes, bytes);
        out += bytes;
      }
    }
  }
}

bool write_rows(ImageOutput &output, const Pixels &pixels, const double background[4]) {
  const ImageSpec &spec = output.spec();
  const bool floating = is_float(spec.format);
  const TypeDesc frame_type = pixels.is_double ? TypeDesc::DOUBLE : TypeDesc::FLOAT;
  std::vector<unsigned char> batch;
  const bool many = !pixels.extras.empty();
  const size_t pixel_bytes = many ? size_t(pixels.channels()) * frame_type.size() : floating ? 0 : spec.pixel_bytes();
  batch.resize(size_t(pixels.width) * size_t(std::min(batch_rows, pixels.height)) * pixel_bytes);
  for (int64_t begin = 0; begin < pixels.height; begin += batch_rows) {
    const int64_t end = std::min(begin + batch_rows, pixels.height);
    bool done;
    if (many) {
      many_channel_rows(pixels, begin, end, batch.data());
      done = output.write_scanlines(int(begin), int(end), 0, frame_type, batch.data());
    } else if (floating) {
      const char *row = static_cast<const char *>(pixels.data) + begin * pixels.row_stride;
      done = output.write_scanlines(int(begin), int(end), 0, frame_type, row, OIIO::stride_t(4 * frame_type.size()),
                                    pixels.row_stride);
    } else {
      if (spec.format.size() == 1)
        integer_rows(pixels, begin, end, spec.nchannels, background, batch.data());
      else
        integer_rows(pixels, begin, end, spec.nchannels, background, reinterpret_cast<uint16_t *>(batch.data()));
      done = output.write_scanlines(int(begin), int(end), 0, spec.format, batch.data());
    }
    if (!done)
      return false;
  }
  return true;
}

// "radiance", or of several groups "radiance.00", "radiance.01" …, so that names sort as groups do.
std::string channel_name(const Extra &extra, int group) {
  if (extra.count == 1)
    return extra.name;
  if (extra.vector)
    return extra.name + std::string(".") + "XYZ"[group];
  const std::string number = std::to_string(group), last = std::to_string(extra.count - 1);
  return extra.name + ("." + std::string(last.size() - number.size(), '0')) + number;
}

void name_channels(const Pixels &pixels, TypeDesc type, ImageSpec &spec) {
  spec.nchannels = pixels.colors();
  spec.default_channel_names(); // R, G, B, A
  if (pixels.extras_only)
    spec.alpha_channel = -1;
  for (const Extra &extra : pixels.extras)
    for (int group = 0; group < extra.count; group++)
      spec.channelnames.push_back(channel_name(extra, group));
  spec.nchannels = pixels.channels();
  if (type == TypeDesc::HALF) { // which would make 0 of small bounds
    spec.channelformats.assign(size_t(pixels.colors()), type);
    spec.channelformats.resize(size_t(pixels.channels()), TypeDesc::FLOAT);
  }
}

ImageSpec picture_spec(const ImageOutput &output, const Pixels &pixels, TypeDesc type, bool opaque) {
  const bool alpha = output.supports("alpha") && (is_float(type) || !opaque);
  ImageSpec spec(int(pixels.width), int(pixels.height), alpha ? 4 : 3, type);
  spec.attribute("Software", "tetcast " TETCAST_VERSION_STRING);
  if (!pixels.extras.empty())
    name_channels(pixels, type, spec);
  if (alpha && !is_float(type))
    spec.attribute("oiio:UnassociatedAlpha", 1);
  const std::string format = output.format_name();
  // The same picture gives the same file. Left out, the time of writing would be put in; these are the blanks for
  // "unknown".
  if (format == "tiff" || format == "openexr")
    spec.attribute("DateTime", "    :  :     :  :  ");
  if (format == "tiff") {
    spec.attribute("tiff:half", 1);
    spec.attribute("tiff:Predictor", 1); // none: fewer readers know the one for floating point
  } else if (format == "jpeg") {
    spec.attribute("CompressionQuality", 95);
    spec.attribute("jpeg:subsampling", "4:4:4"); // colour maps have edges
  }
  return spec;
}

// Writes the pixels beside `path`; `publish` makes them the file.
void write_picture(TetcastContext *context, const char *path, const Pixels &pixels, const TetcastImageDesc &desc,
                   bool publish) {
  tetcast::NewFile file; // outlives the proxy, which outlives the output
  std::unique_ptr<tetcast::CheckedProxy> proxy;
  std::unique_ptr<ImageOutput> output;
  const Format &format = find_format(context, path, output);
  if (std::max(pixels.width, pixels.height) > format.limit)
    fail(context, TETCAST_ERROR_ARGUMENT, path,
         "the format holds at most " + std::to_string(format.limit) + " pixels a side");
  output->threads(tetcast_context_threads(context));
  if (const int error = file.open(path))
    fail(context, TETCAST_ERROR_IO, path, error_text(error));
  proxy = std::make_unique<tetcast::CheckedProxy>(file.file(), file.temporary());
  TypeDesc type = requested_type(desc.pixel_type, format, pixels);
  if (pixels.extras_only && type == TypeDesc::HALF && output->supports("channelformats"))
    type = TypeDesc::FLOAT; // as each of them is
  if (!pixels.extras.empty() && (!is_float(type) || !output->supports("nchannels")))
    fail(context, TETCAST_ERROR_ARGUMENT, path,
         std::string("the frame has the channel ") + pixels.extras[0].name +
             ", which only floating-point pixels in .exr and .tif can hold");
  if (!pixels.extras.empty() && type == TypeDesc::HALF && !output->supports("channelformats"))
    fail(context, TETCAST_ERROR_ARGUMENT, path,
         std::string("the channel ") + pixels.extras[0].name + " does not fit into pixels of type half in this format");
  const bool opaque = desc.background[3] >= 1;
  const std::string reason_against = unfit(format.name, type, pixels, opaque);
  if (!reason_against.empty())
    fail(context, TETCAST_ERROR_ARGUMENT, path, reason_against);
  ImageSpec spec = picture_spec(*output, pixels, type, opaque);
  void *pointer = static_cast<OIIO::Filesystem::IOProxy *>(proxy.get());
  spec.attribute("oiio:ioproxy", TypeDesc::PTR, &pointer);

  bool done = output->open(file.temporary(), spec);
  if (done) {
    if (output->spec().format != type) {            // what a format does that can't hold the type
      write_rows(*output, pixels, desc.background); // libpng would print about a file without pixels
      output->close();
      (void)output->geterror();
      fail(context, TETCAST_ERROR_ARGUMENT, path,
           std::string("the format cannot hold pixels of type ") + type_name(desc.pixel_type));
    }
    if (!output->supports("alpha") && (is_float(type) || !opaque))
      tetcast_context_message(context, TETCAST_SEVERITY_WARNING,
                              "image '%s': the format has no alpha; the picture lies over black", path);
    done = write_rows(*output, pixels, desc.background);
    done = output->close() && done;
  }
  tetcast::check_written(context, path, output->geterror(), proxy->error_number(), done);
  output.reset();
  if (publish)
    if (const int error = file.publish())
      fail(context, TETCAST_ERROR_IO, path, error_text(error));
}

TetcastStatus guarded(TetcastContext *context, const char *path, const Pixels &pixels, const TetcastImageDesc *given,
                      bool publish) {
  const FloatingPoint guard;
  const TetcastImageDesc desc = given ? *given : tetcast_image_desc_default();
  if (desc.cookie != desc_cookie)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "the image description was not made by tetcast_image_desc_default()");
  int pixel_type; // an enumeration that C code set may have any value
  std::memcpy(&pixel_type, &desc.pixel_type, sizeof pixel_type);
  if (pixel_type < TETCAST_PIXEL_DEFAULT || pixel_type > TETCAST_PIXEL_DOUBLE)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "unknown pixel type %d", pixel_type);
  if (desc.channel_count < 0 || (desc.channels && publish && int(pixels.extras.size()) != desc.channel_count))
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "image '%s': the frame lacks a channel that is to be written", path);
  if (desc.channels_only && pixels.extras.empty() && publish)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "an image of a frame's channels only, but it has none");
  for (double value : desc.background)
    if (!(value >= 0 && value <= 1))
      return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "background component %g is outside [0, 1]", value);
  return tetcast::guard_writing(context, path, [&] { write_picture(context, path, pixels, desc, publish); });
}

} // namespace

TetcastImageDesc tetcast_image_desc_default(void) {
  TetcastImageDesc desc = {};
  desc.cookie = desc_cookie;
  desc.pixel_type = TETCAST_PIXEL_DEFAULT;
  desc.channels = nullptr;
  desc.channel_count = 0;
  for (double &value : desc.background)
    value = 1; // opaque white
  return desc;
}

TetcastStatus tetcast_image_write(TetcastContext *context, const char *path, const TetcastFrame *frame,
                                  const TetcastImageDesc *desc) {
  if (!context || !path || !frame)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_image_write: context, path and frame are needed");
  const Pixels pixels = {tetcast_frame_pixels(frame),
                         tetcast_frame_width(frame),
                         tetcast_frame_height(frame),
                         tetcast_frame_row_stride(frame),
                         tetcast_frame_type(frame) == TETCAST_TYPE_FLOAT64,
                         extras_of(frame, desc),
                         desc && desc->channels_only};
  return guarded(context, path, pixels, desc, true);
}

TetcastStatus tetcast_image_check(TetcastContext *context, const char *path, const TetcastImageDesc *desc) {
  if (!context || !path)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "tetcast_image_check: context and path are needed");
  static const float pixel[4] = {0, 0, 0, 0};
  return guarded(context, path, {pixel, 1, 1, sizeof pixel, false, {}, false}, desc, false);
}
