#include "harness/analysis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "harness/analysis_pictures.h"
#include "harness/density.h"
#include "harness/point_source.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

std::vector<analysis::Point> lattice(std::uint32_t side) {
  std::vector<analysis::Point> points;
  for (std::uint32_t i = 0; i < side * side; ++i) points.push_back({(i % side + 0.5) / side, (i / side + 0.5) / side});
  return points;
}

std::vector<analysis::Point> drawn(const std::string& strategy, std::uint64_t count, std::uint64_t seed,
                                   std::shared_ptr<const Grid<float>> density = nullptr) {
  const DrawnPoints points = draw_points(
      {.strategy = strategy, .parameters = {}, .count = count, .seed = seed, .density = std::move(density)});
  return analysis::to_unit(points.set.position, points.plane);
}

double mean_of(const Analysis& analysis, const std::string& metric) {
  for (const Estimate& estimate : analysis.estimates())
    if (estimate.metric->name == metric) return estimate.summary.mean;
  ADD_FAILURE() << metric;
  return NAN;
}

TEST(PointMetrics, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  std::set<std::string> keys;
  for (const PointMetric& metric : point_metrics()) {
    EXPECT_TRUE(names.insert(metric.name).second) << metric.name;
    EXPECT_TRUE(keys.insert(metric.group + "." + metric.key).second) << metric.key;
    EXPECT_EQ(metric.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos);
    EXPECT_FALSE(metric.good.empty()) << metric.name;
  }
  EXPECT_THROW(find_point_metric("nonsense"), ConfigError);
}

TEST(Analysis, ASquareLatticeHasItsClosedForms) {
  Analysis analysis({.name = "lattice", .pixels = {16, 16}});
  analysis.add(lattice(16));
  EXPECT_NEAR(mean_of(analysis, "relative_radius"), std::sqrt(std::sqrt(3.0) / 2), 1e-9);
  EXPECT_NEAR(mean_of(analysis, "largest_axis_power"), 256, 1e-6);
  EXPECT_EQ(static_cast<int>(mean_of(analysis, "largest_axis_frequency")) % 16, 0);
  EXPECT_EQ(mean_of(analysis, "empty_cells"), 0);
  EXPECT_NEAR(mean_of(analysis, "count_variation"), 0, 1e-12);
  EXPECT_NEAR(mean_of(analysis, "low_power"), 0, 1e-12);
}

TEST(Analysis, MeanAndErrorAreThoseOfTheSets) {
  Analysis both({.name = "random"});
  std::vector<double> alone;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    both.add(drawn("random", 256, seed));
    Analysis one({.name = "random"});
    one.add(drawn("random", 256, seed));
    alone.push_back(mean_of(one, "mean_nearest"));
    EXPECT_TRUE(std::isnan(one.estimates()[0].standard_error()));
  }
  const Summary expected = summarize(alone);
  for (const Estimate& estimate : both.estimates()) {
    if (estimate.metric->name != "mean_nearest") continue;
    EXPECT_EQ(estimate.summary.mean, expected.mean);
    EXPECT_NEAR(estimate.standard_error(), expected.standard_deviation / std::sqrt(3.0), 1e-15);
  }
  EXPECT_NEAR(mean_of(both, "mean_nearest"), 0.465, 0.05);  // 1/2 of the spacing, of a Poisson process
  EXPECT_THROW(both.add(drawn("random", 255, 1)), ConfigError);
}

TEST(Analysis, JsonHasItsGroupsAndNullWhereNothingIsKnown) {
  Analysis analysis({.name = "jitter"});
  analysis.add(drawn("jitter", 400, 1));
  const Json json = to_json(analysis, true);
  for (const char* group : {"set", "spectrum", "spacing", "order", "discrepancy", "counts", "integration", "density",
                            "run", "averaged_spectrum", "averaged_axes", "skipped", "radial", "pair_correlation"}) {
    EXPECT_TRUE(json.contains(group)) << group;
  }
  EXPECT_EQ(json["set"]["count"], 400);
  EXPECT_TRUE(json["spacing"]["relative_radius"]["mean"].is_number());
  EXPECT_TRUE(json["spacing"]["relative_radius"]["standard_error"].is_null());
  EXPECT_TRUE(json["density"]["correlation"]["mean"].is_null());
  EXPECT_EQ(json["skipped"]["density_correlation"], "needs a density");
  EXPECT_EQ(to_text(analysis).find(" nan"), std::string::npos);
}

TEST(Analysis, WhatIsTooLargeIsSkippedWithAReason) {
  const std::vector<analysis::Point> points = drawn("random", largest_for_discrepancy + 1, 1);
  const std::vector<std::string> metrics = {"star_discrepancy", "l2_star_discrepancy"};
  const SetMeasures measures = measure({.points = points}, metrics);
  EXPECT_TRUE(measures.values.empty());
  EXPECT_NE(measures.skipped.at("star_discrepancy").find("16384"), std::string::npos);
  EXPECT_THROW(measure({.points = {}}, metrics), ConfigError);
}

