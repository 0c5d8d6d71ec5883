#include "sampling/sph/draw.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::sph {
namespace {

double hill(double u, double v) {
  const double h = std::sin(3.141592653589793 * u) * std::sin(3.141592653589793 * v);
  return std::pow(100.0, -h * h);
}

TEST(SphDraw, GivesExactlyThatManyPointsInsideTheSquareAndAlwaysTheSame) {
  for (const double aspect : {1.0, 7.0, 1.0 / 2000}) {
    for (const std::uint64_t count : {1U, 2U, 7U, 17U, 5000U}) {
      const auto points = draw_by_density(hill, aspect, count, 3);
      ASSERT_EQ(points.size(), count);
      for (const UnitPosition p : points) ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
      const auto again = draw_by_density(hill, aspect, count, 3);
      const auto other = draw_by_density(hill, aspect, count, 4);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_TRUE(points[i].x == again[i].x && points[i].y == again[i].y);
      }
      EXPECT_FALSE(points[0].x == other[0].x && points[0].y == other[0].y);
    }
  }
}

TEST(SphDraw, FollowsTheDensity) {
  constexpr int bands = 20;
  constexpr std::uint64_t count = 100000;
  std::array<double, bands> expected{};
  double total = 0;
  constexpr int steps = 1000;
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const double mass = hill((i + 0.5) / steps, (j + 0.5) / steps);
      expected[static_cast<std::size_t>(i * bands / steps)] += mass;
      total += mass;
    }
  }
  std::array<double, bands> columns{};
  std::array<double, bands> rows{};
  for (const UnitPosition p : draw_by_density(hill, 1, count, 1)) {
    ++columns[static_cast<std::size_t>(p.x * bands)];
    ++rows[static_cast<std::size_t>(p.y * bands)];
  }
  for (std::size_t k = 0; k < bands; ++k) {  // the density is symmetric in u and v
    const double wanted = expected[k] / total * count;
    EXPECT_NEAR(columns[k], wanted, 2.5 * std::sqrt(wanted)) << "column " << k;
    EXPECT_NEAR(rows[k], wanted, 2.5 * std::sqrt(wanted)) << "row " << k;
  }
}

TEST(SphDraw, LeavesEmptyLandEmpty) {
  const auto land = [](double u, double v) { return u > 0.25 && u < 0.5 && v > 0.625 ? 3.0 : 0.0; };
  for (const std::uint64_t count : {1U, 100U, 20001U}) {
    for (const UnitPosition p : draw_by_density(land, 1, count, 9)) {
      ASSERT_TRUE(p.x >= 0.25 && p.x < 0.5 && p.y >= 0.625) << p.x << " " << p.y;
    }
  }
}

/// Variance over mean of the number of points in boxes of about 400; white noise has 1.
double relative_variance(double aspect, double per_cell) {
  double sum = 0;
  int boxes = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::array<double, 100> counts{};
    for (const UnitPosition p : draw_by_density([](double, double) { return 1.0; }, aspect, 40000, seed, per_cell)) {
      ++counts[static_cast<std::size_t>(p.y * 10) * 10 + static_cast<std::size_t>(p.x * 10)];
    }
    for (const double count : counts) sum += (count - 400) * (count - 400);
    boxes += 100;
  }
  return sum / boxes / 400;
}

TEST(SphDraw, HasNoLongWaves) {
  const double square = relative_variance(1, 16);
  RecordProperty("relative_variance", std::to_string(square));
  EXPECT_LT(square, 0.25);
  EXPECT_LT(relative_variance(1.7, 16), 0.25);
  EXPECT_NEAR(relative_variance(1, 40000), 1.0, 0.25);  // one piece: white noise
}

TEST(SphDraw, CornersAreThoseAlongTheCurve) {
  for (const double aspect : {1.0, 7.0, 1.0 / 2000, 1e6}) {
    const DrawCells cells(aspect, 30000);
    std::uint64_t number = 0;
    UnitPosition last;
    cells.for_each_corner([&](UnitPosition corner) {
      const UnitPosition again = cells.corner(number);
      ASSERT_TRUE(corner.x == again.x && corner.y == again.y) << number;
      const UnitPosition size{2 * (cells.centre(corner).x - corner.x), 2 * (cells.centre(corner).y - corner.y)};
      // From one to the next is one step to a side.
      const double steps = std::abs(corner.x - last.x) / size.x + std::abs(corner.y - last.y) / size.y;
      EXPECT_NEAR(steps, number == 0 ? 0 : 1, 1e-6);
      last = corner;
      ++number;
    });
    EXPECT_EQ(number, cells.size());
  }
}

TEST(SphDraw, FindsTheCellOfAMass) {
  const std::vector<double> before = {0, 0, 1, 1, 1, 3, 3.5, 3.5};  // 7 cells, some empty, also at both ends
  const auto expected = [](double mass) { return mass < 1 ? 1U : mass < 3 ? 4U : 5U; };
  for (const double mass : {0.0, 0.5, 1.0, 2.9, 3.0, 3.4999, 3.5, 4.0}) {
    for (std::uint64_t first = 0; first <= expected(mass); ++first) {
      EXPECT_EQ(cell_of_mass(before.data(), 7, mass, first), expected(mass)) << mass << " from " << first;
    }
  }
  const std::vector<double> single = {0, 2};
  EXPECT_EQ(cell_of_mass(single.data(), 1, 2.0, 0), 0U);
}

TEST(SphDraw, RefusesADensityThatIsNone) {
  const auto nothing = [](double, double) { return 0.0; };
  const auto bad = [](double u, double) { return u < 0.5 ? 1.0 : std::numeric_limits<double>::quiet_NaN(); };
  const auto endless = [](double u, double) { return u < 0.5 ? 1.0 : std::numeric_limits<double>::infinity(); };
  EXPECT_THROW(draw_by_density(nothing, 1, 10, 1), ConfigError);
  EXPECT_THROW(draw_by_density(bad, 1, 10, 1), ConfigError);
  EXPECT_THROW(draw_by_density(endless, 1, 10, 1), ConfigError);
  const auto negative = [](double u, double) { return u < 0.5 ? 1.0 : -0.5; };
  EXPECT_THROW(draw_by_density(negative, 1, 10, 1), ConfigError);
}

}  // namespace
}  // namespace abn::sph
