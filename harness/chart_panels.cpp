// The charts that are areas rather than lines: scattered points, rasters, tables of colours; and pages of charts.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "harness/chart.h"
#include "harness/chart_style.h"

namespace abn::harness {
namespace {

using namespace chart_style;

Rgb8 map_colour(ColourMap map, double t) {
  if (map == ColourMap::false_colour) return false_colour(static_cast<float>(t));
  if (std::isnan(t)) return {0, 255, 0};
  const auto byte = static_cast<std::uint8_t>(std::lround(255 * std::clamp(t, 0.0, 1.0)));
  return {byte, byte, byte};
}

/// The scale below a raster or table: 34 px and a line for its label.
constexpr int bar_room = 58;

void draw_bar(Picture& picture, int left, int top, int width, double low, double high, bool logarithmic, ColourMap map,
              const std::string& label) {
  for (int i = 0; i < width; ++i) {
    fill_area(picture, {left + i, top, 1, 12}, map_colour(map, static_cast<double>(i) / std::max(width - 1, 1)));
  }
  draw_border(picture, {left, top, width, 12}, frame);
  const std::vector<double> values =
      logarithmic ? decade_ticks(low, high) : round_ticks(low, high, std::max(3, width / 70));
  const double distance = values.size() > 1 ? values[1] - values[0] : 0;
  int free_from = -1000;
  for (const double value : values) {
    const double t = logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    const int at = left + static_cast<int>(std::lround(t * (width - 1)));
    fill_area(picture, {at, top + 12, 1, 4}, frame);
    const std::string text = logarithmic ? fmt::format("{:g}", value) : tick_text(value, distance);
    const int text_left = std::clamp(at - text_width(text, tick_height) / 2, left,
                                     std::max(left, left + width - text_width(text, tick_height)));
    if (text_left < free_from) continue;
    draw_text(picture, text, text_left, top + 28, tick_height, ink);
    free_from = text_left + text_width(text, tick_height) + 8;
  }
  draw_fitted(picture, label, left, top + 46, tick_height, width, grey_ink);
}

}  // namespace

Picture draw_scatter(const ScatterChart& chart) {
  const int width = static_cast<int>(chart.picture_width) - 2 * margin;
  const int height = std::max(1, static_cast<int>(std::lround(width * chart.height / chart.width)));
  int legend_width = 0;
  int lines = 0;
  for (const Dots& dots : chart.dots) {
    if (dots.label.empty()) continue;
    const int entry = 16 + text_width(dots.label, tick_height) + 14;
    if (lines == 0 || legend_width + entry > width) {
      ++lines;
      legend_width = 0;
    }
    legend_width += entry;
  }
  const int top = margin / 2 + (chart.title.empty() ? 0 : title_line) + lines * legend_line + 4;
  Picture picture(chart.picture_width, static_cast<std::uint32_t>(top + height + margin));
  draw_fitted(picture, chart.title, margin, margin / 2 + 16, title_height, width, ink);
  int x = margin;
  int baseline = margin / 2 + (chart.title.empty() ? 0 : title_line) + 14;
  const CanvasArea plot{margin, top, width, height};
  for (const Dots& dots : chart.dots) {
    if (!dots.label.empty()) {
      const int entry = 16 + text_width(dots.label, tick_height) + 14;
      if (x > margin && x + entry > margin + width) {
        x = margin;
        baseline += legend_line;
      }
      const CanvasPoint sign[] = {{x + 6.0, baseline - 4.0}};
      draw_dots(picture, area_of(picture), sign, std::max(3.0, chart.radius), dots.colour);
      draw_text(picture, dots.label, x + 16, baseline, tick_height, ink);
      x += entry;
    }
    std::vector<CanvasPoint> centres;
    centres.reserve(dots.position.size());
    for (const CanvasPoint& position : dots.position) {
      centres.push_back(
          {plot.left + position.x / chart.width * plot.width, plot.top + position.y / chart.height * plot.height});
    }
    draw_dots(picture, plot, centres, chart.radius, dots.colour);
  }
  draw_border(picture, {plot.left - 1, plot.top - 1, plot.width + 2, plot.height + 2}, frame);
  return picture;
}

Picture draw_raster(const RasterChart& chart) {
  const Extent cells = chart.values.size();
  assert(cells.area() > 0 && chart.low < chart.high && (!chart.logarithmic || chart.low > 0));
  const auto room = static_cast<int>(chart.picture_width) - 2 * margin;
  const int factor = std::max(1, room / static_cast<int>(cells.width));
  const CanvasArea plot{
      margin, margin / 2 + (chart.title.empty() ? 0 : title_line) + (chart.note.empty() ? 0 : legend_line) + 4,
      factor * static_cast<int>(cells.width), factor * static_cast<int>(cells.height)};
  const int width = std::max(static_cast<int>(chart.picture_width), plot.right() + margin);
  Picture picture(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(plot.bottom() + 8 + bar_room));
  draw_fitted(picture, chart.title, margin, margin / 2 + 16, title_height, width - 2 * margin, ink);
  draw_fitted(picture, chart.note, margin, plot.top - 9, tick_height, width - 2 * margin, grey_ink);
  for (std::uint32_t y = 0; y < cells.height; ++y) {
    for (std::uint32_t x = 0; x < cells.width; ++x) {
      const auto value = static_cast<double>(chart.values.at(x, y));
      const double t = !chart.logarithmic ? (value - chart.low) / (chart.high - chart.low)
                       : value > 0        ? std::log(value / chart.low) / std::log(chart.high / chart.low)
                                          : (value <= 0 ? 0.0 : std::nan(""));
      fill_area(picture,
                {plot.left + static_cast<int>(x) * factor, plot.top + static_cast<int>(y) * factor, factor, factor},
                map_colour(chart.map, t));
    }
  }
  draw_border(picture, {plot.left - 1, plot.top - 1, plot.width + 2, plot.height + 2}, frame);
  draw_bar(picture, plot.left, plot.bottom() + 8, plot.width, chart.low, chart.high, chart.logarithmic, chart.map,
           chart.bar_label);
  return picture;
}

Picture draw_heat_map(const HeatMap& map) {
  const Extent cells = map.values.size();
  assert(map.x_words.size() == cells.width && map.y_words.size() == cells.height && map.low < map.high);
  constexpr int cell_height = 30;
  int cell_width = 54;
  for (const std::string& word : map.x_words) cell_width = std::max(cell_width, text_width(word, tick_height) + 10);
  int words = 0;
  for (const std::string& word : map.y_words) words = std::max(words, text_width(word, tick_height));
  const int left = margin + 20 + words + 8;
  const int top = margin / 2 + title_line + 4;
  const CanvasArea plot{left, top, cell_width * static_cast<int>(cells.width),
                        cell_height * static_cast<int>(cells.height)};
  const int width = std::max({plot.right() + margin, 300, margin * 2 + text_width(map.title, title_height)});
  Picture picture(static_cast<std::uint32_t>(width),
                  static_cast<std::uint32_t>(plot.bottom() + 44 + bar_room + (map.note.empty() ? 0 : legend_line)));
  draw_text(picture, map.title, margin, margin / 2 + 16, title_height, ink);
  for (std::uint32_t y = 0; y < cells.height; ++y) {
    for (std::uint32_t x = 0; x < cells.width; ++x) {
      const CanvasArea cell{plot.left + static_cast<int>(x) * cell_width, plot.top + static_cast<int>(y) * cell_height,
                            cell_width, cell_height};
      const double value = map.values.at(x, y);
      if (!std::isfinite(value)) {
        const CanvasPoint down[] = {{cell.left + 2.0, cell.top + 2.0}, {cell.right() - 2.0, cell.bottom() - 2.0}};
        const CanvasPoint up[] = {{cell.left + 2.0, cell.bottom() - 2.0}, {cell.right() - 2.0, cell.top + 2.0}};
        draw_path(picture, cell, down, 1, frame);
        draw_path(picture, cell, up, 1, frame);
        continue;
      }
      const double t = std::clamp((value - map.low) / (map.high - map.low), 0.0, 1.0);
      fill_area(picture, cell, map_colour(ColourMap::false_colour, t));
      // The map's lightness is linear in t, so that one of the two can always be read on it.
      draw_text_centred(picture, fmt::format("{:.3g}", value), cell.left + cell_width / 2, cell.top + 19, tick_height,
                        t > 0.5 ? Rgb8{0, 0, 0} : Rgb8{255, 255, 255});
    }
  }
  draw_border(picture, {plot.left - 1, plot.top - 1, plot.width + 2, plot.height + 2}, frame);
  for (std::size_t i = 0; i < map.x_words.size(); ++i) {
    draw_text_centred(picture, map.x_words[i], plot.left + static_cast<int>(i) * cell_width + cell_width / 2,
                      plot.bottom() + 15, tick_height, ink);
  }
  for (std::size_t i = 0; i < map.y_words.size(); ++i) {
    draw_text(picture, map.y_words[i], plot.left - 7 - text_width(map.y_words[i], tick_height),
              plot.top + static_cast<int>(i) * cell_height + 19, tick_height, ink);
  }
  draw_text_centred(picture, map.x_label, plot.left + plot.width / 2, plot.bottom() + 32, label_height, ink);
  draw_text_upwards(picture, map.y_label, margin + 4, plot.top + plot.height / 2, label_height, ink);
  draw_bar(picture, margin, plot.bottom() + 46, std::min(width - 2 * margin, 360), map.low, map.high, false,
           ColourMap::false_colour, map.note);
  return picture;
}

Picture draw_page(const Page& page) {
  const auto lines_of = [](const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t first = 0; first < text.size();) {
      const std::size_t end = std::min(text.find('\n', first), text.size());
      lines.push_back(text.substr(first, end - first));
      first = end + 1;
    }
    return lines;
  };
  constexpr int gap = 14;
  std::vector<int> widths;
  std::vector<int> heights;
  for (const auto& row : page.rows) {
    heights.push_back(0);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i == widths.size()) widths.push_back(0);
      widths[i] = std::max(widths[i], static_cast<int>(row[i].width));
      heights.back() = std::max(heights.back(), static_cast<int>(row[i].height));
    }
  }
  const std::vector<std::string> notes = lines_of(page.note);
  int width = gap;
  for (const int column : widths) width += column + gap;
  int height = gap + (page.title.empty() ? 0 : 34) + static_cast<int>(notes.size()) * legend_line +
               (notes.empty() ? 0 : gap / 2);
  for (const int row : heights) height += row + gap;
  Picture sheet(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
  int y = gap;
  if (!page.title.empty()) {
    draw_fitted(sheet, page.title, gap + margin, y + 16, 13, width - 2 * gap - margin, ink);
    y += 34;
  }
  for (std::size_t r = 0; r < page.rows.size(); ++r) {
    int x = gap;
    for (std::size_t i = 0; i < page.rows[r].size(); ++i) {
      paste(sheet, page.rows[r][i], x, y);
      x += widths[i] + gap;
    }
    y += heights[r] + gap;
  }
  for (const std::string& note : notes) {
    draw_fitted(sheet, note, gap + margin, y + 10, tick_height, width - 2 * gap - margin, grey_ink);
    y += legend_line;
  }
  return sheet;
}

}  // namespace abn::harness
