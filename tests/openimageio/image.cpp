// SPDX-License-Identifier: Apache-2.0
// What lands in image files, and that nothing does when writing fails.
#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

extern "C" {
#include <cmocka.h>
}

#include <OpenImageIO/imageio.h>

#include "fixture.hpp"

#include <tetcast/image.h>
#include <tetcast/tetcast.h>

namespace fs = std::filesystem;
using OIIO::TypeDesc;

// Counts what is printed on stderr, by any library, while it lives.
class Listener {
public:
  Listener() : m_words(std::tmpfile()) {
    std::fflush(stderr);
    m_saved = dup(2);
    dup2(fileno(m_words), 2);
  }
  ~Listener() {
    if (m_saved >= 0)
      stop();
  }
  long stop() {
    std::fflush(stderr);
    dup2(m_saved, 2);
    close(m_saved);
    m_saved = -1;
    const long count = std::fseek(m_words, 0, SEEK_END) == 0 ? std::ftell(m_words) : -1;
    std::fclose(m_words);
    return count;
  }

private:
  std::FILE *m_words;
  int m_saved;
};

static size_t file_count() {
  return size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

static void clear_folder() {
  for (const auto &entry : fs::directory_iterator(folder))
    fs::remove_all(entry.path());
  last_error.clear();
  last_warning.clear();
}

// Premultiplied values with all kinds of alpha, some colours brighter than white, some pixels empty.
static std::vector<double> sample_pixels(int64_t width, int64_t height) {
  std::vector<double> pixels;
  uint64_t state = 1;
  const auto next = [&state] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return double(state >> 11) * 0x1p-53;
  };
  for (int64_t i = 0; i < width * height; i++) {
    const double alpha = i % 7 == 0 ? 0 : i % 7 == 1 ? 1 : next();
    for (int c = 0; c < 3; c++)
      pixels.push_back(alpha * next() * (i % 11 == 0 ? 1.5 : 1));
    pixels.push_back(alpha);
  }
  return pixels;
}

static TetcastFrame *borrow_frame(void *pixels, TetcastType type, int64_t width, int64_t height, int64_t row_stride) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  desc.type = type;
  desc.pixels = pixels;
  desc.row_stride = row_stride;
  TetcastFrame *frame = nullptr;
  assert_int_equal(tetcast_frame_create(context, &desc, &frame), TETCAST_OK);
  return frame;
}

static TetcastStatus write(const fs::path &path, std::vector<double> &pixels, int64_t width, int64_t height,
                           TetcastPixelType type, const double *background = nullptr) {
  TetcastFrame *frame = borrow_frame(pixels.data(), TETCAST_TYPE_FLOAT64, width, height, 0);
  TetcastImageDesc desc = tetcast_image_desc_default();
  desc.pixel_type = type;
  if (background)
    std::copy(background, background + 4, desc.background);
  const TetcastStatus status = tetcast_image_write(context, path.c_str(), frame, &desc);
  tetcast_frame_destroy(&frame);
  return status;
}

struct Picture {
  OIIO::ImageSpec spec;
  std::vector<double> values;
};

// As stored: neither premultiplied nor otherwise changed.
static Picture read_back(const fs::path &path) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  auto input = OIIO::ImageInput::open(path.string(), &config);
  if (!input)
    fail_msg("%s: %s", path.c_str(), OIIO::geterror().c_str());
  Picture picture;
  picture.spec = input->spec();
  picture.values.resize(size_t(picture.spec.width) * size_t(picture.spec.height) * size_t(picture.spec.nchannels));
  assert_true(input->read_image(0, 0, 0, picture.spec.nchannels, TypeDesc::DOUBLE, picture.values.data()));
  input->close();
  return picture;
}

static const TypeDesc::BASETYPE base_types[] = {TypeDesc::UNKNOWN, TypeDesc::UINT8, TypeDesc::UINT16,
                                                TypeDesc::HALF,    TypeDesc::FLOAT, TypeDesc::DOUBLE};

static double quantized(double value, double top) {
  return std::floor(std::clamp(value, 0.0, 1.0) * top + 0.5) / top;
}

// Compares with values computed here; `tolerance` is for formats that lose information.
static void compare(const Picture &picture, const std::vector<double> &pixels, const double background[4],
                    double tolerance) {
  const bool floating = picture.spec.format.is_floating_point();
  const int channels = picture.spec.nchannels;
  const double top = picture.spec.format == TypeDesc::UINT16 ? 65535 : 255;
  for (size_t i = 0; i < pixels.size() / 4; i++) {
    const double *p = &pixels[4 * i];
    const double alpha = p[3] + (1 - p[3]) * background[3];
    for (int c = 0; c < channels; c++) {
      double expected = p[c];
      if (!floating && c == 3)
        expected = quantized(alpha, top);
      else if (!floating) {
        const double color = p[c] + (1 - p[3]) * background[3] * background[c];
        expected = quantized(channels == 3 ? color : alpha > 0 ? color / alpha : 0, top);
      }
      const double got = picture.values[i * size_t(channels) + size_t(c)];
      const double error =
          picture.spec.format == TypeDesc::HALF ? std::max(1e-7, std::fabs(expected) * 0x1p-11) * 1.001 : tolerance;
      if (std::fabs(got - expected) > error)
        fail_msg("pixel %zu channel %d: %.17g instead of %.17g", i, c, got, expected);
    }
  }
}

