// SPDX-License-Identifier: Apache-2.0
#include "overlay.hpp"

#include <algorithm>
#include <cmath>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/strutil.h>

namespace {

using OIIO::ImageBuf;
using OIIO::ROI;
namespace Algo = OIIO::ImageBufAlgo;

// Fonts that Debian ships, and that come with what OpenImageIO or gnuplot need.
constexpr const char *fonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                 "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                                 "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
                                 "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                 "/usr/share/fonts/truetype/freefont/FreeSans.ttf",
                                 "/usr/share/fonts/opentype/urw-base35/NimbusSans-Regular.otf",
                                 "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf"};

std::string find_font() {
  for (const char *font : fonts)
    if (OIIO::Filesystem::is_regular(font))
      return font;
  return "";
}

// Whether OpenImageIO finds the letters in UTF-8. Some of its versions, 2.4.7 in Debian 12 among them, take only the
// last bits of each letter that isn't ASCII, and draw another one: 0 for a degree sign.
bool draws_all_letters() {
  std::vector<uint32_t> letters;
  OIIO::Strutil::utf8_to_unicode("\xC2\xB0", letters);
  return letters.size() == 1 && letters[0] == 0xB0;
}

// Text with a question mark for each letter that isn't ASCII.
std::string in_ascii(const char *text) {
  std::string plain;
  for (; *text; text++)
    if (const auto byte = static_cast<unsigned char>(*text); byte < 0x80)
      plain += *text;
    else if (byte >= 0xC0) // the first byte of a letter
      plain += '?';
  return plain;
}

// Where things go, in pixels of the picture.
struct Layout {
  int font = 0, bar = 0; // sizes of letters and width of the bar
  int left = 0, top = 0, bottom = 0;
  int labels = 0, right = 0; // where labels begin, and where all ends
  int title_left = 0, title_top = 0;
};

class Writer {
public:
  explicit Writer(int size) : m_size(size), m_font(find_font()) {}

  // What is wrong with the text, "": nothing.
  std::string problem() const {
    return m_font.empty() ? "the picture has no words: no font was found; the package fonts-dejavu-core has one"
                          : m_problem;
  }
  int width(const char *text) {
    return m_font.empty() || !text || !*text ? 0 : std::max(0, Algo::text_size(drawn(text), m_size, m_font).width());
  }
  // Draws text that begins at `left`, its middle line at `middle`.
  void draw(ImageBuf &image, int left, int middle, const char *text, float ink) {
    if (m_font.empty() || !text || !*text)
      return;
    const float color[4] = {ink, ink, ink, 1};
    const int baseline = middle + int(std::lround(0.36 * m_size)); // half the height of capitals and digits
    const std::string shown = drawn(text);
    if (!Algo::render_text(image, left, baseline, shown, m_size, m_font, color, Algo::TextAlignX::Left,
                           Algo::TextAlignY::Baseline) &&
        m_problem.empty())
      m_problem = "the picture has no words: " + image.geterror();
    if (shown != text && m_problem.empty())
      m_problem = "letters of '" + std::string(text) +
                  "' are drawn as question marks: this version of OpenImageIO draws ASCII alone";
  }

private:
  std::string drawn(const char *text) const { return m_all_letters ? text : in_ascii(text); }

  int m_size;
  bool m_all_letters = draws_all_letters();
  std::string m_font, m_problem;
};

Layout lay_out(const TetcastLegend &legend, int64_t width, int64_t height, Writer &writer, int font) {
  Layout layout;
  int widest = 0;
  for (int i = 0; i < legend.label_count; i++)
    widest = std::max(widest, writer.width(legend.labels[i]));
  const int margin = font, gap = font * 2 / 5, title = writer.width(legend.title);
  layout.font = font;
  layout.bar = legend.categories ? font : font * 6 / 5;
  layout.right = int(width) - margin;
  layout.labels = layout.right - widest;
  layout.left = layout.labels - gap - layout.bar;
  const int tall =
      legend.categories ? std::min(int(height) * 4 / 5, legend.color_count * font * 8 / 5) : int(height) / 2;
  layout.top = (int(height) - tall) / 2;
  layout.bottom = layout.top + tall;
  layout.title_left = std::max(margin, std::min(layout.left, layout.right - title));
  layout.title_top = layout.top - font * 8 / 5;
  return layout;
}

void fill(ImageBuf &image, int left, int top, int right, int bottom, const double rgb[3], float alpha) {
  const float color[4] = {float(rgb[0]) * alpha, float(rgb[1]) * alpha, float(rgb[2]) * alpha, alpha};
  Algo::fill(image, color, ROI(left, right, top, bottom, 0, 1, 0, 4));
}

