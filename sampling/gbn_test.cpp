#include "sampling/gbn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "sampling/blue_noise_test.h"
#include "sampling/contract.h"
#include "sampling/error.h"
#include "sampling/relaxation_start.h"
#include "sampling/relaxation_test.h"

namespace abn {
namespace {

static_assert(StrategyClass<Gbn>);

/// Sums of exp(-r^2/2) and its gradient over all images, in double.
struct BruteForce {
  double energy = 0;  // per point
  std::vector<double> x, y;
};

BruteForce brute_force(const std::vector<Vec2f>& points, Extent plane) {
  const double spacing = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(points.size()));
  const double width = plane.width / spacing;
  const double height = plane.height / spacing;
  const int reach_x = static_cast<int>(std::ceil(9 / width)) + 1;
  const int reach_y = static_cast<int>(std::ceil(9 / height)) + 1;
  BruteForce sums;
  for (const Vec2f a : points) {
    double gx = 0, gy = 0;
    for (const Vec2f b : points) {
      for (int i = -reach_x; i <= reach_x; ++i) {
        for (int j = -reach_y; j <= reach_y; ++j) {
          const double dx = (double{a.x} - double{b.x}) / spacing + i * width;
          const double dy = (double{a.y} - double{b.y}) / spacing + j * height;
          const double overlap = std::exp(-(dx * dx + dy * dy) / 2);
          sums.energy += overlap / static_cast<double>(points.size());
          gx += overlap * dx;
          gy += overlap * dy;
        }
      }
    }
    sums.x.push_back(gx);
    sums.y.push_back(gy);
  }
  return sums;
}

TEST(GaussianOverlap, IsTheExponentialUpToItsCutOff) {
  for (int i = 0; i < 25000; ++i) {
    const float r2 = static_cast<float>(i) * 1e-3F;
    ASSERT_NEAR(double{gaussian_overlap(r2)} / std::exp(-double{r2} / 2), 1, 2e-5) << r2;
  }
  EXPECT_EQ(gaussian_overlap(25.0F), 0);
  EXPECT_EQ(gaussian_overlap(1e30F), 0);
}

TEST(RelaxGaussian, OneIterationIsTheGradientOfBruteForce) {
  for (const auto& [plane, count] : {std::pair{Extent{16, 16}, 300U},
                                     {Extent{1, 1}, 1U},
                                     {Extent{1, 1}, 7U},
                                     {Extent{1, 200}, 40U},
                                     {Extent{300, 2}, 50U},
                                     {Extent{9, 7}, 2U}}) {
    const double spacing = std::sqrt(static_cast<double>(plane.area()) / count);
    const std::vector<Vec2f> start = relaxation_start("white", plane, count, 5);
    const BruteForce sums = brute_force(start, plane);
    std::vector<Vec2f> moved = start;
    const GaussianReport report = relax_gaussian(moved, plane, {.step = 0.1, .momentum = 0, .iterations = 1});
    EXPECT_NEAR(report.first_energy, sums.energy, 1e-4 * sums.energy);
    const auto difference = [&](double expected, float actual, std::uint32_t length) {
      return std::abs(std::remainder(double{actual} - expected, static_cast<double>(length))) / spacing;
    };
    for (std::size_t i = 0; i < count; ++i) {
      if (std::hypot(0.1 * sums.x[i], 0.1 * sums.y[i]) > 0.5) continue;  // a capped move
      EXPECT_LT(difference(double{start[i].x} + 0.1 * sums.x[i] * spacing, moved[i].x, plane.width), 1e-4);
      EXPECT_LT(difference(double{start[i].y} + 0.1 * sums.y[i] * spacing, moved[i].y, plane.height), 1e-4);
    }
  }
}

TEST(RelaxGaussian, EnergyIsThePowerUnderAGaussian) {
  // Plancherel: E - 2 pi = 2 pi / N * sum over k != 0 of exp(-k^2/2) |sum_i exp(i k x_i)|^2 / N, k in radians per
  // spacing.
  const Extent plane{12, 8};
  std::vector<Vec2f> points = relaxation_start("jitter", plane, 96, 1);
  const GaussianReport report = relax_gaussian(points, plane, {.momentum = 0, .iterations = 0});
  double power = 0;
  for (int v = -20; v <= 20; ++v) {
    for (int u = -20; u <= 20; ++u) {
      if (u == 0 && v == 0) continue;
      const double kx = 2 * std::numbers::pi * u / plane.width;  // the spacing is 1 px
      const double ky = 2 * std::numbers::pi * v / plane.height;
      double real = 0, imaginary = 0;
      for (const Vec2f p : points) {
        real += std::cos(kx * double{p.x} + ky * double{p.y});
        imaginary += std::sin(kx * double{p.x} + ky * double{p.y});
      }
      power += std::exp(-(kx * kx + ky * ky) / 2) * (real * real + imaginary * imaginary) / 96;
    }
  }
  const double expected = 2 * std::numbers::pi * power / 96;
  EXPECT_GT(expected, 0.01);
  EXPECT_NEAR(report.energy - 2 * std::numbers::pi, expected, 1e-4);
  EXPECT_EQ(report.energy, report.first_energy);
}

TEST(RelaxGaussian, PlainDescentNeverRaisesTheEnergy) {
  const Extent plane{30, 20};
  for (const char* start : {"white", "coarse_cells", "sobol_owen", "jitter"}) {
    std::vector<Vec2f> points = relaxation_start(start, plane, 900, 3);
    double first = 0;
    double last = 0;
    for (int i = 0; i < 60; ++i) {
      const GaussianReport report = relax_gaussian(points, plane, {.step = 0.25, .momentum = 0, .iterations = 1});
      EXPECT_LE(report.energy, report.first_energy + 2e-6) << start << " " << i;  // float sums
      if (i == 0) first = report.first_energy;
      last = report.energy;
    }
    EXPECT_LT(last - 2 * std::numbers::pi, 0.1 * (first - 2 * std::numbers::pi)) << start;
  }
}

TEST(RelaxGaussian, MomentumIsFasterThanPlainDescent) {
  const Extent plane{32, 32};
  const std::vector<Vec2f> start = relaxation_start("coarse_cells", plane, 1024, 1);
  std::vector<Vec2f> plain = start;
  std::vector<Vec2f> heavy = start;
  const auto slow = relax_gaussian(plain, plane, {.step = 0.25, .momentum = 0, .iterations = 100});
  const auto fast = relax_gaussian(heavy, plane, {});
  EXPECT_LT(fast.energy - 2 * std::numbers::pi, 0.5 * (slow.energy - 2 * std::numbers::pi));
  EXPECT_GT(nearest_neighbours(heavy, plane).mean, nearest_neighbours(plain, plane).mean + 0.05);
}

TEST(RelaxGaussian, StopsAtItsTolerance) {
  std::vector<Vec2f> points = relaxation_start("white", {16, 16}, 256, 1);
  const auto report = relax_gaussian(points, {16, 16}, {.step = 0.25, .momentum = 0, .tolerance = 0.02});
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.iterations, 100);
  EXPECT_LT(report.mean_displacement, 0.02);
}