// Coefficients of so many groups, each other multiples of the field.
static void set_groups(TetcastScene *scene, const double values[4], int groups) {
  std::vector<TetcastField *> fields;
  for (int g = 0; g < groups; g++) {
    const double multiples[4] = {values[0] * (g + 1), values[1] * (g + 1), values[2] * (g + 1), values[3] * (g + 1)};
    TetcastFieldDesc desc = tetcast_field_desc_default();
    desc.values.data = multiples;
    desc.values.type = TETCAST_TYPE_FLOAT64;
    desc.values.count = 4;
    TetcastField *field = nullptr;
    assert_int_equal(tetcast_field_create(context, &desc, &field), TETCAST_OK);
    fields.push_back(field);
  }
  TetcastCoefficientsDesc desc = tetcast_coefficients_desc_default();
  desc.extinction = desc.emission = fields.data();
  desc.extinction_count = desc.emission_count = groups;
  assert_int_equal(tetcast_scene_set_coefficients(scene, &desc), TETCAST_OK);
  for (TetcastField *field : fields)
    tetcast_field_destroy(&field);
}

// A picture of one tetrahedron with an error channel, or of so many groups with all channels of theirs.
static TetcastFrame *render_channels(TetcastType type, int64_t width, int64_t height, int groups) {
  static const double vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, values[4] = {0, 1, 2, 3};
  static const int32_t cell[4] = {0, 1, 2, 3};
  static const double color[4] = {0, 1, 0.5, 0.25}, extinction[2][2] = {{0, 0}, {3, 2}};
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  mesh_desc.vertices.data = vertices;
  mesh_desc.vertices.type = TETCAST_TYPE_FLOAT64;
  mesh_desc.vertices.count = 4;
  mesh_desc.tetrahedra.data = cell;
  mesh_desc.tetrahedra.type = TETCAST_TYPE_INT32;
  mesh_desc.tetrahedra.count = 1;
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  field_desc.values.data = values;
  field_desc.values.type = TETCAST_TYPE_FLOAT64;
  field_desc.values.count = 4;
  TetcastTransferFunctionDesc transfer_desc = tetcast_transfer_function_desc_default();
  transfer_desc.color = color;
  transfer_desc.color_count = 1;
  transfer_desc.extinction = extinction[0];
  transfer_desc.extinction_count = 2;
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = width;
  frame_desc.height = height;
  frame_desc.type = type;
  frame_desc.channels = groups == 0 ? unsigned(TETCAST_CHANNEL_ERROR)
                                    : unsigned(TETCAST_CHANNEL_RADIANCE | TETCAST_CHANNEL_OPTICAL_DEPTH |
                                               TETCAST_CHANNEL_TRANSMITTANCE | TETCAST_CHANNEL_PATH_LENGTH);
  frame_desc.groups = std::max(groups, 1);
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.tolerance = 1e-3;
  TetcastMesh *mesh = nullptr;
  TetcastField *field = nullptr;
  TetcastVolume *volume = nullptr;
  TetcastTransferFunction *transfer = nullptr;
  TetcastScene *scene = nullptr;
  TetcastFrame *frame = nullptr;
  assert_int_equal(tetcast_mesh_create(context, &mesh_desc, &mesh), TETCAST_OK);
  assert_int_equal(tetcast_field_create(context, &field_desc, &field), TETCAST_OK);
  assert_int_equal(tetcast_volume_create(context, mesh, nullptr, &volume), TETCAST_OK);
  assert_int_equal(tetcast_transfer_function_create(context, &transfer_desc, &transfer), TETCAST_OK);
  assert_int_equal(tetcast_scene_create(context, volume, &scene), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_field(scene, field), TETCAST_OK);
  assert_int_equal(tetcast_scene_set_transfer_function(scene, transfer), TETCAST_OK);
  if (groups > 0)
    set_groups(scene, values, groups);
  assert_int_equal(tetcast_frame_create(context, &frame_desc, &frame), TETCAST_OK);
  const double bounds[6] = {0, 1, 0, 1, 0, 1};
  const TetcastCamera camera = tetcast_camera_default(bounds, double(width) / double(height));
  assert_int_equal(tetcast_scene_render(scene, &camera, &desc, frame, nullptr), TETCAST_OK);
  tetcast_scene_destroy(&scene);
  tetcast_transfer_function_destroy(&transfer);
  tetcast_volume_destroy(&volume);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  return frame;
}

