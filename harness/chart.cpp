#include "harness/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "harness/chart_style.h"

namespace abn::harness {
namespace {

using namespace chart_style;

/// Values to pixels along one side.
struct Scale {
  double low = 0, high = 1;
  bool logarithmic = false;
  double first = 0, last = 1;  // pixels of low and high
  double operator()(double value) const {
    if (logarithmic) {
      if (!(value > 0)) return std::nan("");
      return first + (last - first) * std::log(value / low) / std::log(high / low);
    }
    return first + (last - first) * (value - low) / (high - low);
  }
};

/// Limits of an axis: as given, else those of the values, never empty.
Scale scale_of(const Axis& axis, const std::vector<double>& values) {
  Scale scale{.low = axis.low, .high = axis.high, .logarithmic = axis.logarithmic};
  double least = INFINITY;
  double largest = -INFINITY;
  for (const double value : values) {
    if (!std::isfinite(value) || (axis.logarithmic && value <= 0)) continue;
    least = std::min(least, value);
    largest = std::max(largest, value);
  }
  if (!(least <= largest)) least = axis.logarithmic ? 0.1 : 0, largest = 1;
  if (std::isnan(scale.low)) scale.low = least;
  if (std::isnan(scale.high)) scale.high = largest;
  if (axis.logarithmic) {
    if (std::isnan(axis.low)) scale.low = std::pow(10, std::floor(std::log10(scale.low)));
    if (std::isnan(axis.high)) scale.high = std::pow(10, std::ceil(std::log10(scale.high)));
    if (!(scale.low < scale.high)) scale.high = 10 * scale.low;
  } else {
    const double room = 0.04 * (scale.high - scale.low);
    if (std::isnan(axis.low) && scale.low != 0) scale.low -= room;
    if (std::isnan(axis.high)) scale.high += room;
    if (!(scale.low < scale.high)) scale.high = scale.low + std::max(1.0, std::abs(scale.low));
  }
  return scale;
}

struct Tick {
  double at;  // [px]
  std::string text;
};

std::vector<Tick> ticks_of(const Scale& scale, int wanted) {
  const std::vector<double> values =
      scale.logarithmic ? decade_ticks(scale.low, scale.high) : round_ticks(scale.low, scale.high, wanted);
  const double distance = values.size() > 1 ? values[1] - values[0] : 0;
  std::vector<Tick> ticks;
  for (const double value : values) {
    ticks.push_back({scale(value), scale.logarithmic ? fmt::format("{:g}", value) : tick_text(value, distance)});
  }
  return ticks;
}

/// Where the legend's entries stand, in lines below the title.
struct Legend {
  struct Entry {
    const Series* series;
    int x, line;
  };
  std::vector<Entry> entries;
  int lines = 0;
};

constexpr int swatch = 22;  // [px], length of a legend's line

Legend arrange_legend(const std::vector<Series>& series, int left, int right) {
  Legend legend;
  int x = left;
  for (const Series& one : series) {
    if (one.label.empty()) continue;
    const int width = swatch + 6 + text_width(one.label, tick_height) + 16;
    if (legend.lines == 0) legend.lines = 1;
    if (x > left && x + width > right) {
      x = left;
      ++legend.lines;
    }
    legend.entries.push_back({&one, x, legend.lines - 1});
    x += width;
  }
  return legend;
}

void draw_series(Picture& picture, const CanvasArea& plot, const Series& series, const Scale& x, const Scale& y) {
  assert(series.x.size() == series.y.size());
  std::vector<CanvasPoint> line;
  for (std::size_t i = 0; i < series.x.size(); ++i) line.push_back({x(series.x[i]), y(series.y[i])});
  if (series.dashed) {
    draw_dashed_path(picture, plot, line, 2, 6, series.colour);
  } else {
    draw_path(picture, plot, line, 2, series.colour);
  }
}

void draw_band(Picture& picture, const CanvasArea& plot, const Series& series, const Scale& x, const Scale& y) {
  std::vector<CanvasPoint> above;
  std::vector<CanvasPoint> below;
  const auto draw_run = [&] {
    above.insert(above.end(), below.rbegin(), below.rend());
    fill_polygon(picture, plot, above, 0.25, series.colour);
    above.clear();
    below.clear();
  };
  for (std::size_t i = 0; i < series.low.size(); ++i) {
    // On a logarithmic axis a band that reaches 0 ends at the bottom.
    const double low = y.logarithmic ? std::max(series.low[i], y.low) : series.low[i];
    const CanvasPoint top{x(series.x[i]), y(series.high[i])};
    const CanvasPoint bottom{top.x, y(low)};
    if (std::isfinite(top.x) && std::isfinite(top.y) && std::isfinite(bottom.y)) {
      above.push_back(top);
      below.push_back(bottom);
    } else {
      draw_run();
    }
  }
  draw_run();
}

}  // namespace

Rgb8 series_colour(std::size_t index) {
  static constexpr Rgb8 colours[] = {{0, 0, 0},      {230, 159, 0}, {86, 180, 233}, {0, 158, 115},
                                     {240, 228, 66}, {0, 114, 178}, {213, 94, 0},   {204, 121, 167}};
  // Vermilion, blue and green before the pale ones, which are hard to see as thin lines on white.
  static constexpr std::size_t order[] = {0, 6, 5, 3, 7, 1, 2, 4};
  return colours[order[index % 8]];
}

std::vector<double> round_ticks(double low, double high, int wanted) {
  assert(low < high && wanted >= 1);
  const double rough = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough * 0.999) step = factor * power;
  }
  std::vector<double> ticks;
  for (;;) {
    const double first = std::ceil(low / step - 1e-9);
    for (double k = first; k * step <= high + 1e-9 * step; ++k) ticks.push_back(k == 0 ? 0.0 : k * step);
    if (!ticks.empty()) return ticks;
    step /= 2;  // no multiple of the step lies between
  }
}

