// SPDX-License-Identifier: Apache-2.0
#include <tetcast/image.h>
#include <tetcast/version.h>

#include <algorithm>
#include <array>
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
#include "overlay.hpp"

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

// What lies behind the picture, and over it.
struct Scenery {
  TetcastImageDesc desc;
  std::vector<tetcast::Overlay> overlays;
  int64_t height; // of the picture

  // The background of a row.
  std::array<double, 4> behind(int64_t y) const {
    std::array<double, 4> color;
    const double below = desc.background_shaded && height > 1 ? double(y) / double(height - 1) : 0;
    for (size_t k = 0; k < 4; k++)
      color[k] = below > 0 ? desc.background[k] * (1 - below) + desc.background_below[k] * below : desc.background[k];
    color[3] = desc.background[3];
    return color;
  }
};

// Composites rows [begin, end) over the background, and the overlay over them. With an alpha channel colours are not
// premultiplied, as PNG wants them; without one a translucent background itself lies over black.
template <class T>
void integer_rows(const Pixels &pixels, int64_t begin, int64_t end, int channels, const Scenery &scenery, int64_t first,
                  T *out) {
  const double top = sizeof(T) == 1 ? 255.0 : 65535.0, gain = std::exp2(scenery.desc.exposure);
  for (int64_t y = begin; y < end; y++) {
    const std::array<double, 4> background = scenery.behind(first + y);
    for (int64_t x = 0; x < pixels.width; x++, out += channels) {
      const double behind = (1 - component(pixels, y, 4 * x + 3)) * background[3];
      double rgba[4] = {0, 0, 0, component(pixels, y, 4 * x + 3) + behind};
      for (size_t c = 0; c < 3; c++)
        rgba[c] = component(pixels, y, 4 * x + int64_t(c)) * gain + behind * background[c];
      for (const tetcast::Overlay &overlay : scenery.overlays) {
        const float *over = overlay.at(x, first + y);
        for (size_t c = 0; over && c < 4; c++)
          rgba[c] = double(over[c]) + (1 - double(over[3])) * rgba[c];
      }
      const double scale = channels == 4 ? (rgba[3] > 0 ? 1 / rgba[3] : 0) : 1;
      for (size_t c = 0; c < 3; c++)
        out[c] = quantize<T>(rgba[c] * scale, top);
      if (channels == 4)
        out[3] = quantize<T>(rgba[3], top);
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

// Writes the pixels as the rows from `first` on.
bool write_rows(ImageOutput &output, const Pixels &pixels, int64_t first, const Scenery &scenery) {
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
      done = output.write_scanlines(int(first + begin), int(first + end), 0, frame_type, batch.data());
    } else if (floating) {
      const char *row = static_cast<const char *>(pixels.data) + begin * pixels.row_stride;
      done = output.write_scanlines(int(first + begin), int(first + end), 0, frame_type, row,
                                    OIIO::stride_t(4 * frame_type.size()), pixels.row_stride);
    } else {
      if (spec.format.size() == 1)
        integer_rows(pixels, begin, end, spec.nchannels, scenery, first, batch.data());
      else
        integer_rows(pixels, begin, end, spec.nchannels, scenery, first, reinterpret_cast<uint16_t *>(batch.data()));
      done = output.write_scanlines(int(first + begin), int(first + end), 0, spec.format, batch.data());
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

// What colours mean. Integer pixels are shown as they are. OpenImageIO's writer of EXR has no place for it but words,
// and that of TIFF writes it in a way by which files that go through a proxy lose their directory.
void state_colors(const Pixels &pixels, TypeDesc type, bool linear, const std::string &format, ImageSpec &spec) {
  if (pixels.extras_only)
    return;
  linear = linear && is_float(type);
  if (format == "tiff" || format == "openexr")
    spec.attribute("ImageDescription", linear ? "colours are linear radiance" : "colours are display values (sRGB)");
  else
    spec.attribute("oiio:ColorSpace", linear ? "Linear" : "sRGB");
}

ImageSpec picture_spec(const ImageOutput &output, const Pixels &pixels, TypeDesc type, const TetcastImageDesc &desc) {
  const bool opaque = desc.background[3] >= 1;
  const bool alpha = output.supports("alpha") && (is_float(type) || !opaque);
  ImageSpec spec(int(pixels.width), int(pixels.height), alpha ? 4 : 3, type);
  spec.attribute("Software", "tetcast " TETCAST_VERSION_STRING);
  if (!pixels.extras.empty())
    name_channels(pixels, type, spec);
  if (alpha && !is_float(type))
    spec.attribute("oiio:UnassociatedAlpha", 1);
  const std::string format = output.format_name();
  state_colors(pixels, type, desc.linear, format, spec);
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

Scenery make_scenery(TetcastContext *context, const char *path, int64_t width, int64_t height,
                     const TetcastImageDesc &desc, bool floating) {
  Scenery scenery = {desc, {}, height};
  if (floating)
    return scenery;
  const double *b = desc.background;
  const double bright = 1 - b[3] + b[3] * (0.2126 * b[0] + 0.7152 * b[1] + 0.0722 * b[2]);
  const float ink = bright < 0.5 ? 1 : 0.1f;
  std::string problem;
  if (desc.legend)
    scenery.overlays.push_back(tetcast::draw_legend(*desc.legend, width, height, ink, problem));
  for (int i = 0; i < desc.caption_count; i++)
    scenery.overlays.push_back(tetcast::draw_caption(desc.captions[i], width, height, ink, problem));
  if (!problem.empty())
    tetcast_context_message(context, TETCAST_SEVERITY_WARNING, "image '%s': %s", path, problem.c_str());
  return scenery;
}

// A file under way, beside `path`.
struct Writing {
  tetcast::NewFile file; // outlives the proxy, which outlives the output
  std::unique_ptr<tetcast::CheckedProxy> proxy;
  std::unique_ptr<ImageOutput> output;
  std::unique_ptr<Scenery> scenery;
  TypeDesc type;
};

// Opens the file of a picture with `height` rows, of which these pixels are the first ones.
void begin_picture(TetcastContext *context, const char *path, const Pixels &pixels, int64_t height,
                   const TetcastImageDesc &desc, Writing &writing) {
  std::unique_ptr<ImageOutput> &output = writing.output;
  const Format &format = find_format(context, path, output);
  if (std::max(pixels.width, height) > format.limit)
    fail(context, TETCAST_ERROR_ARGUMENT, path,
         "the format holds at most " + std::to_string(format.limit) + " pixels a side");
  output->threads(tetcast_context_threads(context));
  if (const int error = writing.file.open(path))
    fail(context, TETCAST_ERROR_IO, path, error_text(error));
  writing.proxy = std::make_unique<tetcast::CheckedProxy>(writing.file.file(), writing.file.temporary());
  const bool whole = height == pixels.height;
  TypeDesc type = !whole && desc.pixel_type == TETCAST_PIXEL_DEFAULT ? TypeDesc(format.standard)
                                                                     : requested_type(desc.pixel_type, format, pixels);
  if (pixels.extras_only && type == TypeDesc::HALF && output->supports("channelformats"))
    type = TypeDesc::FLOAT; // as each of them is
  writing.type = type;
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
  ImageSpec spec = picture_spec(*output, pixels, type, desc);
  spec.height = spec.full_height = int(height);
  void *pointer = static_cast<OIIO::Filesystem::IOProxy *>(writing.proxy.get());
  spec.attribute("oiio:ioproxy", TypeDesc::PTR, &pointer);

  writing.scenery = std::make_unique<Scenery>(make_scenery(context, path, pixels.width, height, desc, is_float(type)));
  const bool done = output->open(writing.file.temporary(), spec);
  if (!done)
    tetcast::check_written(context, path, output->geterror(), writing.proxy->error_number(), done);
  if (output->spec().format != type) {                // what a format does that can't hold the type
    write_rows(*output, pixels, 0, *writing.scenery); // libpng would print about a file without pixels
    output->close();
    (void)output->geterror();
    fail(context, TETCAST_ERROR_ARGUMENT, path,
         std::string("the format cannot hold pixels of type ") + type_name(desc.pixel_type));
  }
  if (!output->supports("alpha") && (is_float(type) || !opaque))
    tetcast_context_message(context, TETCAST_SEVERITY_WARNING,
                            "image '%s': the format has no alpha; the picture lies over black", path);
}

// Closes the file, `done` being whether all went well so far; `publish` makes it appear.
void end_picture(TetcastContext *context, const char *path, Writing &writing, bool done, bool publish) {
  done = writing.output->close() && done;
  tetcast::check_written(context, path, writing.output->geterror(), writing.proxy->error_number(), done);
  writing.output.reset();
  if (publish)
    if (const int error = writing.file.publish())
      fail(context, TETCAST_ERROR_IO, path, error_text(error));
}

void write_picture(TetcastContext *context, const char *path, const Pixels &pixels, const TetcastImageDesc &desc,
                   bool publish) {
  Writing writing;
  begin_picture(context, path, pixels, pixels.height, desc, writing);
  const bool done = write_rows(*writing.output, pixels, 0, *writing.scenery);
  end_picture(context, path, writing, done, publish);
}

TetcastStatus check_desc(TetcastContext *context, const char *path, const Pixels &pixels, const TetcastImageDesc &desc,
                         bool publish) {
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
  for (double value : desc.background_below)
    if (desc.background_shaded && !(value >= 0 && value <= 1))
      return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "background component %g is outside [0, 1]", value);
  for (double value : desc.background)
    if (!(value >= 0 && value <= 1))
      return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "background component %g is outside [0, 1]", value);
  if (!std::isfinite(desc.exposure))
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "the exposure %g is not a finite number",
                                 desc.exposure);
  return TETCAST_OK;
}

TetcastStatus guarded(TetcastContext *context, const char *path, const Pixels &pixels, const TetcastImageDesc *given,
                      bool publish) {
  const FloatingPoint guard;
  const TetcastImageDesc desc = given ? *given : tetcast_image_desc_default();
  const TetcastStatus status = check_desc(context, path, pixels, desc, publish);
  if (status != TETCAST_OK)
    return status;
  return tetcast::guard_writing(context, path, [&] { write_picture(context, path, pixels, desc, publish); });
}

Pixels pixels_of(const TetcastFrame *frame, const TetcastImageDesc *desc) {
  return {tetcast_frame_pixels(frame),
          tetcast_frame_width(frame),
          tetcast_frame_height(frame),
          tetcast_frame_row_stride(frame),
          tetcast_frame_type(frame) == TETCAST_TYPE_FLOAT64,
          extras_of(frame, desc),
          desc && desc->channels_only};
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
  desc.background_shaded = 0;
  for (double &value : desc.background_below)
    value = 1;
  desc.legend = nullptr;
  desc.captions = nullptr;
  desc.caption_count = 0;
  return desc;
}

TetcastStatus tetcast_image_write(TetcastContext *context, const char *path, const TetcastFrame *frame,
                                  const TetcastImageDesc *desc) {
  if (!context || !path || !frame)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_image_write: context, path and frame are needed");
  return guarded(context, path, pixels_of(frame, desc), desc, true);
}

struct TetcastImage {
  TetcastContext *context;
  std::string path;
  TetcastImageDesc desc;
  std::vector<TetcastChannel> channels; // which the desc points to
  Writing writing;
  int64_t width, height, rows; // rows: written so far
  int channel_count;
  bool is_double, failed;
};

TetcastStatus tetcast_image_begin(TetcastContext *context, const char *path, const TetcastFrame *frame, int64_t height,
                                  const TetcastImageDesc *desc, TetcastImage **image) {
  const FloatingPoint guard;
  if (image)
    *image = nullptr;
  if (!context || !path || !frame || !image)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_image_begin: context, path, frame and image are needed");
  const TetcastImageDesc all = desc ? *desc : tetcast_image_desc_default();
  return tetcast::guard_writing(context, path, [&] {
    const Pixels pixels = pixels_of(frame, &all);
    const std::string extension = extension_of(path);
    if (check_desc(context, path, pixels, all, true) != TETCAST_OK)
      throw tetcast::Failure{TETCAST_ERROR_ARGUMENT};
    if (extension != "png" && extension != "exr" && extension != "tif" && extension != "tiff")
      fail(context, TETCAST_ERROR_ARGUMENT, path, "only .png, .exr and .tif are written in bands of rows");
    if (height < pixels.height || height > 1 << 20)
      fail(context, TETCAST_ERROR_ARGUMENT, path, "the picture's height is not that of a picture with this band");
    auto result = std::make_unique<TetcastImage>();
    result->context = context;
    result->path = path;
    result->desc = all;
    if (all.channels)
      result->channels.assign(all.channels, all.channels + all.channel_count);
    result->desc.channels = all.channels ? result->channels.data() : nullptr;
    result->width = pixels.width;
    result->height = height;
    result->channel_count = pixels.channels();
    result->is_double = pixels.is_double;
    begin_picture(context, path, pixels, height, result->desc, result->writing);
    *image = result.release();
  });
}

TetcastStatus tetcast_image_add(TetcastImage *image, const TetcastFrame *frame) {
  const FloatingPoint guard;
  if (!image || !frame)
    return tetcast_context_error(image ? image->context : nullptr, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_image_add: image and frame are needed");
  const char *path = image->path.c_str();
  const TetcastStatus status = tetcast::guard_writing(image->context, path, [&] {
    const Pixels pixels = pixels_of(frame, &image->desc);
    const int64_t end = image->rows + pixels.height;
    if (image->failed || pixels.width != image->width || pixels.is_double != image->is_double ||
        pixels.channels() != image->channel_count || end > image->height ||
        (end < image->height && pixels.height % batch_rows != 0))
      fail(image->context, TETCAST_ERROR_ARGUMENT, path, "the frame is not the next band of the picture");
    const std::string reason =
        unfit(image->writing.output->format_name(), image->writing.type, pixels, image->desc.background[3] >= 1);
    if (!reason.empty())
      fail(image->context, TETCAST_ERROR_ARGUMENT, path, reason);
    const bool done = write_rows(*image->writing.output, pixels, image->rows, *image->writing.scenery);
    image->rows = end;
    if (!done || image->writing.proxy->error_number() != 0)
      tetcast::check_written(image->context, path, image->writing.output->geterror(),
                             image->writing.proxy->error_number(), done);
  });
  image->failed = image->failed || status != TETCAST_OK;
  return status;
}

TetcastStatus tetcast_image_end(TetcastImage **image) {
  const FloatingPoint guard;
  if (!image || !*image)
    return TETCAST_ERROR_ARGUMENT;
  const std::unique_ptr<TetcastImage> owned(*image);
  *image = nullptr;
  const char *path = owned->path.c_str();
  return tetcast::guard_writing(owned->context, path, [&] {
    if (owned->failed || owned->rows < owned->height)
      fail(owned->context, TETCAST_ERROR_ARGUMENT, path, "rows of the picture are missing");
    end_picture(owned->context, path, owned->writing, true, true);
  });
}

void tetcast_image_destroy(TetcastImage **image) {
  const FloatingPoint guard;
  if (!image || !*image)
    return;
  (*image)->writing.output->close(); // as destructors would, but without a word about missing rows
  (void)(*image)->writing.output->geterror();
  delete *image;
  *image = nullptr;
}

TetcastStatus tetcast_image_check(TetcastContext *context, const char *path, const TetcastImageDesc *desc) {
  if (!context || !path)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "tetcast_image_check: context and path are needed");
  static const float pixel[4] = {0, 0, 0, 0};
  return guarded(context, path, {pixel, 1, 1, sizeof pixel, false, {}, false}, desc, false);
}
