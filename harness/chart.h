// Small charts for people: lines with bands, scattered points, rasters with a scale, tables of colours, and pages of
// them. Text is ASCII. Values that are not finite are left out; an axis without limits takes those of its data.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "harness/canvas.h"
#include "harness/picture.h"
#include "sampling/grid.h"

namespace abn::harness {

/// The eight colours of Okabe and Ito (2008), told apart with any kind of colour vision; black first, then round.
Rgb8 series_colour(std::size_t index);

/// Round numbers (1, 2 or 5 times a power of ten apart) from low to high, about `wanted` of them, never none.
std::vector<double> round_ticks(double low, double high, int wanted);

/// Powers of ten from low to high, with 2 and 5 between them where there is less than two decades; 0 < low < high.
std::vector<double> decade_ticks(double low, double high);

/// A tick as text: no more digits than the distance between ticks needs.
std::string tick_text(double value, double distance);

struct Axis {
  std::string label;  // what and its unit
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
  bool logarithmic = false;
};

struct Series {
  std::string label;                        // in the legend; empty = not there
  std::vector<double> x, y;                 // of equal length
  std::vector<double> low = {}, high = {};  // a band around y, of equal length, or empty
  Rgb8 colour{0, 0, 0};
  bool dashed = false;
};

/// A horizontal line at a value that means something, named at its right end.
struct Level {
  double value = 0;
  std::string label;
};

struct LineChart {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::vector<Level> levels;
  std::uint32_t width = 480, height = 300;  // of the picture [px]
  int left_room = 0, right_room = 0;        // at least so much beside the plot [px]: charts above each other align
};
Picture draw_chart(const LineChart& chart);

/// Points of one kind.
struct Dots {
  std::string label;                  // in the legend; empty = not there
  std::vector<CanvasPoint> position;  // in units of the chart, y down
  Rgb8 colour{0, 0, 0};
};

struct ScatterChart {
  std::string title;
  double width = 1, height = 1;  // of the region shown, from (0,0); both units are drawn equally long
  std::vector<Dots> dots;
  double radius = 1.6;                // of a dot [px]
  std::uint32_t picture_width = 480;  // [px]
};
Picture draw_scatter(const ScatterChart& chart);

enum class ColourMap { grey, false_colour };

/// A raster whose cells are whole squares of pixels, with a scale below.
struct RasterChart {
  std::string title;
  Grid<float> values;
  double low = 0, high = 1;  // ends of the scale; > 0 if logarithmic
  bool logarithmic = false;
  ColourMap map = ColourMap::grey;
  std::string bar_label;              // what is measured, and its unit
  std::string note;                   // beside the title's left end, smaller; empty = none
  std::uint32_t picture_width = 480;  // [px]; more if the raster has more cells
};
Picture draw_raster(const RasterChart& chart);

/// A table of colours with its numbers written in; NaN cells are crossed out.
struct HeatMap {
  std::string title;
  std::string x_label, y_label;
  std::vector<std::string> x_words, y_words;  // [values.width], [values.height]
  Grid<double> values;
  double low = 0, high = 1;  // ends of the scale
  std::string note;          // below
};
Picture draw_heat_map(const HeatMap& map);

/// Puts pictures in rows on a white page; a column is as wide as its widest picture.
struct Page {
  std::string title, note;  // lines separated by '\n'; empty = none
  std::vector<std::vector<Picture>> rows;
};
Picture draw_page(const Page& page);

}  // namespace abn::harness
