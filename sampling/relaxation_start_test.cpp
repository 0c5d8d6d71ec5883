#include "sampling/relaxation_start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "sampling/error.h"

namespace abn {
namespace {

bool inside(Vec2f p, Extent plane) {
  return p.x >= 0 && p.x < static_cast<float>(plane.width) && p.y >= 0 && p.y < static_cast<float>(plane.height);
}

bool distinct(std::vector<Vec2f> points) {
  std::sort(points.begin(), points.end(), [](Vec2f a, Vec2f b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  return std::adjacent_find(points.begin(), points.end()) == points.end();
}

TEST(RelaxationStart, GivesDistinctPointsInsideThePlane) {
  for (const char* start : {"coarse_cells", "white", "sobol_owen", "jitter"}) {
    for (const auto& [plane, count] : {std::pair{Extent{1, 1}, 1U},
                                       {Extent{1, 1}, 300U},
                                       {Extent{1, 2000}, 7U},
                                       {Extent{2000, 1}, 5000U},
                                       {Extent{20, 30}, 601U}}) {
      const auto points = relaxation_start(start, plane, count, 1);
      ASSERT_EQ(points.size(), count) << start;
      for (const Vec2f p : points) ASSERT_TRUE(inside(p, plane)) << start << " " << p.x << " " << p.y;
      EXPECT_TRUE(distinct(points)) << start;
      EXPECT_EQ(points, relaxation_start(start, plane, count, 1));
      EXPECT_NE(points, relaxation_start(start, plane, count, 2)) << start;
    }
  }
}

TEST(RelaxationStart, JitterAndSobolOwenFillEveryCellOfTheirGrid) {
  for (const char* start : {"sobol_owen", "jitter"}) {
    std::vector<int> cells(256);
    int moved_out = 0;  // by the separation, across a border
    for (const Vec2f p : relaxation_start(start, {32, 32}, 256, 3)) {
      ++cells[static_cast<std::size_t>(p.y / 2) * 16 + static_cast<std::size_t>(p.x / 2)];
    }
    for (const int count : cells) moved_out += count == 1 ? 0 : 1;
    EXPECT_LE(moved_out, 8) << start;
  }
}

TEST(SeparateCoincident, PartsEqualPointsByLittle) {
  for (const Extent plane : {Extent{10, 10}, Extent{1, 65536}}) {
    const Vec2f corner{0, just_below(static_cast<float>(plane.height))};
    std::vector<Vec2f> points(50, corner);
    separate_coincident(points, plane, 1);
    EXPECT_TRUE(distinct(points)) << plane.height;
    const double spacing = std::sqrt(static_cast<double>(plane.area()) / 50);
    for (const Vec2f p : points) {
      ASSERT_TRUE(inside(p, plane));
      EXPECT_LE(std::abs(std::remainder(p.x - corner.x, static_cast<float>(plane.width))), 2e-3 * spacing);
      EXPECT_LE(std::abs(std::remainder(p.y - corner.y, static_cast<float>(plane.height))), 2e-3 * spacing);
    }
  }
}

TEST(WrapToPlane, IsPeriodicAndNeverReachesTheBorder) {
  EXPECT_EQ(wrap_to_plane(3.25, 10), 3.25F);
  EXPECT_EQ(wrap_to_plane(-0.25, 10), 9.75F);
  EXPECT_EQ(wrap_to_plane(10, 10), 0);
  EXPECT_EQ(wrap_to_plane(123.5, 10), 3.5F);
  for (const double x : {-1e-30, 10 - 1e-12, std::nextafter(10.0, 0.0), 1e15, -1e15}) {
    EXPECT_GE(wrap_to_plane(x, 10), 0) << x;
    EXPECT_LT(wrap_to_plane(x, 10), 10) << x;
  }
}

TEST(RequireBudget, NamesStrategyAndRange) {
  EXPECT_NO_THROW(require_budget("gbn", 1, 5));
  EXPECT_NO_THROW(require_budget("gbn", 5, 5));
  EXPECT_THROW(require_budget("gbn", 0, 5), ConfigError);
  try {
    require_budget("gbn", 6, 5);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "gbn: budget 6 is not possible; ask for 1 to 5 samples");
  }
}

}  // namespace
}  // namespace abn