TEST(Analysis, AnySizeOfSetIsMeasuredAndDrawn) {
  for (const std::uint64_t count : {1U, 2U, 3U, 17U}) {
    Analysis analysis({.name = "random"});
    analysis.add(drawn("random", count, 1));
    EXPECT_EQ(to_text(analysis).find(" nan"), std::string::npos) << count;
    const Picture sheet = draw_sheet(analysis);
    EXPECT_GT(sheet.width, 400U) << count;
  }
}

TEST(Analysis, CoincidentPointsAreNumbersToo) {
  Analysis analysis({.name = "one place"});
  analysis.add(std::vector<analysis::Point>(64, {0.25, 0.75}));
  EXPECT_EQ(mean_of(analysis, "relative_radius"), 0);
  EXPECT_GT(draw_sheet(analysis).width, 400U);
}

TEST(Density, PointsThatFollowItMatchAndOthersDoNot) {
  const auto density = load_density("size:smooth:4").density;
  Analysis right({.name = "warped", .density = density});
  right.add(drawn("sobol_owen", 16384, 1, density));
  EXPECT_GT(mean_of(right, "density_correlation"), 0.98);
  EXPECT_GT(mean_of(right, "density_band_least"), 0.95);
  EXPECT_LT(mean_of(right, "density_band_most"), 1.05);
  EXPECT_NEAR(mean_of(right, "pair_plateau"), 1, 0.03);
  Analysis wrong({.name = "uniform", .density = density});
  wrong.add(drawn("random", 16384, 1));
  EXPECT_LT(mean_of(wrong, "density_correlation"), 0.2);
  EXPECT_GT(mean_of(wrong, "density_band_most"), 1.5);
}

TEST(Density, FloorAndNamesAreChecked) {
  const auto density = load_density("scene:ramp", {.floor = 0.25}).density;
  const auto cells = density->cells();
  EXPECT_NEAR(*std::min_element(cells.begin(), cells.end()), 0.25 * *std::max_element(cells.begin(), cells.end()),
              1e-6);
  EXPECT_THROW(load_density("size:nonsense"), ConfigError);
  EXPECT_THROW(load_density("scene:black"), ConfigError);
  EXPECT_THROW(load_density("scene:ramp", {.floor = 2}), ConfigError);
  EXPECT_THROW(load_density("/nowhere/x.png"), IoError);
}

TEST(Stipples, ShowTheToneOfTheirDensity) {
  Grid<float> density({2, 1}, 1.0F);
  density[1] = 0.25F;
  std::vector<analysis::Point> points = drawn("sobol_owen", 5000, 1, std::make_shared<const Grid<float>>(density));
  const Picture picture = draw_stipples(points, &density, 800);
  EXPECT_EQ(picture.height, 400U);
  double left = 0, right = 0;
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    for (std::uint32_t x = 0; x < 400; ++x) {
      left += picture.pixel(x, y)[0];
      right += picture.pixel(x + 400, y)[0];
    }
  }
  EXPECT_GT(left / right, 2.2);  // overlaps cost the bright side some of its 4
  EXPECT_LT(left / right, 4.2);
}

TEST(Stipples, ShowGhostsInBlueAroundThePlane) {
  const DrawnPoints drawn =
      draw_points({.strategy = "sph_blue_noise", .parameters = {{"boundary", "ghost"}}, .count = 400});
  ASSERT_FALSE(drawn.ghosts.empty());
  const auto points = analysis::to_unit(drawn.set.position, drawn.plane);
  std::vector<analysis::Point> ghosts;
  for (const Vec2f p : drawn.ghosts) ghosts.push_back({double{p.x}, double{p.y}});  // the plane is one pixel
  const Picture plain = draw_stipples(points, nullptr, 200);
  const Picture with = draw_stipples(points, nullptr, 200, ghosts);
  EXPECT_EQ(plain.width, 200U);
  EXPECT_GT(with.width, 240U);  // 20 spacings and three on either side
  EXPECT_LT(with.width, 320U);
  const std::uint32_t margin = (with.width - 200) / 2;
  std::size_t blue_inside = 0;
  std::size_t blue_outside = 0;
  for (std::uint32_t y = 0; y < with.height; ++y) {
    for (std::uint32_t x = 0; x < with.width; ++x) {
      const std::size_t i = (std::size_t{y} * with.width + x) * 3;
      if (with.rgb[i + 2] < with.rgb[i] + 40) continue;
      const bool inside = x >= margin + 8 && x < margin + 192 && y >= margin + 8 && y < margin + 192;
      ++(inside ? blue_inside : blue_outside);
    }
  }
  EXPECT_EQ(blue_inside, 0U);
  EXPECT_GT(blue_outside, 1000U);
}

}  // namespace
}  // namespace abn::harness
