#include "sampling/disk_grid.h"

#include <gtest/gtest.h>

#include "sampling/blue_noise_test.h"
#include "sampling/rng.h"

namespace abn {
namespace {

TEST(DiskGrid, DecidesLikeAllPairs) {
  for (const Extent plane : {Extent{1, 1}, {1, 50}, {50, 1}, {3, 5}, {7, 200}, {200, 137}}) {
    for (const double share : {0.05, 0.2, 0.5, 0.8, 1.3}) {
      DiskGrid grid(plane, share * reference_radius(plane, 20));
      std::vector<Vec2f> kept;
      Rng rng(5, stream_id("disk grid test"), plane.area());
      for (int i = 0; i < 1500; ++i) {
        // Half-way down to another radius: the points must be found in the new cells too.
        if (i == 700) grid.lower_radius(0.6 * grid.radius());
        const float x = uniform_position(rng, plane.width);
        const Vec2f point{x, uniform_position(rng, plane.height)};
        bool fits = true;
        for (const Vec2f other : kept) {
          fits = fits && std::sqrt(torus_distance_squared(point, other, plane.width, plane.height)) >= grid.radius();
        }
        ASSERT_EQ(grid.try_add(point), fits) << plane.width << "x" << plane.height << " radius " << grid.radius();
        if (fits) kept.push_back(point);
      }
      EXPECT_EQ(grid.points(), kept);
      EXPECT_GE(smallest_torus_distance(kept, plane), grid.radius());
    }
  }
}

TEST(DiskGrid, RadiusZeroLetsEverythingIn) {
  DiskGrid grid({4, 4}, 1.0);
  EXPECT_TRUE(grid.try_add({1, 1}));
  EXPECT_FALSE(grid.try_add({1, 1}));
  grid.lower_radius(0);
  EXPECT_TRUE(grid.try_add({1, 1}));
}

TEST(DiskGrid, CornersOfTheTorusAreNeighbours) {
  DiskGrid grid({10, 10}, 1.0);
  EXPECT_TRUE(grid.try_add({0, 0}));
  EXPECT_FALSE(grid.try_add({just_below(10.0F), just_below(10.0F)}));
  EXPECT_FALSE(grid.try_add({9.3F, 0.5F}));
  EXPECT_TRUE(grid.try_add({8.999F, 0}));
}

TEST(ReferenceRadius, HexagonalOnWideLinearOnNarrowPlanes) {
  EXPECT_NEAR(reference_radius({1, 1}, 4096), 1.0745699 / 64, 1e-8);
  EXPECT_NEAR(reference_radius({200, 200}, 240'000), 200 * 1.0745699 / std::sqrt(240'000.0), 1e-6);
  EXPECT_NEAR(reference_radius({1, 2000}, 7), 2000.0 / 7, 1e-9);
  EXPECT_NEAR(reference_radius({2000, 1}, 7), 2000.0 / 7, 1e-9);
}

}  // namespace
}  // namespace abn
