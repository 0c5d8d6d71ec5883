#include "sampling/analysis/pair_correlation.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sampling/analysis/point_sets_test.h"
#include "sampling/analysis/radial_profile.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::analysis {
namespace {

double wrapped(double d) { return d - std::round(d); }

double ring_area(const PairCorrelation& c, std::size_t k) {
  return std::numbers::pi * (2 * static_cast<double>(k) + 1) * c.bin_width * c.bin_width;
}

// Unordered pairs whose distance is in [from, to) spacings, to whole bins.
double pairs_between(const PairCorrelation& c, double from, double to) {
  double pairs = 0;
  for (std::size_t k = 0; k < c.g.size(); ++k) {
    const double middle = (static_cast<double>(k) + 0.5) * c.bin_width;
    if (middle >= from && middle < to) pairs += c.g[k] * ring_area(c, k) * static_cast<double>(c.count - 1) / 2;
  }
  return pairs;
}

struct Adaptive {
  std::vector<Point> points;
  std::vector<float> size;
};

float size_at(Point p) {  // 1 : 5, smooth on the torus
  return static_cast<float>(std::exp(
      0.4 * std::log(5.0) * (std::sin(2 * std::numbers::pi * p.x) + 0.25 * std::cos(2 * std::numbers::pi * p.y))));
}

// Random points of density s^-2; with `exclusion` > 0 none closer than that times the mean of the two sizes.
Adaptive adaptive_set(std::size_t count, std::uint64_t seed, double exclusion = 0) {
  Adaptive set;
  Rng rng(seed, stream_id("adaptive"));
  const double smallest = std::exp(-0.5 * std::log(5.0));
  while (set.points.size() < count) {
    const Point p{rng.uniform(), rng.uniform()};
    const float s = size_at(p);
    if (rng.uniform() * static_cast<double>(s) * static_cast<double>(s) > smallest * smallest) continue;
    bool free = true;
    for (std::size_t j = 0; j < set.points.size() && free && exclusion > 0; ++j) {
      const double distance = std::hypot(wrapped(p.x - set.points[j].x), wrapped(p.y - set.points[j].y));
      free = distance >= exclusion * 0.5 * (static_cast<double>(s) + static_cast<double>(set.size[j]));
    }
    if (!free) continue;
    set.points.push_back(p);
    set.size.push_back(s);
  }
  return set;
}

TEST(PairCorrelation, TwoPointsAcrossTheBorder) {
  const std::vector<Point> points = {{0.95, 0.5}, {0.2, 0.5}};
  const PairCorrelation c = pair_correlation(points);
  EXPECT_EQ(c.pairs, 1U);
  EXPECT_EQ(c.count, 2U);
  EXPECT_LE(c.range, 0.5 * std::sqrt(2.0));  // half the torus, not the 8 spacings asked for
  for (std::size_t k = 0; k < c.g.size(); ++k) {
    const bool there = k == 11;  // 0.25 sqrt(2) * 32 = 11.3
    EXPECT_DOUBLE_EQ(c.g[k], there ? 2 / ring_area(c, k) : 0) << k;
  }
  double total = 0;
  for (const double cell : c.difference.cells()) total += cell;
  const double cell_area = 4 * c.bin_width * c.bin_width;
  EXPECT_DOUBLE_EQ(total, 2 / cell_area);
  ASSERT_EQ(c.g.size(), 22U);
  const auto columns = [&](std::uint32_t x) { return c.difference.at(x, 10) + c.difference.at(x, 11); };  // dy = 0
  EXPECT_DOUBLE_EQ(columns(16), 1 / cell_area);  // (11.3 + 22) / 2
  EXPECT_DOUBLE_EQ(columns(5), 1 / cell_area);   // (-11.3 + 22) / 2
}

TEST(PairCorrelation, LatticeHasItsShells) {
  const PairCorrelation c = pair_correlation(square_lattice(40, {0.5, 0.5}), {}, {.range = 3, .bins_per_spacing = 32});
  EXPECT_EQ(pairs_between(c, 0, 0.95), 0);
  EXPECT_NEAR(pairs_between(c, 0.95, 1.05), 2 * 1600, 1e-6);  // 4 neighbours
  EXPECT_NEAR(pairs_between(c, 1.05, 1.38), 0, 1e-6);
  EXPECT_NEAR(pairs_between(c, 1.38, 1.45), 2 * 1600, 1e-6);  // 4 at sqrt(2)
  EXPECT_NEAR(pairs_between(c, 1.95, 2.05), 2 * 1600, 1e-6);  // 4 at 2
  EXPECT_NEAR(pairs_between(c, 2.2, 2.27), 4 * 1600, 1e-6);   // 8 at sqrt(5)
  EXPECT_NEAR(pairs_between(c, 2.8, 2.87), 2 * 1600, 1e-6);   // 4 at 2 sqrt(2)
}

TEST(PairCorrelation, EqualsAllPairs) {
  for (const std::size_t count : {5U, 40U, 700U}) {
    for (const bool adaptive : {false, true}) {
      const Adaptive set = adaptive_set(count, count);
      const PairCorrelation c =
          pair_correlation(set.points, adaptive ? std::span<const float>(set.size) : std::span<const float>());
      double squares = 0;
      for (const float s : set.size) squares += static_cast<double>(s) * static_cast<double>(s);
      const double mean = adaptive ? std::sqrt(squares / static_cast<double>(count)) : 1;
      std::vector<double> pairs(c.g.size());
      Grid<double> cells(c.difference.size());
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) {
          if (i == j) continue;
          const double sum = adaptive ? static_cast<double>(set.size[i]) + static_cast<double>(set.size[j]) : 2;
          const double scale = 2 * mean / sum * std::sqrt(static_cast<double>(count)) / c.bin_width;
          const double dx = wrapped(set.points[i].x - set.points[j].x) * scale;
          const double dy = wrapped(set.points[i].y - set.points[j].y) * scale;
          const double distance = std::hypot(dx, dy);
          if (distance >= static_cast<double>(pairs.size())) continue;
          pairs[static_cast<std::size_t>(distance)] += 1;
          const auto half = static_cast<double>(pairs.size());
          cells.at(static_cast<std::uint32_t>((dx + half) / 2), static_cast<std::uint32_t>((dy + half) / 2)) += 1;
        }
      }
      const auto n1 = static_cast<double>(count - 1);
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        ASSERT_NEAR(c.g[k] * n1 * ring_area(c, k), pairs[k], 1e-6) << count << " " << adaptive << " " << k;
      }
      for (std::size_t i = 0; i < cells.cells().size(); ++i) {
        ASSERT_NEAR(c.difference[i] * n1 * 4 * c.bin_width * c.bin_width, cells[i], 1e-6) << count << " " << adaptive;
      }
    }
  }
}