static void the_error_is_a_fifth_channel(void **) {
  clear_folder();
  const int64_t width = 19, height = 83; // more rows than are written at a time
  const struct {
    const char *name;
    TetcastPixelType type;
    TypeDesc::BASETYPE stored; // UNKNOWN: refused
  } cases[] = {{"a.exr", TETCAST_PIXEL_DEFAULT, TypeDesc::FLOAT}, {"b.exr", TETCAST_PIXEL_FLOAT, TypeDesc::FLOAT},
               {"a.tif", TETCAST_PIXEL_DEFAULT, TypeDesc::FLOAT}, {"b.tif", TETCAST_PIXEL_DOUBLE, TypeDesc::DOUBLE},
               {"c.tif", TETCAST_PIXEL_HALF, TypeDesc::UNKNOWN},  {"c.png", TETCAST_PIXEL_DEFAULT, TypeDesc::UNKNOWN},
               {"d.tif", TETCAST_PIXEL_UINT8, TypeDesc::UNKNOWN}, {"c.hdr", TETCAST_PIXEL_DEFAULT, TypeDesc::UNKNOWN}};
  for (const TetcastType type : {TETCAST_TYPE_FLOAT32, TETCAST_TYPE_FLOAT64}) {
    TetcastFrame *frame = render_channels(type, width, height, 0);
    const void *error = tetcast_frame_channel(frame, TETCAST_CHANNEL_ERROR);
    for (const auto &item : cases) {
      const fs::path path = folder / item.name;
      TetcastImageDesc desc = tetcast_image_desc_default();
      desc.pixel_type = item.type;
      const TetcastStatus status = tetcast_image_write(context, path.c_str(), frame, &desc);
      assert_int_equal(status, item.stored == TypeDesc::UNKNOWN ? TETCAST_ERROR_ARGUMENT : TETCAST_OK);
      assert_int_equal(fs::exists(path), status == TETCAST_OK);
      if (status != TETCAST_OK)
        continue;
      const Picture picture = read_back(path);
      assert_int_equal(picture.spec.nchannels, 5);
      if (path.extension() == ".exr") // TIFF keeps no names
        assert_string_equal(picture.spec.channelnames[4].c_str(), "error");
      assert_int_equal(picture.spec.channelformat(4).basetype, item.stored);
      double largest = 0;
      for (size_t i = 0; i < size_t(width * height); i++) {
        const double value = type == TETCAST_TYPE_FLOAT64 ? static_cast<const double *>(error)[i]
                                                          : double(static_cast<const float *>(error)[i]);
        const bool narrow = item.stored == TypeDesc::FLOAT;
        assert_true(picture.values[5 * i + 4] == (narrow ? double(float(value)) : value));
        const double *pixel = static_cast<const double *>(tetcast_frame_pixels(frame)) + 4 * i;
        if (type == TETCAST_TYPE_FLOAT64 && !narrow)
          assert_memory_equal(&picture.values[5 * i], pixel, 4 * sizeof *pixel);
        largest = std::max(largest, value);
      }
      assert_true(largest > 0 && largest <= 1e-3);
    }
    tetcast_frame_destroy(&frame);
  }
  clear_folder();
}

// A file of 8-bit pixels holds what tetcast_frame_bytes() makes.
static void files_of_bytes_hold_a_frames_bytes(void **) {
  clear_folder();
  const int64_t width = 37, height = 90;
  std::vector<double> pixels = sample_pixels(width, height);
  const double backgrounds[][4] = {{1, 1, 1, 1}, {0.1, 0.6, 0.35, 1}, {0.3, 0.2, 0.9, 0.4}, {0, 0, 0, 0}};
  TetcastFrame *frame = borrow_frame(pixels.data(), TETCAST_TYPE_FLOAT64, width, height, 0);
  for (const auto &background : backgrounds) {
    const int channels = background[3] == 1 ? 3 : 4;
    std::vector<unsigned char> bytes(size_t(width * height * channels));
    assert_int_equal(write(folder / "a.png", pixels, width, height, TETCAST_PIXEL_DEFAULT, background), TETCAST_OK);
    assert_int_equal(tetcast_frame_bytes(frame, background, channels, bytes.data(), 0), TETCAST_OK);
    const Picture picture = read_back(folder / "a.png");
    assert_int_equal(picture.spec.nchannels, channels);
    for (size_t i = 0; i < bytes.size(); i++)
      assert_int_equal(std::lround(255 * picture.values[i]), bytes[i]);
  }
  tetcast_frame_destroy(&frame);
  clear_folder();
}

static double at(const TetcastFrame *frame, const void *values, size_t i) {
  return tetcast_frame_type(frame) == TETCAST_TYPE_FLOAT64 ? static_cast<const double *>(values)[i]
                                                           : double(static_cast<const float *>(values)[i]);
}

// Radiance, optical depth and transmittance of each group, then the path's length, behind colour and alpha or without
// them.
static void groups_are_channels(void **) {
  clear_folder();
  const int64_t width = 19, height = 83;
  const struct {
    const char *name;
    TetcastType type;
    int groups;
    bool only;
  } cases[] = {{"a.exr", TETCAST_TYPE_FLOAT32, 1, false}, {"b.exr", TETCAST_TYPE_FLOAT32, 12, false},
               {"c.exr", TETCAST_TYPE_FLOAT32, 12, true}, {"d.tif", TETCAST_TYPE_FLOAT64, 3, true},
               {"e.tif", TETCAST_TYPE_FLOAT32, 2, false}, {"f.exr", TETCAST_TYPE_FLOAT64, 1, true}};
  const TetcastChannel kinds[] = {TETCAST_CHANNEL_RADIANCE, TETCAST_CHANNEL_OPTICAL_DEPTH,
                                  TETCAST_CHANNEL_TRANSMITTANCE};
  const char *const names[] = {"radiance", "optical_depth", "transmittance"};
  for (const auto &item : cases) {
    TetcastFrame *frame = render_channels(item.type, width, height, item.groups);
    const fs::path path = folder / item.name;
    TetcastImageDesc desc = tetcast_image_desc_default();
    desc.channels_only = item.only;
    if (path.extension() == ".tif" && item.type == TETCAST_TYPE_FLOAT64)
      desc.pixel_type = TETCAST_PIXEL_DOUBLE;
    assert_int_equal(tetcast_image_write(context, path.c_str(), frame, &desc), TETCAST_OK);
    const Picture picture = read_back(path);
    const int first = item.only ? 0 : 4, channels = picture.spec.nchannels;
    assert_int_equal(channels, first + 3 * item.groups + 1);
    // EXR keeps channels by name, TIFF by place.
    const auto place = [&](const std::string &name, int number) {
      if (path.extension() == ".tif")
        return first + number;
      const auto &list = picture.spec.channelnames;
      const auto found = std::find(list.begin(), list.end(), name);
      if (found == list.end())
        fail_msg("%s: no channel %s", path.c_str(), name.c_str());
      return int(found - list.begin());
    };
    double largest = 0;
    for (int kind = 0; kind < 3; kind++) {
      for (int g = 0; g < item.groups; g++) {
        char name[64];
        std::snprintf(name, sizeof name,
                      item.groups == 1   ? "%s"
                      : item.groups > 10 ? "%s.%02d"
                                         : "%s.%d",
                      names[kind], g);
        const int channel = place(name, kind * item.groups + g);
        assert_true(picture.spec.channelformat(channel).basetype ==
                    (desc.pixel_type ? TypeDesc::DOUBLE : TypeDesc::FLOAT));
        for (size_t i = 0; i < size_t(width * height); i++) {
          const double value =
              at(frame, tetcast_frame_channel(frame, kinds[kind]), i * size_t(item.groups) + size_t(g));
          assert_true(picture.values[i * size_t(channels) + size_t(channel)] ==
                      (desc.pixel_type ? value : double(float(value))));
          if (kind == 0)
            largest = std::max(largest, value);
        }
      }
    }
    assert_true(largest > 0);
    const int last = place("path_length", 3 * item.groups);
    for (size_t i = 0; i < size_t(width * height); i++) {
      const double value = at(frame, tetcast_frame_channel(frame, TETCAST_CHANNEL_PATH_LENGTH), i);
      assert_true(picture.values[i * size_t(channels) + size_t(last)] ==
                  (desc.pixel_type ? value : double(float(value))));
    }
    tetcast_frame_destroy(&frame);
  }
  TetcastFrame *frame = render_channels(TETCAST_TYPE_FLOAT32, 4, 4, 2);
  assert_int_equal(tetcast_image_write(context, (folder / "a.png").c_str(), frame, nullptr), TETCAST_ERROR_ARGUMENT);
  assert_non_null(std::strstr(last_error.c_str(), "the channel radiance"));
  tetcast_frame_destroy(&frame);
  clear_folder();
}