void draw_bar(ImageBuf &image, const TetcastLegend &legend, const Layout &layout, Writer &writer, float ink) {
  const double frame[3] = {ink, ink, ink};
  const int tall = layout.bottom - layout.top;
  fill(image, layout.left - 1, layout.top - 1, layout.left + layout.bar + 1, layout.bottom + 1, frame, 0.8f);
  for (int row = 0; row < tall; row++) {
    const double place = (tall - row - 0.5) / tall * (legend.color_count - 1);
    const int i = std::min(std::max(int(place), 0), std::max(legend.color_count - 2, 0));
    const double *a = legend.colors + 3 * i, *b = legend.color_count > 1 ? a + 3 : a, w = place - i;
    const double color[3] = {a[0] * (1 - w) + b[0] * w, a[1] * (1 - w) + b[1] * w, a[2] * (1 - w) + b[2] * w};
    fill(image, layout.left, layout.top + row, layout.left + layout.bar, layout.top + row + 1, color, 1);
  }
  const int thick = std::max(1, layout.font / 16);
  for (int i = 0; i < legend.label_count; i++) {
    const int y = layout.bottom - int(std::lround(legend.places[i] * tall));
    fill(image, layout.left + layout.bar, y - thick / 2, layout.left + layout.bar + layout.font / 4,
         y - thick / 2 + thick, frame, 0.8f);
    writer.draw(image, layout.labels, y, legend.labels[i], ink);
  }
}

// An image of nothing, to be drawn into.
ImageBuf blank(const ROI &roi) {
  OIIO::ImageSpec spec(roi, OIIO::TypeDesc::FLOAT);
  spec.alpha_channel = 3;
  return ImageBuf(spec, OIIO::InitializePixels::Yes);
}

void take_pixels(const ImageBuf &image, const ROI &roi, tetcast::Overlay &overlay) {
  overlay.x = roi.xbegin;
  overlay.y = roi.ybegin;
  overlay.width = roi.width();
  overlay.height = roi.height();
  overlay.rgba.resize(size_t(overlay.width * overlay.height) * 4);
  image.get_pixels(roi, OIIO::TypeDesc::FLOAT, overlay.rgba.data());
}

void draw_categories(ImageBuf &image, const TetcastLegend &legend, const Layout &layout, Writer &writer, float ink) {
  const double frame[3] = {ink, ink, ink};
  for (int i = 0; i < legend.color_count; i++) { // the first on top
    const int step = (layout.bottom - layout.top) / legend.color_count, top = layout.top + i * step;
    const int tall = std::min(layout.font, std::max(1, step - 1));
    fill(image, layout.left - 1, top - 1, layout.left + layout.bar + 1, top + tall + 1, frame, 0.8f);
    fill(image, layout.left, top, layout.left + layout.bar, top + tall, legend.colors + 3 * i, 1);
    if (i < legend.label_count && step >= layout.font)
      writer.draw(image, layout.labels, top + tall / 2, legend.labels[i], ink);
  }
}

} // namespace

tetcast::Overlay tetcast::draw_legend(const TetcastLegend &legend, int64_t width, int64_t height, float ink,
                                      std::string &problem) {
  Overlay overlay;
  if (width < 240 || height < 160 || legend.color_count < 1)
    return overlay;
  const int font = int(std::min<int64_t>(std::max<int64_t>(std::min(width, height) / 44, 10), 400));
  Writer writer(font);
  const Layout layout = lay_out(legend, width, height, writer, font);
  if (layout.left < width / 2 || layout.title_top - font < 0)
    return overlay;
  const int left = std::max(0, std::min(layout.left - 1, layout.title_left) - font);
  const ROI roi(left, int(width), layout.title_top - font, std::min(int(height), layout.bottom + font), 0, 1, 0, 4);
  ImageBuf image = blank(roi);
  if (legend.categories)
    draw_categories(image, legend, layout, writer, ink);
  else
    draw_bar(image, legend, layout, writer, ink);
  writer.draw(image, layout.title_left, layout.title_top, legend.title, ink);
  problem = writer.problem();
  take_pixels(image, roi, overlay);
  return overlay;
}

tetcast::Overlay tetcast::draw_caption(const TetcastCaption &caption, int64_t width, int64_t height, float ink,
                                       std::string &problem) {
  Overlay overlay;
  Writer writer(std::min(std::max(caption.size, 6), 400));
  const int64_t right = std::min(width, caption.x + writer.width(caption.text) + caption.size);
  const int64_t top = std::max<int64_t>(0, caption.y - caption.size),
                bottom = std::min(height, caption.y + caption.size);
  problem = writer.problem();
  if (caption.x < 0 || right <= caption.x || bottom <= top)
    return overlay;
  const ROI roi(int(caption.x), int(right), int(top), int(bottom), 0, 1, 0, 4);
  ImageBuf image = blank(roi);
  writer.draw(image, int(caption.x), int(caption.y), caption.text, ink);
  problem = writer.problem();
  take_pixels(image, roi, overlay);
  return overlay;
}
