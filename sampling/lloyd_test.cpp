#include "sampling/lloyd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sampling/blue_noise_test.h"
#include "sampling/contract.h"
#include "sampling/error.h"
#include "sampling/relaxation_start.h"
#include "sampling/relaxation_test.h"

namespace abn {
namespace {

static_assert(StrategyClass<Lloyd>);

const double hexagonal_energy = 5 / (18 * std::sqrt(3.0));  // .16038, the least possible

/// Hexagonal but for .04 %: 26 x 52 points on 26 x 45.
std::vector<Vec2f> hexagonal_lattice() {
  std::vector<Vec2f> points;
  for (int row = 0; row < 52; ++row) {
    for (int column = 0; column < 26; ++column) {
      points.push_back({static_cast<float>(column + 0.5 * (row % 2)), static_cast<float>(row * 45.0 / 52.0)});
    }
  }
  return points;
}

TEST(RelaxLloyd, HexagonalLatticeIsAFixedPointAndTheLeastEnergy) {
  const Extent plane{26, 45};
  const std::vector<Vec2f> lattice = hexagonal_lattice();
  std::vector<Vec2f> points = lattice;
  const LloydReport report = relax_lloyd(points, plane, {.iterations = 5});
  EXPECT_NEAR(report.energy, hexagonal_energy, 1e-6);
  EXPECT_LT(report.mean_displacement, 1e-6);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT(std::abs(std::remainder(points[i].x - lattice[i].x, 26.0F)), 1e-5);
    EXPECT_LT(std::abs(std::remainder(points[i].y - lattice[i].y, 45.0F)), 1e-5);
  }
}

TEST(RelaxLloyd, SquareLatticeHasTheEnergyOfSquaresAndIsLeft) {
  // A square of area A has A^2/6 about its centre; the square lattice is a saddle, so a small push leads away.
  std::vector<Vec2f> points;
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 20; ++column) {
      points.push_back({static_cast<float>(column) + 0.5F, static_cast<float>(row) + 0.5F});
    }
  }
  std::vector<Vec2f> exact = points;
  EXPECT_NEAR(relax_lloyd(exact, {20, 20}, {.iterations = 3}).energy, 1.0 / 6, 1e-12);
  EXPECT_EQ(exact, points);
  separate_coincident(points, {20, 20}, 1);
  EXPECT_LT(relax_lloyd(points, {20, 20}, {.iterations = 500}).energy, 0.1635);
}

TEST(RelaxLloyd, EveryPointMovesToTheCentroidOfItsCell) {
  // The centroid by sampling the plane: every place belongs to its nearest point.
  const Extent plane{6, 4};
  const std::vector<Vec2f> start = relaxation_start("white", plane, 12, 2);
  std::vector<double> x(12), y(12), area(12);
  constexpr int fine = 100;
  double energy = 0;
  for (int v = 0; v < 4 * fine; ++v) {
    for (int u = 0; u < 6 * fine; ++u) {
      const double px = (u + 0.5) / fine;
      const double py = (v + 0.5) / fine;
      std::size_t nearest = 0;
      double least = 1e9, dx = 0, dy = 0;
      for (std::size_t i = 0; i < 12; ++i) {
        const double to_x = std::remainder(px - double{start[i].x}, 6.0);
        const double to_y = std::remainder(py - double{start[i].y}, 4.0);
        const double d2 = to_x * to_x + to_y * to_y;
        if (d2 < least) {
          least = d2;
          nearest = i;
          dx = to_x;
          dy = to_y;
        }
      }
      x[nearest] += dx;
      y[nearest] += dy;
      area[nearest] += 1;
      energy += least / (fine * fine);
    }
  }
  for (const double relaxation : {1.0, 1.5}) {
    std::vector<Vec2f> moved = start;
    const auto report = relax_lloyd(moved, plane, {.relaxation = relaxation, .iterations = 1});
    EXPECT_NEAR(report.first_energy, energy / (24.0 * 24 / 12), 1e-4);
    for (std::size_t i = 0; i < 12; ++i) {
      const double to_x = relaxation * x[i] / area[i];
      const double to_y = relaxation * y[i] / area[i];
      EXPECT_LT(std::abs(std::remainder(double{moved[i].x} - double{start[i].x} - to_x, 6.0)), 2e-3);
      EXPECT_LT(std::abs(std::remainder(double{moved[i].y} - double{start[i].y} - to_y, 4.0)), 2e-3);
    }
  }
}