TEST(RelaxGaussian, CoincidentPointsPartOnceTheyAreSeparated) {
  for (const Extent plane : {Extent{10, 10}, Extent{1, 2000}}) {
    std::vector<Vec2f> points(200, Vec2f{0.5F, 5.0F});
    separate_coincident(points, plane, 1);
    const auto report = relax_gaussian(points, plane, {.iterations = 400});
    EXPECT_EQ(report.non_finite, 0U);
    for (const Vec2f p : points) {
      ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width) && p.y >= 0 &&
                  p.y < static_cast<float>(plane.height));
    }
    EXPECT_LT(report.energy, 0.5 * report.first_energy) << plane.width;
  }
}

TEST(Gbn, ReachesThePublishedQuality) {
  // 1000 plain iterations from white noise, N = 4096, 5 seeds, by the authors' method: relative radius .526, mean
  // nearest neighbour .793, half-plane error .1235, no power at low frequencies.
  const Extent plane{64, 64};
  double least = 0, mean = 0, half_planes = 0;
  constexpr int seeds = 3;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Gbn sampler({.plane = plane, .budget = 4096, .seed = seed}, {});
    const auto samples = all_positions(sampler);
    const Spacing spacing = nearest_neighbours(samples, plane);
    least += spacing.least / seeds;
    mean += spacing.mean / seeds;
    half_planes += half_plane_error(samples, plane) / seeds;
    EXPECT_LE(largest_axis_power(samples, plane), 30) << seed;
    EXPECT_LT(diagnostic(sampler, "mean_displacement"), 0.01);
    EXPECT_LT(diagnostic(sampler, "energy"), 2 * std::numbers::pi + 2e-4);
    for (const Diagnostic& d : sampler.diagnostics()) EXPECT_FALSE(d.warning) << d.name;
  }
  RecordProperty("relative_radius", std::to_string(least));
  RecordProperty("mean_nearest_neighbour", std::to_string(mean));
  RecordProperty("half_plane_error", std::to_string(half_planes));
  EXPECT_GE(least, 0.42);
  EXPECT_GE(mean, 0.78);
  EXPECT_LE(half_planes, 0.15);

  Gbn small({.plane = {32, 32}, .budget = 1024, .seed = 1}, {});
  EXPECT_LT(low_frequency_power(all_positions(small), {32, 32}), 5e-4);
}

TEST(Gbn, KeepsTheContract) {
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
        contract_breaches(row<Gbn>(), {.plane = plane, .budget = budget, .seed = 3}, {{"iterations", "20"}});
    EXPECT_TRUE(breaches.empty()) << breaches.front() << " " << plane.width << "x" << plane.height << " " << budget;
  }
}

TEST(Gbn, WarnsWhenItOvershoots) {
  Gbn sampler({.plane = {16, 16}, .budget = 1000}, {.iterations = 40, .step = 3});
  all_positions(sampler);
  int warnings = 0;
  for (const Diagnostic& d : sampler.diagnostics()) warnings += d.warning ? 1 : 0;
  EXPECT_EQ(warnings, 1);
}

TEST(Gbn, BadWordsAreRefused) {
  const SamplingTask task{.plane = {8, 8}, .budget = 10};
  for (const auto& [key, word] :
       {std::pair{"start", "circle"}, {"iterations", "-1"}, {"momentum", "1"}, {"step", "-1"}}) {
    EXPECT_THROW(row<Gbn>().make(task, {{key, word}}), ConfigError) << key;
  }
  EXPECT_THROW(Gbn({.plane = {8, 8}, .budget = 0}, {}), ConfigError);
  EXPECT_THROW(Gbn({.plane = {8, 8}, .budget = std::uint64_t{1} << 32}, {}), ConfigError);
}

}  // namespace
}  // namespace abn
