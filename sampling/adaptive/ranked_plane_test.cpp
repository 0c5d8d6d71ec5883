#include "sampling/adaptive/ranked_plane.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sampling/blue_noise_test.h"
#include "sampling/disk_cache.h"
#include "sampling/disk_grid.h"
#include "sampling/error.h"
#include "sampling/sph_blue_noise.h"
#include "sampling/test_folder.h"

namespace abn {
namespace {

std::vector<Vec2f> beginning(const RankedPlane& plane, std::size_t count) {
  return {plane.position.begin(), plane.position.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::vector<Vec2f> sorted(std::vector<Vec2f> points) {
  std::sort(points.begin(), points.end(), [](Vec2f a, Vec2f b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  return points;
}

void expect_inside(const RankedPlane& ranked, Extent plane, std::size_t count) {
  ASSERT_EQ(ranked.position.size(), count);
  for (const Vec2f p : ranked.position) {
    ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width));
    ASSERT_TRUE(p.y >= 0 && p.y < static_cast<float>(plane.height));
  }
}

TEST(RankedPlane, ExactCountInsideThePlane) {
  for (const Extent plane : {Extent{1, 1}, Extent{30, 20}, Extent{1, 200}, Extent{500, 3}}) {
    for (const std::uint64_t count : {1, 2, 7, 300, 1500}) {
      for (const auto boundary : {sph::Boundary::periodic, sph::Boundary::ghost}) {
        expect_inside(ranked_plane(plane, count, 1, {.boundary = boundary}, false), plane, count);
      }
    }
  }
  EXPECT_THROW(ranked_plane({1, 1}, 0, 1, {}, false), ConfigError);
}

// All together they are what the strategy of the same name makes, so that nothing is lost where there is nothing to
// adapt to.
TEST(RankedPlane, AllOfItIsTheBlueNoiseOfItsSeed) {
  const SamplingTask task{.plane = {30, 20}, .budget = 3000, .seed = 5};
  SphBlueNoise blue_noise(task, {});
  const auto ranked = ranked_plane(task.plane, task.budget, task.seed, {.boundary = sph::Boundary::periodic}, false);
  EXPECT_EQ(sorted(ranked.position), sorted(all_positions(blue_noise)));
}

TEST(RankedPlane, EveryBeginningIsSpreadEvenly) {
  const Extent plane{40, 40};
  const auto ranked = ranked_plane(plane, 3000, 1, {.boundary = sph::Boundary::periodic}, false);
  for (const double share : {0.02, 0.1, 0.25, 1.0 / 3, 0.5, 0.75}) {
    const auto count = static_cast<std::size_t>(share * 3000);
    const auto points = beginning(ranked, count);
    // White noise: .01; darts in random order, bisected to the count: .39 to .55.
    EXPECT_GT(smallest_torus_distance(points, plane), 0.58 * reference_radius(plane, count)) << share;
    // White noise: 1.
    EXPECT_LT(low_frequency_power(points, plane), 0.3) << share;
  }
}

// No share of the plane gets more than its share of the first samples, at the walls neither.
TEST(RankedPlane, WallsAreServedLikeTheMiddle) {
  const Extent plane{50, 50};
  double at_wall = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto ranked = ranked_plane(plane, 7500, seed, {.boundary = sph::Boundary::ghost}, false);
    for (const Vec2f p : beginning(ranked, 2500)) {
      at_wall += std::min(std::min(p.x, 50 - p.x), std::min(p.y, 50 - p.y)) < 1 ? 1 : 0;
    }
  }
  EXPECT_NEAR(at_wall / 8 / (4 * 50 - 4), 1, 0.06);
}

TEST(RankedPlane, SameForAnyNumberOfThreadsOtherForOtherSeeds) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = ranked_plane({30, 20}, 3000, 1, {}, false);
  omp_set_num_threads(3);
  const auto three = ranked_plane({30, 20}, 3000, 1, {}, false);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.position, three.position);
  EXPECT_NE(one.position, ranked_plane({30, 20}, 3000, 2, {}, false).position);
}

TEST(RankedPlane, CacheGivesTheSameBitsAndDistrustsFiles) {
  const TestFolder folder;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string saved = before == nullptr ? "" : before;
  ::setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
  const auto fresh = ranked_plane({30, 20}, 3000, 1, {}, true);
  const auto again = ranked_plane({30, 20}, 3000, 1, {}, true);
  EXPECT_FALSE(fresh.cached);
  EXPECT_TRUE(again.cached);
  EXPECT_EQ(fresh.position, again.position);
  EXPECT_FALSE(ranked_plane({30, 20}, 3000, 1, {}, false).cached);
  // Every argument is part of the key.
  EXPECT_FALSE(ranked_plane({30, 21}, 3000, 1, {}, true).cached);
  EXPECT_FALSE(ranked_plane({30, 20}, 3001, 1, {}, true).cached);
  EXPECT_FALSE(ranked_plane({30, 20}, 3000, 2, {}, true).cached);
  EXPECT_FALSE(ranked_plane({30, 20}, 3000, 1, {.boundary = sph::Boundary::ghost}, true).cached);
  EXPECT_FALSE(ranked_plane({30, 20}, 3000, 1, {.iterations = 24}, true).cached);
  EXPECT_FALSE(ranked_plane({30, 20}, 3000, 1, {.per_cell = 17}, true).cached);
  // Another engine's points are not kept.
  EXPECT_FALSE(ranked_plane({30, 20}, 3000, 1, {}, true, sph::make_cpu_solver_double).cached);
  for (const auto& entry : std::filesystem::directory_iterator(cache_folder())) {
    std::ofstream(entry.path(), std::ios::trunc) << "rubbish";
  }
  const auto repaired = ranked_plane({30, 20}, 3000, 1, {}, true);
  EXPECT_FALSE(repaired.cached);
  EXPECT_EQ(repaired.position, fresh.position);
  EXPECT_TRUE(ranked_plane({30, 20}, 3000, 1, {}, true).cached);
  if (before == nullptr) {
    ::unsetenv("XDG_CACHE_HOME");
  } else {
    ::setenv("XDG_CACHE_HOME", saved.c_str(), 1);
  }
}

}  // namespace
}  // namespace abn
