// The drawing half of picture.h: text, colour bars and sheets.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "harness/picture.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

constexpr Rgb8 ink{34, 34, 40};
constexpr Rgb8 grey_ink{96, 96, 104};
constexpr Rgb8 frame{170, 170, 176};

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
constexpr double font_capital_height = 21.0;  // [px] at scale 1
constexpr int oversampling = 4;               // text is drawn larger and averaged down, which smooths its strokes

double font_scale(double height) { return height * oversampling / font_capital_height; }
int font_thickness(double height) { return std::max(1, static_cast<int>(std::lround(height * oversampling / 9.0))); }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t first = 0; first < text.size();) {
    const std::size_t end = std::min(text.find('\n', first), text.size());
    lines.push_back(text.substr(first, end - first));
    first = end + 1;
  }
  return lines;
}

void fill(Picture& picture, int x, int y, int width, int height, Rgb8 colour) {
  for (int v = std::max(y, 0); v < std::min(y + height, static_cast<int>(picture.height)); ++v) {
    for (int u = std::max(x, 0); u < std::min(x + width, static_cast<int>(picture.width)); ++u) {
      std::copy_n(colour.data(), 3, picture.pixel(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v)));
    }
  }
}

// Text no wider than `room`: smaller if it must be.
void draw_fitted(Picture& picture, const std::string& text, int x, int y, double height, int room, Rgb8 colour) {
  const int width = text_width(text, height);
  draw_text(picture, text, x, y, width > room ? height * room / width : height, colour);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// Everything that has a size, derived from the cell.
struct Measures {
  double text;   // height of capitals [px]
  double small;  // of further lines
  int gap;       // between cells and around the sheet
  int line;      // from one baseline to the next
  int cell_width, cell_height, label_height;
};

void draw_colour_bar(Picture& sheet, const ColourBar& bar, int x, int y, int width, const Measures& measures) {
  const int height = static_cast<int>(std::lround(1.2 * measures.text));
  for (int i = 0; i < width; ++i) {
    fill(sheet, x + i, y, 1, height, false_colour(static_cast<float>(i) / static_cast<float>(std::max(width - 1, 1))));
  }
  constexpr int intervals = 4;
  const int tick = std::max(3, height / 4);
  const int baseline = y + height + tick + static_cast<int>(1.7 * measures.small);
  for (int i = 0; i <= intervals; ++i) {
    const int at = x + (width - 1) * i / intervals;
    fill(sheet, at, y + height, std::max(1, tick / 3), tick, grey_ink);
    const bool last = i == intervals;
    const std::string text =
        (last && bar.open_above ? ">= " : "") + number(bar.low + (bar.high - bar.low) * i / intervals);
    const int length = text_width(text, measures.small);
    const int left = i == 0 ? x : last ? x + width - length : at - length / 2;
    draw_text(sheet, text, left, baseline, measures.small, ink);
  }
  draw_fitted(sheet, bar.label, x, baseline + measures.line, measures.small, width, grey_ink);
}

}  // namespace

int text_width(const std::string& text, double height) {
  int below = 0;
  const cv::Size size = cv::getTextSize(text, font, font_scale(height), font_thickness(height), &below);
  return (size.width + oversampling - 1) / oversampling;
}

void draw_text(Picture& picture, const std::string& text, int x, int y, double height, Rgb8 colour) {
  const int above = static_cast<int>(std::ceil(1.4 * height));
  const int below = static_cast<int>(std::ceil(0.6 * height));
  const int width = text_width(text, height) + 2;
  cv::Mat1b drawn((above + below) * oversampling, width * oversampling, std::uint8_t{0});
  cv::putText(drawn, text, cv::Point(oversampling, above * oversampling), font, font_scale(height), cv::Scalar(255),
              font_thickness(height), cv::LINE_AA);
  cv::Mat1b coverage;
  cv::resize(drawn, coverage, cv::Size(width, above + below), 0, 0, cv::INTER_AREA);
  for (int v = 0; v < coverage.rows; ++v) {
    for (int u = 0; u < coverage.cols; ++u) {
      const int px = x + u - 1;
      const int py = y + v - above;
      if (px < 0 || py < 0 || px >= static_cast<int>(picture.width) || py >= static_cast<int>(picture.height)) continue;
      std::uint8_t* pixel = picture.pixel(static_cast<std::uint32_t>(px), static_cast<std::uint32_t>(py));
      const int opacity = coverage(v, u);
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - opacity) + colour[c] * opacity + 127) / 255);
      }
    }
  }
}