static void formats_hold_what_they_should(void **) {
  const int64_t width = 37, height = 131; // two whole batches of rows and a part
  std::vector<double> pixels = sample_pixels(width, height);
  const double white[4] = {1, 1, 1, 1}, blue[4] = {0.2, 0.3, 0.9, 1}, glass[4] = {0.8, 0.4, 0.1, 0.35},
               none[4] = {0, 0, 0, 0};
  const struct {
    const char *name;
    bool possible[6]; // default, uint8, uint16, half, float, double
    TypeDesc::BASETYPE standard;
  } formats[] = {{"a.png", {true, true, true, false, false, false}, TypeDesc::UINT8},
                 {"a.PNG", {true, true, true, false, false, false}, TypeDesc::UINT8},
                 {"a.exr", {true, false, false, true, true, false}, TypeDesc::HALF},
                 {"a.tif", {true, true, true, true, true, true}, TypeDesc::FLOAT},
                 {"a.tiff", {true, true, true, true, true, true}, TypeDesc::FLOAT},
                 {"a.jpg", {true, true, false, false, false, false}, TypeDesc::UINT8},
                 {"a.bmp", {true, true, false, false, false, false}, TypeDesc::UINT8},
                 {"a.tga", {true, true, false, false, false, false}, TypeDesc::UINT8}};
  for (const auto &format : formats) {
    for (int type = 0; type < 6; type++) {
      for (const double *background : {white, blue, glass, none}) {
        clear_folder();
        const fs::path path = folder / format.name;
        Listener writing;
        const TetcastStatus status = write(path, pixels, width, height, TetcastPixelType(type), background);
        assert_int_equal(writing.stop(), 0);
        TetcastImageDesc desc = tetcast_image_desc_default();
        desc.pixel_type = TetcastPixelType(type);
        Listener listener;
        const TetcastStatus check = tetcast_image_check(context, path.c_str(), &desc);
        assert_int_equal(listener.stop(), 0);
        assert_int_equal(check, status);
        if (!format.possible[type]) {
          assert_int_equal(status, TETCAST_ERROR_ARGUMENT);
          assert_non_null(std::strstr(last_error.c_str(), format.name));
          assert_int_equal(file_count(), 0);
          continue;
        }
        assert_int_equal(status, TETCAST_OK);
        assert_int_equal(file_count(), 1);
        const Picture picture = read_back(path);
        const TypeDesc stored = picture.spec.format;
        assert_int_equal(stored.basetype, type ? base_types[type] : format.standard);
        assert_int_equal(picture.spec.width, width);
        assert_int_equal(picture.spec.height, height);
        const bool jpeg = format.name[2] == 'j';
        const bool alpha = !jpeg && (stored.is_floating_point() || background[3] < 1);
        assert_int_equal(picture.spec.nchannels, alpha ? 4 : 3);
        if (alpha)
          assert_int_equal(picture.spec.alpha_channel, 3);
        if (jpeg && background[3] < 1)
          assert_false(last_warning.empty());
        if (!jpeg) // random pixels are the worst case of JPEG: seen with a smooth picture below
          compare(picture, pixels, background, stored == TypeDesc::DOUBLE ? 0 : 1e-7); // the reader goes through float
      }
    }
  }
}

