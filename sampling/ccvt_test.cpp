#include "sampling/ccvt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "sampling/blue_noise_test.h"
#include "sampling/contract.h"
#include "sampling/error.h"
#include "sampling/relaxation_start.h"
#include "sampling/relaxation_test.h"

namespace abn {
namespace {

static_assert(StrategyClass<Ccvt>);

double distance2(Vec2f a, Vec2f b, Extent plane) {
  const double dx = std::remainder(double{a.x} - double{b.x}, static_cast<double>(plane.width));
  const double dy = std::remainder(double{a.y} - double{b.y}, static_cast<double>(plane.height));
  return dx * dx + dy * dy;
}

std::vector<Vec2f> sorted(std::vector<Vec2f> points) {
  std::sort(points.begin(), points.end(), [](Vec2f a, Vec2f b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  return points;
}

struct Result {
  std::vector<Vec2f> sites, samples;
  CcvtReport report;
};

Result run(Extent plane, std::uint64_t count, const CcvtDescent& descent, std::uint64_t seed = 1) {
  Result result;
  result.sites = relaxation_start("coarse_cells", plane, count, seed);
  result.report = relax_ccvt(result.sites, result.samples, plane, descent, seed);
  return result;
}

TEST(RelaxCcvt, CapacitiesAreExactlyEqualAndEverySampleHasOneOwner) {
  const Extent plane{20, 15};
  for (const int capacity : {1, 7, 16, 64}) {
    const Result before = run(plane, 300, {.capacity = capacity, .iterations = 0});
    const Result after = run(plane, 300, {.capacity = capacity});
    // Site i owns the i-th `capacity` samples, so equal capacities are a matter of keeping all samples.
    ASSERT_EQ(after.samples.size(), 300U * static_cast<unsigned>(capacity));
    EXPECT_EQ(sorted(before.samples), sorted(after.samples));
  }
}

TEST(RelaxCcvt, SitesAreCentroidsAndNoSwapGains) {
  for (const auto& sizes : {std::pair{Extent{10, 10}, 100U}, {Extent{1, 200}, 50U}, {Extent{9, 7}, 2U}}) {
    const Extent plane = sizes.first;  // no structured binding: a lambda below captures it
    const unsigned count = sizes.second;
    const double spacing = std::sqrt(static_cast<double>(plane.area()) / count);
    const Result result = run(plane, count, {.capacity = 16, .iterations = 1000});
    ASSERT_TRUE(result.report.converged);
    const auto owned = [&](std::size_t site, std::size_t k) { return result.samples[site * 16 + k]; };
    for (std::size_t i = 0; i < count; ++i) {
      // Up to a period: on a plane as narrow as a cell a sample may lie half way round.
      double x = 0, y = 0;
      for (std::size_t k = 0; k < 16; ++k) {
        x += double{owned(i, k).x} - double{result.sites[i].x};
        y += double{owned(i, k).y} - double{result.sites[i].y};
      }
      EXPECT_LT(std::abs(std::remainder(x, static_cast<double>(plane.width))) / 16, 1e-4 * spacing) << i;
      EXPECT_LT(std::abs(std::remainder(y, static_cast<double>(plane.height))) / 16, 1e-4 * spacing) << i;
    }
    // Against brute force over all pairs of sites and samples. The last move, to the centroids, comes after the last
    // search for swaps, so that very few are left.
    int gains = 0;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        double greatest = -1e9;
        double least = 1e9;
        for (std::size_t k = 0; k < 16; ++k) {
          const auto preference = [&](Vec2f s) {
            return distance2(s, result.sites[i], plane) - distance2(s, result.sites[j], plane);
          };
          greatest = std::max(greatest, preference(owned(i, k)));
          least = std::min(least, preference(owned(j, k)));
        }
        gains += greatest > least + 1e-4 * spacing * spacing ? 1 : 0;
      }
    }
    EXPECT_LE(gains, static_cast<int>(count / 10)) << plane.width << "x" << plane.height;
  }
}

TEST(RelaxCcvt, EnergyNeverRises) {
  const Extent plane{20, 15};
  const auto energy = [&](int iterations) {
    return run(plane, 300, {.capacity = 16, .iterations = iterations, .relaxation = 1}).report.energy;
  };
  double last = energy(0);
  EXPECT_EQ(last, run(plane, 300, {.capacity = 16}).report.first_energy);
  for (int iterations = 1; iterations < 20; ++iterations) {
    const double now = energy(iterations);
    EXPECT_LE(now, last * (1 + 1e-6)) << iterations;
    last = now;
  }
  EXPECT_LT(last, 0.5 * energy(0));
  EXPECT_LT(run(plane, 300, {.capacity = 64}).report.energy, 0.178);
}

TEST(RelaxCcvt, LargerCapacitiesEndNearerToTheHexagonalEnergy) {
  // .16038 is the least of any equal areas; 1/6, that of squares, is passed by none of these.
  const Extent plane{32, 32};
  const double c64 = run(plane, 1024, {.capacity = 64}).report.energy;
  const double c256 = run(plane, 1024, {.capacity = 256}).report.energy;
  EXPECT_GT(c256, 0.16038);
  EXPECT_LT(c256, c64);
  EXPECT_LT(c64, 0.175);
}

TEST(RelaxCcvt, CoincidentSitesPart) {
  for (const Extent plane : {Extent{10, 10}, Extent{1, 2000}}) {
    std::vector<Vec2f> sites(100, Vec2f{0.5F, 5.0F});  // not even separated
    std::vector<Vec2f> samples;
    const auto report = relax_ccvt(sites, samples, plane, {}, 1);
    for (const Vec2f p : sites) {
      ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width) && p.y >= 0 &&
                  p.y < static_cast<float>(plane.height));
    }
    EXPECT_LT(report.energy, 0.1 * report.first_energy) << plane.width;
    EXPECT_GT(nearest_neighbours(sites, plane).least, plane.width == 1 ? 1e-3 : 0.3);
  }
}