TEST(RelaxLloyd, EnergyNeverRises) {
  const Extent plane{30, 20};
  for (const char* start : {"white", "coarse_cells", "sobol_owen", "jitter"}) {
    std::vector<Vec2f> points = relaxation_start(start, plane, 900, 3);
    for (int i = 0; i < 60; ++i) {
      const LloydReport report = relax_lloyd(points, plane, {.iterations = 1});
      EXPECT_LE(report.energy, report.first_energy * (1 + 1e-9)) << start << " " << i;
      EXPECT_GE(report.energy, hexagonal_energy);
    }
    EXPECT_LT(relax_lloyd(points, plane, {.iterations = 0}).energy, 0.166) << start;
  }
}

TEST(RelaxLloyd, OverRelaxationIsFaster) {
  const Extent plane{32, 32};
  const std::vector<Vec2f> start = relaxation_start("coarse_cells", plane, 1024, 1);
  std::vector<Vec2f> plain = start;
  std::vector<Vec2f> fast = start;
  const double slow_energy = relax_lloyd(plain, plane, {.iterations = 50}).energy;
  const double fast_energy = relax_lloyd(fast, plane, {.relaxation = 1.8, .iterations = 50}).energy;
  EXPECT_LT(fast_energy - hexagonal_energy, 0.9 * (slow_energy - hexagonal_energy));
}

TEST(RelaxLloyd, StopsAtItsTolerance) {
  std::vector<Vec2f> points = relaxation_start("white", {16, 16}, 256, 1);
  const auto report = relax_lloyd(points, {16, 16}, {.iterations = 1000, .tolerance = 0.02});
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.iterations, 100);
  EXPECT_LT(report.mean_displacement, 0.02);
}

TEST(RelaxLloyd, CoincidentPointsPart) {
  for (const Extent plane : {Extent{10, 10}, Extent{1, 2000}}) {
    std::vector<Vec2f> points(100, Vec2f{0.5F, 5.0F});
    separate_coincident(points, plane, 1);
    const auto report = relax_lloyd(points, plane, {.iterations = 300});
    for (const Vec2f p : points) {
      ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width) && p.y >= 0 &&
                  p.y < static_cast<float>(plane.height));
    }
    EXPECT_LT(report.energy, 0.25 * report.first_energy) << plane.width;
  }
}

TEST(Lloyd, ReachesEvenSpacingButKeepsLongWaves) {
  // N = 4096, 50 iterations, 5 seeds: relative radius .76, mean nearest neighbour .91, half-plane error .17 (a method
  // with equal areas has .12), energy 1.02 times the hexagonal.
  const Extent plane{64, 64};
  double least = 0, mean = 0, half_planes = 0;
  constexpr int seeds = 3;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Lloyd sampler({.plane = plane, .budget = 4096, .seed = seed}, {});
    const auto samples = all_positions(sampler);
    const Spacing spacing = nearest_neighbours(samples, plane);
    least += spacing.least / seeds;
    mean += spacing.mean / seeds;
    half_planes += half_plane_error(samples, plane) / seeds;
    EXPECT_LE(largest_axis_power(samples, plane), 60) << seed;
    EXPECT_LT(diagnostic(sampler, "energy"), 1.03 * hexagonal_energy);
  }
  RecordProperty("relative_radius", std::to_string(least));
  RecordProperty("mean_nearest_neighbour", std::to_string(mean));
  RecordProperty("half_plane_error", std::to_string(half_planes));
  EXPECT_GE(least, 0.70);
  EXPECT_GE(mean, 0.90);
  EXPECT_LE(half_planes, 0.21);
}

TEST(Lloyd, KeepsTheContract) {
  for (const auto& [plane, budget] : {std::pair{Extent{1, 1}, 1U},
                                      {Extent{1, 1}, 100U},
                                      {Extent{8, 8}, 2U},
                                      {Extent{8, 8}, 7U},
                                      {Extent{1, 2000}, 1U},
                                      {Extent{1, 2000}, 500U},
                                      {Extent{2000, 1}, 7U},
                                      {Extent{37, 19}, 5001U},
                                      {Extent{1000, 1000}, 50U}}) {
    const auto breaches =
        contract_breaches(row<Lloyd>(), {.plane = plane, .budget = budget, .seed = 3}, {{"iterations", "10"}});
    EXPECT_TRUE(breaches.empty()) << breaches.front() << " " << plane.width << "x" << plane.height << " " << budget;
  }
}

TEST(Lloyd, BadWordsAreRefused) {
  const SamplingTask task{.plane = {8, 8}, .budget = 10};
  for (const auto& [key, word] :
       {std::pair{"start", "circle"}, {"iterations", "-1"}, {"relaxation", "2"}, {"relaxation", "0"}}) {
    EXPECT_THROW(row<Lloyd>().make(task, {{key, word}}), ConfigError) << key;
  }
  EXPECT_THROW(Lloyd({.plane = {8, 8}, .budget = 0}, {}), ConfigError);
}

}  // namespace
}  // namespace abn