// Nothing is premultiplied twice or not at all where the pixels are read without a library: those of a .bmp, .tga or
// .ppm lie in the file as they are, the first two from the bottom, blue first.
static std::vector<double> raw_pixels(const fs::path &path, int64_t width, int64_t height, int channels, bool wide) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<unsigned char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const bool bmp = path.extension() == ".bmp", ppm = path.extension() == ".ppm" || path.extension() == ".pnm";
  const int64_t row = bmp ? (width * channels + 3) / 4 * 4 : width * channels * (wide ? 2 : 1);
  const int64_t start = bmp ? bytes[10] : ppm ? int64_t(bytes.size()) - row * height : 18 + bytes[0];
  std::vector<double> values;
  for (int64_t y = 0; y < height; y++)
    for (int64_t i = 0; i < width * channels; i++) {
      const int64_t c = i % channels, from = ppm || c == 3 ? i : i - c + 2 - c;
      const unsigned char *at = &bytes[size_t(start + (ppm ? y : height - 1 - y) * row + (wide ? 2 * from : from))];
      values.push_back(wide ? (256 * at[0] + at[1]) / 65535.0 : at[0] / 255.0); // .ppm has the higher byte first
    }
  return values;
}

// Whatever OpenImageIO writes here is the picture when it is read back, or is refused: every extension that it knows,
// with every type of pixel, over every kind of background.
static void every_format_holds_the_picture_or_is_refused(void **) {
  const int64_t width = 37, height = 70;
  std::vector<double> pixels; // smooth, for the formats that lose what is not; with all kinds of alpha
  for (int64_t y = 0; y < height; y++)
    for (int64_t x = 0; x < width; x++) {
      const double alpha = x == 0 ? 0 : x + 1 == width ? 1 : (double(x) + 0.213) / double(width);
      const double red = (double(y) + 0.317) / double(height); // no halves of a level, whose rounding is free
      for (const double color : {red, 0.437, 1 - red, 1.0})
        pixels.push_back(alpha * color);
    }
  const double white[4] = {1, 1, 1, 1}, blue[4] = {0.2, 0.3, 0.9, 1}, glass[4] = {0.8, 0.4, 0.1, 0.35},
               none[4] = {0, 0, 0, 0};
  std::string accepted, list = OIIO::get_string_attribute("extension_list"); // "tiff:tif,tiff;png:png;…"
  std::replace(list.begin(), list.end(), ';', ',');
  std::istringstream entries(list);
  for (std::string entry; std::getline(entries, entry, ',');) {
    const std::string extension = entry.substr(entry.find(':') + 1);
    bool any = false;
    for (int type = 0; type < 6; type++)
      for (const double *background : {white, blue, glass, none}) {
        clear_folder();
        const fs::path path = folder / ("a." + extension);
        TetcastImageDesc desc = tetcast_image_desc_default();
        desc.pixel_type = TetcastPixelType(type);
        std::copy(background, background + 4, desc.background);
        const TetcastStatus check = tetcast_image_check(context, path.c_str(), &desc);
        const TetcastStatus status = write(path, pixels, width, height, TetcastPixelType(type), background);
        assert_int_equal(check, status);
        if (status != TETCAST_OK) {
          assert_int_equal(status, TETCAST_ERROR_ARGUMENT);
          assert_int_equal(file_count(), 0);
          continue;
        }
        any = true;
        const Picture picture = read_back(path);
        const bool lossy = extension[0] == 'j' || extension == "webp";
        const bool rgbe = extension == "hdr" || extension == "rgbe"; // 8 bits of the largest of three
        // OpenImageIO 2.5 reads 65535 of such a file as 65534; what the file itself has is looked at below.
        const bool pnm = (extension == "ppm" || extension == "pnm") && !picture.spec.format.is_floating_point();
        if (picture.spec.nchannels == 3 && background[3] < 1)
          assert_false(last_warning.empty());
        compare(picture, pixels, background, lossy ? 0.05 : rgbe ? 0x1p-7 : pnm ? 2e-5 : 1e-7);
        if (extension == "bmp" || extension == "tga" || pnm) {
          Picture raw = picture;
          raw.values = raw_pixels(path, width, height, picture.spec.nchannels, picture.spec.format == TypeDesc::UINT16);
          compare(raw, pixels, background, 1e-7);
        }
      }
    if (any)
      accepted += extension + " ";
  }
  for (const char *name : {"png ", "exr ", "tif ", "tiff ", "jpg ", "jpeg ", "bmp ", "tga ", "webp ", "ppm ", "hdr "})
    if (accepted.find(name) == std::string::npos)
      fail_msg("%swas not written; only %s", name, accepted.c_str());
  for (const char *name : {"pgm", "pbm", "pfm", "tx", "sxr", "gif", "psd"}) // promise something else, or were not tried
    if (accepted.find(name) != std::string::npos)
      fail_msg("%s was written", name);
}

