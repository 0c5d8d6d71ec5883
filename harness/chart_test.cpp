#include "harness/chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace abn::harness {
namespace {

/// Share of the ink a pixel has: 0 white, 1 black.
double darkness(const Picture& picture) {
  double sum = 0;
  for (const std::uint8_t byte : picture.rgb) sum += 255 - byte;
  return sum / 255 / 3;
}

bool has_colour(const Picture& picture, Rgb8 colour) {
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
    if (std::equal(colour.begin(), colour.end(), picture.rgb.begin() + static_cast<std::ptrdiff_t>(i))) return true;
  }
  return false;
}

TEST(Ticks, AreRoundCoverTheAxisAndAreNeverNone) {
  EXPECT_EQ(round_ticks(0, 1, 5), (std::vector<double>{0, .2, .4, .6000000000000001, .8, 1}));
  EXPECT_EQ(round_ticks(0, 3, 3), (std::vector<double>{0, 1, 2, 3}));
  EXPECT_EQ(round_ticks(-20, 20, 2), (std::vector<double>{-20, 0, 20}));
  for (const double low : {-3.7, 0.0, 1e-7, 12345.0}) {
    for (const double length : {1e-6, 0.3, 7.0, 1e5}) {
      const auto ticks = round_ticks(low, low + length, 4);
      ASSERT_FALSE(ticks.empty());
      EXPECT_LE(ticks.size(), 11U);
      for (const double tick : ticks) {
        EXPECT_GE(tick, low - 1e-6 * length);
        EXPECT_LE(tick, low + length * (1 + 1e-6));
      }
    }
  }
}

TEST(Ticks, OfALogarithmicAxisAreDecades) {
  EXPECT_EQ(decade_ticks(1e-4, 10), (std::vector<double>{1e-4, 1e-3, 1e-2, .1, 1, 10}));
  EXPECT_EQ(decade_ticks(1, 10), (std::vector<double>{1, 2, 5, 10}));
  EXPECT_FALSE(decade_ticks(2.1, 2.2).empty());
  EXPECT_LE(decade_ticks(1e-30, 1).size(), 8U);
}

TEST(Ticks, HaveNoMoreDigitsThanTheyNeed) {
  EXPECT_EQ(tick_text(0.6000000000000001, 0.2), "0.6");
  EXPECT_EQ(tick_text(2, 1), "2");
  EXPECT_EQ(tick_text(0, 1e-9), "0");
  EXPECT_EQ(tick_text(0.05, 0.05), "0.05");
  EXPECT_EQ(tick_text(1.5e7, 5e6), "1.5e+07");
}

TEST(Canvas, DotsHaveTheInkOfTheirArea) {
  for (const double radius : {0.4, 0.8, 1.7, 6.0}) {
    Picture picture(40, 40);
    const CanvasPoint centre[] = {{19.3, 20.8}};
    draw_dots(picture, area_of(picture), centre, radius, {0, 0, 0});
    const double area = 3.14159265 * radius * radius;
    EXPECT_NEAR(darkness(picture), area, 0.03 * area + 0.02) << radius;
  }
}

TEST(Canvas, NothingIsDrawnOutsideItsAreaAndNoPointIsTooFarAway) {
  Picture picture(30, 30);
  const CanvasArea area{10, 10, 10, 10};
  const CanvasPoint wild[] = {{-1e9, -1e9}, {15, 15}, {NAN, 3}, {14, 14}, {1e300, 15}, {15, INFINITY}};
  draw_path(picture, area, wild, 3, {0, 0, 0});
  draw_dashed_path(picture, area, wild, 3, 4, {0, 0, 0});
  draw_dots(picture, area, wild, 8, {0, 0, 0});
  for (std::uint32_t y = 0; y < 30; ++y) {
    for (std::uint32_t x = 0; x < 30; ++x) {
      const bool inside = x >= 10 && x < 20 && y >= 10 && y < 20;
      EXPECT_TRUE(inside || picture.pixel(x, y)[0] == 255) << x << ' ' << y;
    }
  }
  EXPECT_GT(darkness(picture), 10);
}

TEST(Chart, DrawsEverySeriesInItsColourAndTheLineWhereItsValuesAre) {
  LineChart chart;
  chart.x = {.label = "x", .low = 0, .high = 1};
  chart.y = {.label = "y", .low = 0, .high = 1};
  chart.series.push_back({.label = "", .x = {0, 1}, .y = {0.5, 0.5}, .colour = {255, 0, 0}});
  const Picture middle = draw_chart(chart);
  chart.series[0].y = {0.9, 0.9};
  const Picture upper = draw_chart(chart);
  const auto height = [](const Picture& picture) {
    double sum = 0, count = 0;
    for (std::uint32_t y = 0; y < picture.height; ++y) {
      for (std::uint32_t x = 0; x < picture.width; ++x) {
        const std::uint8_t* p = picture.pixel(x, y);
        if (p[0] > 200 && p[1] < 50) sum += y, ++count;
      }
    }
    EXPECT_GT(count, 300);
    return sum / count;
  };
  const double plot_height = (height(middle) - height(upper)) / 0.4;
  EXPECT_GT(plot_height, 0.7 * middle.height);
  EXPECT_LT(plot_height, middle.height);
}

TEST(Chart, LeavesOutWhatIsNotFinite) {
  LineChart chart;
  chart.y.logarithmic = true;
  chart.series.push_back({.label = "broken",
                          .x = {0, 1, 2, 3, NAN, 5},
                          .y = {1, NAN, 0, -3, 2, INFINITY},
                          .low = {0, 0, NAN, 1, 1, 1},
                          .high = {2, 2, 2, INFINITY, 3, 3},
                          .colour = series_colour(1)});
  EXPECT_EQ(draw_chart(chart).width, 480U);
  EXPECT_EQ(draw_chart({}).height, 300U);  // not one series
}

TEST(Chart, ColoursAreDistinct) {
  std::set<Rgb8> colours;
  for (std::size_t i = 0; i < 8; ++i) colours.insert(series_colour(i));
  EXPECT_EQ(colours.size(), 8U);
}

TEST(Raster, CellsHaveTheColourOfTheirValue) {
  RasterChart chart;
  chart.values = Grid<float>({2, 1});
  chart.values[0] = 0.0F;
  chart.values[1] = 5.0F;  // above the scale
  chart.picture_width = 120;
  const Picture picture = draw_raster(chart);
  EXPECT_EQ(picture.pixel(30, 40)[0], 0);
  EXPECT_EQ(picture.pixel(90, 40)[0], 255);
  chart.values[0] = NAN;
  EXPECT_TRUE(has_colour(draw_raster(chart), {0, 255, 0}));
}

TEST(HeatMap, CrossesOutWhatIsUndefined) {
  HeatMap map;
  map.x_words = {"1", "2"};
  map.y_words = {"a"};
  map.values = Grid<double>({2, 1}, 0.5);
  const Picture whole = draw_heat_map(map);
  map.values[1] = NAN;
  EXPECT_LT(darkness(draw_heat_map(map)), darkness(whole));
}

TEST(Page, HoldsAllPictures) {
  const Picture red(50, 20, {255, 0, 0});
  const Picture blue(30, 60, {0, 0, 255});
  const Picture page = draw_page({.title = "title", .note = "one\ntwo", .rows = {{red, blue}, {blue}}});
  EXPECT_TRUE(has_colour(page, {255, 0, 0}));
  EXPECT_TRUE(has_colour(page, {0, 0, 255}));
  EXPECT_GE(page.width, 80U);
  EXPECT_GE(page.height, 120U);
}

}  // namespace
}  // namespace abn::harness