Picture montage(std::span<const MontageItem> items, const MontageLayout& layout) {
  const bool any = std::ranges::any_of(items, [](const MontageItem& item) { return !item.picture.rgb.empty(); });
  if (!any || layout.columns == 0) throw ConfigError("montage: give at least one picture and one column");
  std::vector<Picture> pictures;
  Measures measures{};
  std::size_t label_lines = 0;
  for (const MontageItem& item : items) {
    const std::uint32_t width = std::max(item.picture.width, 1U);
    pictures.push_back(enlarge(item.picture, std::max(1U, (layout.smallest_width + width - 1) / width)));
    measures.cell_width = std::max(measures.cell_width, static_cast<int>(pictures.back().width));
    measures.cell_height = std::max(measures.cell_height, static_cast<int>(pictures.back().height));
    label_lines = std::max(label_lines, lines_of(item.label).size());
  }
  measures.text = std::max(11.0, measures.cell_width / 36.0);
  measures.small = 0.8 * measures.text;
  measures.gap = static_cast<int>(2.0 * measures.text);
  measures.line = static_cast<int>(std::lround(1.9 * measures.text));
  measures.label_height = static_cast<int>(label_lines) * measures.line;

  const auto columns = static_cast<int>(std::min<std::size_t>(layout.columns, items.size()));
  const int rows = (static_cast<int>(items.size()) + columns - 1) / columns;
  const std::vector<std::string> notes = lines_of(layout.note);
  const int inner_width = columns * measures.cell_width + (columns - 1) * measures.gap;
  const int row_height = measures.label_height + measures.cell_height + measures.gap;
  const int title_height = layout.title.empty() ? 0 : static_cast<int>(2.6 * measures.text) + measures.gap / 2;
  const int bar_height = layout.colour_bar ? 3 * measures.line + measures.gap : 0;
  const int note_height = static_cast<int>(notes.size()) * measures.line + (notes.empty() ? 0 : measures.gap / 2);
  Picture sheet(static_cast<std::uint32_t>(inner_width + 2 * measures.gap),
                static_cast<std::uint32_t>(measures.gap + title_height + rows * row_height + bar_height + note_height));

  const int left = measures.gap;
  int top = measures.gap;
  if (!layout.title.empty()) {
    draw_fitted(sheet, layout.title, left, top + static_cast<int>(1.4 * measures.text), 1.35 * measures.text,
                inner_width, ink);
    top += title_height;
  }
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto cell = static_cast<int>(i);
    const int x = left + cell % columns * (measures.cell_width + measures.gap);
    const int y = top + cell / columns * row_height;
    const std::vector<std::string> lines = lines_of(items[i].label);
    int baseline = y + measures.label_height - static_cast<int>(0.7 * measures.text);
    baseline -= static_cast<int>(lines.size() - std::min<std::size_t>(lines.size(), 1)) * measures.line;
    for (std::size_t line = 0; line < lines.size(); ++line) {
      draw_fitted(sheet, lines[line], x, baseline, line == 0 ? measures.text : measures.small, measures.cell_width,
                  line == 0 ? ink : grey_ink);
      baseline += measures.line;
    }
    const Picture& picture = pictures[i];
    if (picture.rgb.empty()) continue;
    const int picture_top = y + measures.label_height;
    fill(sheet, x - 1, picture_top - 1, static_cast<int>(picture.width) + 2, static_cast<int>(picture.height) + 2,
         frame);
    for (std::uint32_t row = 0; row < picture.height; ++row) {
      std::copy_n(picture.pixel(0, row), std::size_t{picture.width} * 3,
                  sheet.pixel(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(picture_top) + row));
    }
  }
  top += rows * row_height;
  if (layout.colour_bar) {
    draw_colour_bar(sheet, *layout.colour_bar, left, top, std::min(inner_width, 2 * measures.cell_width), measures);
    top += bar_height;
  }
  for (const std::string& note : notes) {
    draw_fitted(sheet, note, left, top + static_cast<int>(measures.text), measures.small, inner_width, grey_ink);
    top += measures.line;
  }
  return sheet;
}

}  // namespace abn::harness