static void webp_is_for_opaque_backgrounds(void **) {
  clear_folder();
  std::vector<double> pixels = sample_pixels(8, 8);
  const double glass[4] = {1, 1, 1, 0.999};
  assert_int_equal(write(folder / "a.webp", pixels, 8, 8, TETCAST_PIXEL_DEFAULT, glass), TETCAST_ERROR_ARGUMENT);
  assert_non_null(std::strstr(last_error.c_str(), "opaque background"));
  assert_int_equal(file_count(), 0);
  assert_int_equal(write(folder / "a.webp", pixels, 8, 8, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
}

static void colors_beyond_a_type_do_not_become_infinite(void **) {
  clear_folder();
  const struct {
    double color;
    TypeDesc::BASETYPE standard;
    bool half, radiance;
  } cases[] = {{0, TypeDesc::HALF, true, true},         {0.1, TypeDesc::HALF, true, true},
               {65504, TypeDesc::HALF, true, true},     {65600, TypeDesc::FLOAT, false, true},
               {-70000, TypeDesc::FLOAT, false, false}, {1e-9, TypeDesc::FLOAT, true, true},
               {-0.5, TypeDesc::HALF, true, false},     {3e38, TypeDesc::FLOAT, false, false}};
  for (const auto &one : cases) {
    std::vector<double> pixels = {0, 0, one.color, 1};
    assert_int_equal(write(folder / "a.exr", pixels, 1, 1, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
    const Picture picture = read_back(folder / "a.exr");
    assert_int_equal(picture.spec.format.basetype, one.standard);
    assert_true(std::fabs(picture.values[2] - one.color) <= std::fabs(one.color) * 0x1p-11);
    const TetcastStatus half = write(folder / "b.exr", pixels, 1, 1, TETCAST_PIXEL_HALF);
    assert_int_equal(half, one.half ? TETCAST_OK : TETCAST_ERROR_ARGUMENT);
    if (!one.half)
      assert_non_null(std::strstr(last_error.c_str(), "65504"));
    const TetcastStatus radiance = write(folder / "a.hdr", pixels, 1, 1, TETCAST_PIXEL_DEFAULT);
    assert_int_equal(radiance, one.radiance ? TETCAST_OK : TETCAST_ERROR_ARGUMENT);
  }
}

static void jpeg_is_near_a_smooth_picture(void **) {
  clear_folder();
  const int64_t width = 64, height = 48;
  std::vector<double> pixels;
  for (int64_t y = 0; y < height; y++)
    for (int64_t x = 0; x < width; x++)
      for (const double value : {0.5 * double(x) / 64, 0.5 * double(y) / 48, 0.25, 0.75})
        pixels.push_back(value);
  const double gray[4] = {0.5, 0.5, 0.5, 1};
  assert_int_equal(write(folder / "a.jpeg", pixels, width, height, TETCAST_PIXEL_DEFAULT, gray), TETCAST_OK);
  compare(read_back(folder / "a.jpeg"), pixels, gray, 0.02);
}

static void doubles_come_back_bit_for_bit(void **) {
  const int64_t width = 64, height = 70;
  std::vector<double> pixels = sample_pixels(width, height);
  const double awkward[] = {0x1p-1074, -0.0, 1e300, -1e-300, 1 + 0x1p-52, 1.0 / 3, 1e-17, 65504};
  std::copy(std::begin(awkward), std::end(awkward), pixels.begin());
  clear_folder();
  assert_int_equal(write(folder / "a.tif", pixels, width, height, TETCAST_PIXEL_DOUBLE), TETCAST_OK);
  const Picture picture = read_back(folder / "a.tif");
  assert_int_equal(picture.values.size(), pixels.size());
  assert_memory_equal(picture.values.data(), pixels.data(), pixels.size() * sizeof(double));
}

// The tag that says how alpha is meant, without OpenImageIO in between.
static int tiff_short_tag(const fs::path &path, unsigned wanted) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<unsigned char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto u16 = [&](size_t at) { return unsigned(bytes[at]) | unsigned(bytes[at + 1]) << 8; };
  const auto u32 = [&](size_t at) { return u16(at) | u16(at + 2) << 16; };
  assert_int_equal(bytes[0], 'I');
  const size_t directory = u32(4);
  for (size_t i = 0; i < u16(directory); i++)
    if (u16(directory + 2 + 12 * i) == wanted)
      return int(u16(directory + 2 + 12 * i + 8));
  return -1;
}

static void tiff_states_how_alpha_is_meant(void **) {
  const double glass[4] = {1, 1, 1, 0.5};
  std::vector<double> pixels = sample_pixels(8, 8);
  const unsigned extra_samples = 338, predictor = 317;
  clear_folder();
  assert_int_equal(write(folder / "a.tif", pixels, 8, 8, TETCAST_PIXEL_DOUBLE), TETCAST_OK);
  assert_int_equal(tiff_short_tag(folder / "a.tif", extra_samples), 1); // associated
  assert_true(tiff_short_tag(folder / "a.tif", predictor) <= 1);        // none: every reader can
  assert_int_equal(write(folder / "b.tif", pixels, 8, 8, TETCAST_PIXEL_UINT8, glass), TETCAST_OK);
  assert_int_equal(tiff_short_tag(folder / "b.tif", extra_samples), 2); // unassociated
}

static void rows_may_lie_apart(void **) {
  const int64_t width = 5, height = 3;
  std::vector<float> pixels(6 * 4 * 3, -1.0f); // a column of padding, which must not be seen
  std::vector<double> tight;
  for (int64_t y = 0; y < height; y++)
    for (int64_t i = 0; i < 4 * width; i++)
      tight.push_back(pixels[size_t(y * 24 + i)] = float(y * 20 + i) / 64.0f);
  TetcastFrame *frame = borrow_frame(pixels.data(), TETCAST_TYPE_FLOAT32, width, height, 24 * sizeof(float));
  const double white[4] = {1, 1, 1, 1};
  for (const char *name : {"a.exr", "a.tif", "a.png"}) {
    assert_int_equal(tetcast_image_write(context, (folder / name).c_str(), frame, nullptr), TETCAST_OK);
    compare(read_back(folder / name), tight, white, 1e-7);
  }
  tetcast_frame_destroy(&frame);
}

static void not_a_number_is_written_without_a_crash(void **) {
  std::vector<double> pixels = {NAN, INFINITY, -INFINITY, NAN, 1e308, -1, 0, INFINITY};
  for (const char *name : {"a.png", "a.exr", "a.tif", "a.jpg"})
    assert_int_equal(write(folder / name, pixels, 2, 1, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
}

static std::string content(const fs::path &path) {
  std::ifstream file(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

static void same_picture_same_file(void **) {
  std::vector<double> pixels = sample_pixels(20, 20);
  const char *const names[] = {"a.png", "a.exr", "a.tif", "a.jpg"};
  std::string first[4];
  clear_folder();
  for (int i = 0; i < 4; i++) {
    assert_int_equal(write(folder / names[i], pixels, 20, 20, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
    first[i] = content(folder / names[i]);
  }
  usleep(1100000); // a time in the file would differ
  for (int i = 0; i < 4; i++) {
    assert_int_equal(write(folder / names[i], pixels, 20, 20, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
    if (content(folder / names[i]) != first[i])
      fail_msg("%s differs", names[i]);
  }
}

static void expect_failure(const fs::path &path, TetcastStatus status, const char *word) {
  std::vector<double> pixels = sample_pixels(4, 4);
  for (const bool check : {false, true}) {
    last_error.clear();
    assert_int_equal(check ? tetcast_image_check(context, path.c_str(), nullptr)
                           : write(path, pixels, 4, 4, TETCAST_PIXEL_DEFAULT),
                     status);
    if (last_error.find(word) == std::string::npos || last_error.find(path.string()) == std::string::npos)
      fail_msg("'%s' lacks '%s' or the path", last_error.c_str(), word);
    assert_int_equal(last_error.find('\n'), std::string::npos);
  }
}

static void impossible_targets_are_refused(void **) {
  clear_folder();
  expect_failure(folder / "missing" / "a.png", TETCAST_ERROR_IO, "folder does not exist");
  expect_failure(folder / "a", TETCAST_ERROR_ARGUMENT, "extension");
  expect_failure(folder / "a.b" / "a", TETCAST_ERROR_ARGUMENT, "extension");
  expect_failure(folder / "a.", TETCAST_ERROR_ARGUMENT, "extension");
  for (const char *name : {"a.vtu", "a.null", "a.term", "a.psd", "a.sgi", "a.gif", "a.pgm", "a.tx", "a.sxr"})
    expect_failure(folder / name, TETCAST_ERROR_ARGUMENT, "not supported");
  expect_failure(folder / (std::string(300, 'x') + ".png"), TETCAST_ERROR_IO, "name too long");
  assert_int_equal(file_count(), 0);
  fs::create_directory(folder / "d.png");
  expect_failure(folder / "d.png", TETCAST_ERROR_IO, "directory");
  assert_int_equal(mkfifo((folder / "pipe.png").c_str(), 0600), 0);
  expect_failure(folder / "pipe.png", TETCAST_ERROR_IO, "regular file");
  assert_true(fs::is_fifo(folder / "pipe.png"));
  assert_int_equal(file_count(), 2);
  clear_folder();
  if (geteuid() == 0) // to whom nothing is forbidden
    return;
  fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
  expect_failure(folder / "a.png", TETCAST_ERROR_IO, "ermission");
  fs::permissions(folder, fs::perms::owner_all);
}

static void wrong_descriptions_are_refused(void **) {
  std::vector<double> pixels = sample_pixels(1, 1);
  TetcastImageDesc desc;
  std::memset(&desc, 0, sizeof desc);
  assert_int_equal(tetcast_image_check(context, (folder / "a.png").c_str(), &desc), TETCAST_ERROR_ARGUMENT);
  const double bad[4] = {0, 0, NAN, 1};
  assert_int_equal(write(folder / "a.png", pixels, 1, 1, TETCAST_PIXEL_UINT8, bad), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(write(folder / "a.png", pixels, 1, 1, TetcastPixelType(7)), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_image_check(context, nullptr, nullptr), TETCAST_ERROR_ARGUMENT);
  assert_int_equal(tetcast_image_write(context, "a.png", nullptr, nullptr), TETCAST_ERROR_ARGUMENT);
}

static void pictures_too_large_for_a_format_are_refused(void **) {
  clear_folder();
  std::vector<int64_t> sides = {65501, 65536, 16384};
  std::vector<const char *> names = {"a.jpg", "a.tga", "a.webp"};
#if OIIO_VERSION >= OIIO_MAKE_VERSION(2, 5, 0) // where OpenImageIO limits what the formats don't
  for (const char *name : {"a.png", "a.bmp", "a.ppm"}) {
    sides.push_back(65536);
    names.push_back(name);
  }
#else
  sides.push_back(1000001);
  names.push_back("a.png");
#endif
  for (size_t i = 0; i < sides.size(); i++) {
    std::vector<double> pixels(size_t(sides[i]) * 4);
    for (const bool wide : {false, true}) {
      Listener listener;
      const TetcastStatus status =
          write(folder / names[i], pixels, wide ? sides[i] : 1, wide ? 1 : sides[i], TETCAST_PIXEL_DEFAULT);
      assert_int_equal(listener.stop(), 0);
      assert_int_equal(status, TETCAST_ERROR_ARGUMENT);
      assert_non_null(std::strstr(last_error.c_str(), std::to_string(sides[i] - 1).c_str()));
    }
    pixels.resize(pixels.size() - 4);
    assert_int_equal(write(folder / names[i], pixels, sides[i] - 1, 1, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
    assert_int_equal(write(folder / names[i], pixels, 1, sides[i] - 1, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
    assert_int_equal(read_back(folder / names[i]).spec.height, sides[i] - 1);
  }
}

static void check_leaves_nothing(void **) {
  clear_folder();
  const fs::path path = folder / "a.png";
  assert_int_equal(tetcast_image_check(context, path.c_str(), nullptr), TETCAST_OK);
  assert_int_equal(file_count(), 0);
  std::ofstream(path) << "old";
  assert_int_equal(tetcast_image_check(context, path.c_str(), nullptr), TETCAST_OK);
  assert_string_equal(content(path).c_str(), "old");
  assert_int_equal(file_count(), 1);
}

static void links_are_followed(void **) {
  clear_folder();
  std::vector<double> pixels = sample_pixels(4, 4);
  std::ofstream(folder / "real.png") << "old";
  fs::create_symlink("real.png", folder / "link.png");
  assert_int_equal(write(folder / "link.png", pixels, 4, 4, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
  assert_true(fs::is_symlink(folder / "link.png"));
  assert_int_equal(read_back(folder / "real.png").spec.width, 4);

  // Also to where there is nothing yet, link by link.
  clear_folder();
  fs::create_directory(folder / "deep");
  fs::create_symlink("deep/next.png", folder / "link.png");
  fs::create_symlink("../end.png", folder / "deep" / "next.png");
  assert_int_equal(tetcast_image_check(context, (folder / "link.png").c_str(), nullptr), TETCAST_OK);
  assert_int_equal(write(folder / "link.png", pixels, 4, 4, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
  assert_true(fs::is_symlink(folder / "link.png") && fs::is_symlink(folder / "deep" / "next.png"));
  assert_false(fs::is_symlink(folder / "end.png"));
  assert_int_equal(read_back(folder / "end.png").spec.width, 4);
  fs::create_symlink("missing/end.png", folder / "lost.png");
  expect_failure(folder / "lost.png", TETCAST_ERROR_IO, "folder does not exist");
  fs::create_symlink("loop.png", folder / "loop.png");
  assert_int_equal(write(folder / "loop.png", pixels, 4, 4, TETCAST_PIXEL_DEFAULT), TETCAST_ERROR_IO);
}

static void replaced_files_keep_their_mode(void **) {
  clear_folder();
  std::vector<double> pixels = sample_pixels(4, 4);
  const mode_t before = umask(022);
  for (const mode_t mode : {0600, 0640, 0666, 0604}) {
    std::ofstream(folder / "a.png") << "old";
    assert_int_equal(chmod((folder / "a.png").c_str(), mode), 0);
    assert_int_equal(write(folder / "a.png", pixels, 4, 4, TETCAST_PIXEL_DEFAULT), TETCAST_OK);
    struct stat status;
    assert_int_equal(stat((folder / "a.png").c_str(), &status), 0);
    assert_int_equal(status.st_mode & 07777, mode);
    assert_true(status.st_size > 10);
  }
  umask(before);
}

// A limit on the size of files stands for a full disk: every write beyond it fails, wherever in the file that is.
static void full_disk_leaves_the_old_file_and_no_word_on_stderr(void **) {
  const int64_t width = 200, height = 100;
  std::vector<double> pixels = sample_pixels(width, height);
  std::signal(SIGXFSZ, SIG_IGN);
  Listener listener;
  struct rlimit former;
  getrlimit(RLIMIT_FSIZE, &former);
  std::string trouble;
  for (const char *name : {"a.png", "a.exr", "a.tif", "a.jpg", "a.bmp", "a.tga", "a.webp", "a.hdr", "a.ppm"}) {
    clear_folder();
    if (write(folder / name, pixels, width, height, TETCAST_PIXEL_DEFAULT) != TETCAST_OK) {
      trouble += std::string(name) + " cannot be written at all: " + last_error + "; ";
      continue;
    }
    const std::string before = content(folder / name);
    const size_t whole = before.size();
    for (const size_t limit :
         {size_t(0), size_t(1), size_t(100), whole / 4, whole / 2, whole - 4096, whole - 9, whole - 1}) {
      const struct rlimit tight = {limit, former.rlim_max};
      setrlimit(RLIMIT_FSIZE, &tight);
      last_error.clear();
      const TetcastStatus status = write(folder / name, pixels, width, height, TETCAST_PIXEL_DEFAULT);
      setrlimit(RLIMIT_FSIZE, &former);
      if (status != TETCAST_ERROR_IO || last_error.find("too large") == std::string::npos ||
          content(folder / name) != before || file_count() != 1)
        trouble += std::string(name) + " at " + std::to_string(limit) + ": status " + std::to_string(status) + " " +
                   last_error + "; ";
    }
  }
  const long said = listener.stop();
  if (!trouble.empty())
    fail_msg("%s", trouble.c_str());
  assert_int_equal(said, 0);
}

int main() {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(formats_hold_what_they_should),
      cmocka_unit_test(files_of_bytes_hold_a_frames_bytes),
      cmocka_unit_test(the_error_is_a_fifth_channel),
      cmocka_unit_test(groups_are_channels),
      cmocka_unit_test(every_format_holds_the_picture_or_is_refused),
      cmocka_unit_test(webp_is_for_opaque_backgrounds),
      cmocka_unit_test(colors_beyond_a_type_do_not_become_infinite),
      cmocka_unit_test(jpeg_is_near_a_smooth_picture),
      cmocka_unit_test(doubles_come_back_bit_for_bit),
      cmocka_unit_test(tiff_states_how_alpha_is_meant),
      cmocka_unit_test(rows_may_lie_apart),
      cmocka_unit_test(not_a_number_is_written_without_a_crash),
      cmocka_unit_test(same_picture_same_file),
      cmocka_unit_test(impossible_targets_are_refused),
      cmocka_unit_test(wrong_descriptions_are_refused),
      cmocka_unit_test(pictures_too_large_for_a_format_are_refused),
      cmocka_unit_test(check_leaves_nothing),
      cmocka_unit_test(links_are_followed),
      cmocka_unit_test(replaced_files_keep_their_mode),
      cmocka_unit_test(full_disk_leaves_the_old_file_and_no_word_on_stderr),
  };
  return cmocka_run_group_tests_name("image", tests, setup, teardown);
}