TEST(PairCorrelation, PoissonProcessHasOneEverywhere) {
  const auto points = make_set("random", 4096, 3);
  const PairCorrelation c = pair_correlation(points);
  ASSERT_EQ(c.g.size(), 256U);
  double squares = 0;
  for (std::size_t k = 0; k < c.g.size(); ++k) {
    const double expected = 4095 * ring_area(c, k) / 2;
    const double counted = c.g[k] * expected;
    squares += (counted - expected) * (counted - expected) / expected / 256;
  }
  EXPECT_NEAR(squares, 1, 0.36);  // 4 standard errors
  EXPECT_NEAR(c.plateau, 1, 0.01);
}

// The same for random points whose density follows s^-2: measured in local spacings they are a Poisson process.
TEST(PairCorrelation, AdaptivePoissonProcessHasOneToo) {
  std::vector<PairCorrelation> sets;
  std::vector<PairCorrelation> as_uniform;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Adaptive set = adaptive_set(2000, seed);
    sets.push_back(pair_correlation(set.points, set.size, {.range = 3}));
    as_uniform.push_back(pair_correlation(set.points, {}, {.range = 3}));
  }
  const PairCorrelation mean = mean_of(sets);
  EXPECT_EQ(mean.sets, 5);
  EXPECT_NEAR(mean.plateau, 1, 0.03);
  EXPECT_NEAR(pairs_between(mean, 0, 1) / (1999 * std::numbers::pi / 2), 1, 0.04);
  EXPECT_GT(pairs_between(mean_of(as_uniform), 0, 1) / (1999 * std::numbers::pi / 2), 1.3);
}

TEST(PairCorrelation, SizesMakeTheHoleOfAnAdaptivePoissonDiskSetVisible) {
  constexpr std::size_t kCount = 1000;
  constexpr double kExclusion = 0.0165;
  const Adaptive set = adaptive_set(kCount, 1, kExclusion);
  double squares = 0;
  for (const float s : set.size) squares += static_cast<double>(s) * static_cast<double>(s) / kCount;
  const double hole = kExclusion * std::sqrt(squares) * std::sqrt(1.0 * kCount);  // [local spacings]
  ASSERT_GT(hole, 0.4);
  const PairCorrelation c = pair_correlation(set.points, set.size, {.range = 4});
  EXPECT_EQ(pairs_between(c, 0, hole - c.bin_width), 0);
  EXPECT_GT(pairs_between(c, hole, hole + 0.1), 50);
  EXPECT_NEAR(c.plateau, 1, 0.1);
  const PairCorrelation uniform = pair_correlation(set.points, {}, {.range = 4});
  EXPECT_GT(pairs_between(uniform, 0, hole - c.bin_width), 50);
}