TEST(Ccvt, HasEvenSpacingFewLongWavesAndNoLattice) {
  // N = 4096, mean of 5 seeds: relative radius .66, mean nearest neighbour .83, half-plane error .125 (Lloyd .17),
  // largest power on the axes 11. The lattice of the area's samples, of the halving and of the pixels stays out.
  const Extent plane{64, 64};
  double least = 0, mean = 0, half_planes = 0;
  constexpr int seeds = 3;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Ccvt sampler({.plane = plane, .budget = 4096, .seed = seed}, {});
    const auto samples = all_positions(sampler);
    const Spacing spacing = nearest_neighbours(samples, plane);
    least += spacing.least / seeds;
    mean += spacing.mean / seeds;
    half_planes += half_plane_error(samples, plane) / seeds;
    EXPECT_LE(largest_axis_power(samples, plane), 30) << seed;
    EXPECT_LT(diagnostic(sampler, "energy"), 0.1735);
    EXPECT_EQ(diagnostic(sampler, "converged"), 1);
  }
  RecordProperty("relative_radius", std::to_string(least));
  RecordProperty("mean_nearest_neighbour", std::to_string(mean));
  RecordProperty("half_plane_error", std::to_string(half_planes));
  EXPECT_GE(least, 0.60);
  EXPECT_GE(mean, 0.82);
  EXPECT_LE(half_planes, 0.145);
}

TEST(Ccvt, KeepsTheContract) {
  for (const auto& [plane, budget] : {std::pair{Extent{1, 1}, 1U},
                                      {Extent{1, 1}, 100U},
                                      {Extent{8, 8}, 2U},
                                      {Extent{8, 8}, 7U},
                                      {Extent{1, 2000}, 1U},
                                      {Extent{1, 2000}, 500U},
                                      {Extent{2000, 1}, 7U},
                                      {Extent{37, 19}, 1001U},
                                      {Extent{1000, 1000}, 50U}}) {
    const auto breaches = contract_breaches(row<Ccvt>(), {.plane = plane, .budget = budget, .seed = 3});
    EXPECT_TRUE(breaches.empty()) << breaches.front() << " " << plane.width << "x" << plane.height << " " << budget;
  }
}

TEST(Ccvt, BadWordsAreRefused) {
  const SamplingTask task{.plane = {8, 8}, .budget = 10};
  for (const auto& [key, word] :
       {std::pair{"start", "circle"}, {"iterations", "-1"}, {"capacity", "0"}, {"relaxation", "2"}}) {
    EXPECT_THROW(row<Ccvt>().make(task, {{key, word}}), ConfigError) << key;
  }
  EXPECT_THROW(Ccvt({.plane = {8, 8}, .budget = 0}, {}), ConfigError);
  EXPECT_THROW(Ccvt({.plane = {8, 8}, .budget = std::uint64_t{1} << 26}, {}), ConfigError);
}

}  // namespace
}  // namespace abn