std::vector<double> decade_ticks(double low, double high) {
  assert(0 < low && low < high);
  const double decades = std::log10(high / low);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / 7)));
  std::vector<double> ticks;
  for (int exponent = static_cast<int>(std::floor(std::log10(low))) - 1; std::pow(10, exponent) <= high * 1.0001;
       ++exponent) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1 && decades >= 2) break;
      if (factor == 1 && exponent % every != 0) continue;
      const double value = factor * std::pow(10.0, exponent);
      if (value >= low * 0.9999 && value <= high * 1.0001) ticks.push_back(value);
    }
  }
  if (ticks.empty()) ticks = {low, high};
  return ticks;
}

std::string tick_text(double value, double distance) {
  if (value == 0) return "0";
  const double size = std::max(std::abs(value), std::abs(distance));
  if (size >= 1e6 || size < 1e-4 || distance <= 0) return fmt::format("{:.3g}", value);
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(distance) - 1e-9)));
  return fmt::format("{:.{}f}", value, decimals);
}

Picture draw_chart(const LineChart& chart) {
  std::vector<double> all_x;
  std::vector<double> all_y;
  for (const Series& series : chart.series) {
    all_x.insert(all_x.end(), series.x.begin(), series.x.end());
    all_y.insert(all_y.end(), series.y.begin(), series.y.end());
    all_y.insert(all_y.end(), series.low.begin(), series.low.end());
    all_y.insert(all_y.end(), series.high.begin(), series.high.end());
  }
  for (const Level& level : chart.levels) all_y.push_back(level.value);

  Picture picture(chart.width, chart.height);
  const CanvasArea whole = area_of(picture);
  // Heights first: how much room the numbers of the y axis need depends on which there are.
  const Legend legend = arrange_legend(chart.series, margin, whole.width - margin);
  const int top = margin / 2 + (chart.title.empty() ? 0 : title_line) + legend.lines * legend_line + 6;
  const int bottom = whole.height - (chart.x.label.empty() ? 26 : 44);
  Scale y = scale_of(chart.y, all_y);
  y.first = bottom - 0.5;
  y.last = top + 0.5;
  const std::vector<Tick> y_ticks = ticks_of(y, std::max(2, (bottom - top) / 45));
  int numbers = 0;
  for (const Tick& tick : y_ticks) numbers = std::max(numbers, text_width(tick.text, tick_height));
  int level_room = 0;
  for (const Level& level : chart.levels)
    level_room = std::max(level_room, level.label.empty() ? 0 : text_width(level.label, tick_height) + 6);
  const int left = std::max(margin + (chart.y.label.empty() ? 0 : 20) + numbers + 8, chart.left_room);
  const int right = std::min(whole.width - margin - std::max(level_room, 6), whole.width - chart.right_room);
  const CanvasArea plot{left, top, std::max(right - left, 20), std::max(bottom - top, 20)};
  Scale x = scale_of(chart.x, all_x);
  x.first = plot.left + 0.5;
  x.last = plot.right() - 0.5;

  draw_fitted(picture, chart.title, margin, margin / 2 + 16, title_height, whole.width - 2 * margin, ink);
  for (const Legend::Entry& entry : legend.entries) {
    const int baseline = margin / 2 + (chart.title.empty() ? 0 : title_line) + entry.line * legend_line + 14;
    const CanvasPoint ends[] = {{entry.x + 0.5, baseline - 3.5}, {entry.x + swatch + 0.5, baseline - 3.5}};
    if (entry.series->dashed) {
      draw_dashed_path(picture, whole, ends, 2, 5, entry.series->colour);
    } else {
      draw_path(picture, whole, ends, 2, entry.series->colour);
    }
    draw_text(picture, entry.series->label, entry.x + swatch + 6, baseline, tick_height, ink);
  }
  for (const Tick& tick : y_ticks) {
    const int at = static_cast<int>(std::floor(tick.at));
    fill_area(picture, {plot.left, at, plot.width, 1}, grid_line);
    draw_text(picture, tick.text, plot.left - 6 - text_width(tick.text, tick_height), at + 4, tick_height, ink);
  }
  int free_from = -1000;  // numbers that would touch their left neighbour are left out
  for (const Tick& tick : ticks_of(x, std::max(2, plot.width / 60))) {
    const int at = static_cast<int>(std::floor(tick.at));
    fill_area(picture, {at, plot.top, 1, plot.height}, grid_line);
    fill_area(picture, {at, plot.bottom(), 1, 4}, frame);
    const int width = text_width(tick.text, tick_height);
    const int text_left = std::clamp(at - width / 2, 0, std::max(0, whole.width - width));
    if (text_left < free_from) continue;
    draw_text(picture, tick.text, text_left, plot.bottom() + 16, tick_height, ink);
    free_from = text_left + width + 8;
  }
  for (const Level& level : chart.levels) {
    const double at = y(level.value);
    if (!std::isfinite(at) || at < plot.top || at > plot.bottom()) continue;
    const CanvasPoint ends[] = {{plot.left + 0.5, at}, {plot.right() - 0.5, at}};
    draw_dashed_path(picture, plot, ends, 1, 3, grey_ink);
    draw_text(picture, level.label, plot.right() + 5, static_cast<int>(at) + 4, tick_height, grey_ink);
  }
  for (const Series& series : chart.series) draw_band(picture, plot, series, x, y);
  for (const Series& series : chart.series) draw_series(picture, plot, series, x, y);
  draw_border(picture, plot, frame);
  const int x_room = whole.width - 2 * margin;
  const int x_width = std::min(text_width(chart.x.label, label_height), x_room);
  draw_fitted(picture, chart.x.label, std::clamp(plot.left + (plot.width - x_width) / 2, margin, whole.width - x_width),
              whole.height - 8, label_height, x_room, ink);
  if (!chart.y.label.empty()) {
    const double height =
        std::min(label_height, label_height * (whole.height - 8) / text_width(chart.y.label, label_height));
    const int half = text_width(chart.y.label, height) / 2 + 4;
    draw_text_upwards(picture, chart.y.label, margin + 4,
                      std::clamp(plot.top + plot.height / 2, std::min(half, whole.height / 2),
                                 std::max(whole.height - half, whole.height / 2)),
                      height, ink);
  }
  return picture;
}

}  // namespace abn::harness