TEST(RadialPower, AgreesWithThePeriodogram) {
  for (const char* strategy : {"jitter", "poisson_disk"}) {
    std::vector<PairCorrelation> sets;
    RadialAverage average;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto points = make_set(strategy, 1024, seed);
      sets.push_back(pair_correlation(points));
      average.add(Periodogram(points, 64));
    }
    const RadialProfile profile = average.profile();
    std::vector<double> frequency;
    for (int k = 1; k <= 64; ++k) frequency.push_back(k / 32.0);
    const std::vector<double> power = radial_power(mean_of(sets), frequency);
    double squares = 0;
    for (std::size_t k = 1; k <= 64; ++k) squares += std::pow(power[k - 1] - profile.mean[k], 2) / 64;
    EXPECT_LT(std::sqrt(squares), 0.04) << strategy;
  }
}

TEST(RadialPower, OfNoCorrelationIsOne) {
  PairCorrelation flat;
  flat.count = 100;
  flat.range = 2;
  flat.bin_width = 0.5;
  flat.g.assign(4, 1.0);
  const std::vector<double> frequency = {0.0, 0.5, 3.0};
  EXPECT_EQ(radial_power(flat, frequency), (std::vector<double>{1, 1, 1}));
  flat.g[0] = 0;  // an empty disc of radius 0.5 takes its area away at frequency 0
  const double weight = 0.42 + 0.5 * std::cos(std::numbers::pi / 8) + 0.08 * std::cos(std::numbers::pi / 4);
  EXPECT_NEAR(radial_power(flat, frequency)[0], 1 - weight * std::numbers::pi / 4, 1e-12);
}

TEST(PairCorrelation, SameBitsForAnyNumberOfThreads) {
  const Adaptive set = adaptive_set(3000, 7);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const PairCorrelation one = pair_correlation(set.points, set.size);
  omp_set_num_threads(4);
  const PairCorrelation four = pair_correlation(set.points, set.size);
  omp_set_num_threads(before);
  EXPECT_EQ(one.g, four.g);
  EXPECT_TRUE(std::ranges::equal(one.difference.cells(), four.difference.cells()));
}

TEST(PairCorrelation, BadWordsAreRefused) {
  const std::vector<Point> points = {{0.1, 0.1}, {0.5, 0.6}};
  const std::vector<float> one_size = {1};
  const std::vector<float> zero = {1, 0};
  const std::vector<float> infinite = {1, std::numeric_limits<float>::infinity()};
  EXPECT_THROW(pair_correlation(std::vector<Point>(1)), ConfigError);
  EXPECT_THROW(pair_correlation(points, one_size), ConfigError);
  EXPECT_THROW(pair_correlation(points, zero), ConfigError);
  EXPECT_THROW(pair_correlation(points, infinite), ConfigError);
  EXPECT_THROW(pair_correlation(points, {}, {.range = 0}), ConfigError);
  EXPECT_THROW(pair_correlation(points, {}, {.range = 0.01}), ConfigError);
  EXPECT_THROW(pair_correlation(points, {}, {.bins_per_spacing = 0}), ConfigError);
  EXPECT_THROW(mean_of({}), ConfigError);
  const std::vector<PairCorrelation> unlike = {pair_correlation(points), pair_correlation(square_lattice(4))};
  EXPECT_THROW(mean_of(unlike), ConfigError);
}

TEST(PairCorrelationMean, CoversTheShortestRange) {
  const std::vector<Point> points = {{0.1, 0.1}, {0.12, 0.1}, {0.5, 0.7}, {0.9, 0.3}, {0.88, 0.31}, {0.3, 0.9}};
  const PairCorrelation wide = pair_correlation(points, {}, {.range = 1, .bins_per_spacing = 16});
  const PairCorrelation narrow = pair_correlation(points, {}, {.range = 0.5, .bins_per_spacing = 16});
  const std::vector<PairCorrelation> sets = {wide, narrow};
  const PairCorrelation mean = mean_of(sets);
  ASSERT_EQ(mean.g.size(), 8U);
  EXPECT_DOUBLE_EQ(mean.range, 0.5);
  EXPECT_EQ(mean.sets, 2);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_DOUBLE_EQ(mean.g[k], narrow.g[k]);
  ASSERT_EQ(mean.difference.size(), (Extent{8, 8}));
  for (std::size_t c = 0; c < 64; ++c) EXPECT_DOUBLE_EQ(mean.difference[c], narrow.difference[c]) << c;
}

}  // namespace
}  // namespace abn::analysis
