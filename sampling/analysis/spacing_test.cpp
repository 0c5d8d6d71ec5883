#include "sampling/analysis/spacing.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sampling/draw_for_tests.h"
#include "sampling/error.h"
#include "sampling/jitter.h"
#include "sampling/random.h"
#include "sampling/rng.h"
#include "sampling/sobol_owen.h"

namespace abn::analysis {
namespace {

std::vector<Point> white_noise(std::size_t count, std::uint64_t seed) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, stream_id("spacing test"), i);
    const double x = rng.next() * 0x1p-32;
    points.push_back({x, rng.next() * 0x1p-32});
  }
  return points;
}

/// The same by comparing all pairs.
std::vector<double> brute_force(Points points, std::vector<double> local = {}) {
  double squares = 0;
  for (const double s : local) squares += s * s;
  const double scale = std::sqrt(static_cast<double>(points.size()) / squares);
  std::vector<double> nearest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double best = local.empty() ? 1 : 1 / (local[i] * scale);
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j) continue;
      const double x = std::abs(points[i].x - points[j].x);
      const double y = std::abs(points[i].y - points[j].y);
      const double distance = std::hypot(std::min(x, 1 - x), std::min(y, 1 - y));
      best = std::min(best, local.empty() ? distance : distance / (0.5 * scale * (local[i] + local[j])));
    }
    nearest.push_back(best / hexagonal_spacing(points.size()));
  }
  return nearest;
}

void expect_same(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-12 * (1 + expected[i])) << i;
}

TEST(Spacing, SquareLatticeHasOneDistance) {
  std::vector<Point> lattice;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) lattice.push_back({x / 32.0, y / 32.0});
  }
  const Spacing measured = spacing(lattice);
  const double expected = std::sqrt(std::sqrt(3.0) / 2);  // 1 / r_max of unit density
  for (const double value : {measured.smallest, measured.mean, measured.quantile_01, measured.median}) {
    EXPECT_NEAR(value, expected, 1e-12);
  }
}

TEST(Spacing, AgreesWithBruteForce) {
  for (const std::size_t count : {1U, 2U, 3U, 10U, 100U, 1500U}) {
    const auto points = white_noise(count, count);
    expect_same(spacing(points).nearest, brute_force(points));
    auto cluster = points;  // all but a few within a thousandth of the torus, across its corner
    for (std::size_t i = 0; i < count; i += i % 7 == 0 ? 2 : 1) {
      cluster[i] = {std::fmod(0.9995 + points[i].x / 1000, 1.0), std::fmod(0.9995 + points[i].y / 1000, 1.0)};
    }
    expect_same(spacing(cluster).nearest, brute_force(cluster));
  }
}

TEST(Spacing, LocalSpacingsAgreeWithBruteForce) {
  for (const std::size_t count : {1U, 2U, 5U, 700U}) {
    const auto points = white_noise(count, 4);
    std::vector<double> local;
    for (std::size_t i = 0; i < count; ++i) local.push_back(std::exp(6 * points[i].x - 3 * points[(i * 7) % count].y));
    expect_same(spacing(points, local).nearest, brute_force(points, local));
  }
}

TEST(Spacing, EqualLocalSpacingsChangeNothing) {
  const auto points = white_noise(500, 5);
  expect_same(spacing(points, std::vector<double>(500, 0.037)).nearest, spacing(points).nearest);
}

TEST(Spacing, AdaptiveLatticeMeasuresLikeAUniformOne) {
  // Left half a lattice of side 1/16, right half of 1/64: inside each, distances are the square lattice's.
  std::vector<Point> points;
  std::vector<double> local;
  const auto add = [&](int side, double from) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side / 2; ++x) {
        points.push_back({from + (x + 0.5) / side, (y + 0.5) / side});
        local.push_back(1.0 / side);
      }
    }
  };
  add(16, 0);
  add(64, 0.5);
  const Spacing measured = spacing(points, local);
  EXPECT_NEAR(measured.median, std::sqrt(std::sqrt(3.0) / 2), 1e-12);
  EXPECT_GT(measured.smallest, 0.9);
  EXPECT_LT(spacing(points).median, 0.7);  // without the local spacing the set looks clustered
}

TEST(Spacing, QuantilesAreCountedFromTheSmallest) {
  const Spacing measured = spacing(white_noise(1000, 6));
  auto sorted = measured.nearest;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(measured.smallest, sorted[0]);
  EXPECT_EQ(measured.quantile_01, sorted[9]);
  EXPECT_EQ(measured.median, sorted[499]);
}

TEST(Spacing, CoincidentPointsHaveNone) {
  auto points = white_noise(100, 7);
  points[3] = points[50];
  const Spacing measured = spacing(points);
  EXPECT_EQ(measured.smallest, 0);
  EXPECT_EQ(measured.nearest[3], 0);
  EXPECT_EQ(measured.nearest[50], 0);
  EXPECT_EQ(spacing(std::vector<Point>(5000, Point{0.25, 0.75})).mean, 0);
}

TEST(Spacing, SetsHaveTheirAnchors) {
  // Means of 5 seeds at N = 4096, measured with other code: white .0127, .462; jitter .0525, .587; Owen .068, .599.
  double white_least = 0, white = 0, jitter_least = 0, jitter = 0, owen_least = 0, owen = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Spacing w = spacing(to_unit(draw<Random>({1, 1}, 4096, seed), {1, 1}));
    const Spacing j = spacing(to_unit(draw<JitterPlane>({1, 1}, 4096, seed), {1, 1}));
    const Spacing o = spacing(to_unit(draw<SobolOwen>({1, 1}, 4096, seed, {.domain = "plane"}), {1, 1}));
    white_least += w.smallest / 10;
    white += w.mean / 10;
    jitter_least += j.smallest / 10;
    jitter += j.mean / 10;
    owen_least += o.smallest / 10;
    owen += o.mean / 10;
  }
  RecordProperty("mean_nearest_white_jitter_owen",
                 std::to_string(white) + " " + std::to_string(jitter) + " " + std::to_string(owen));
  EXPECT_NEAR(white, 0.5 / std::sqrt(2 / std::sqrt(3.0)), 0.005);  // 1 / (2 sqrt(density)), exact
  EXPECT_NEAR(jitter, 0.587, 0.01);
  EXPECT_NEAR(owen, 0.599, 0.01);
  EXPECT_LT(white_least, 0.025);
  EXPECT_NEAR(jitter_least, 0.0525, 0.03);
  EXPECT_NEAR(owen_least, 0.075, 0.03);
}

TEST(Spacing, DoesNotDependOnTheNumberOfThreads) {
  const auto points = white_noise(20'000, 8);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const Spacing one = spacing(points);
  omp_set_num_threads(3);
  const Spacing three = spacing(points);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.nearest, three.nearest);
  EXPECT_EQ(one.mean, three.mean);
}

TEST(Spacing, WrongInputIsRefused) {
  const auto points = white_noise(3, 1);
  EXPECT_THROW(spacing(Points{}), ConfigError);
  EXPECT_THROW(spacing(points, std::vector<double>{1, 2}), ConfigError);
  EXPECT_THROW(spacing(points, std::vector<double>{1, 2, 0}), ConfigError);
  EXPECT_THROW(spacing(points, std::vector<double>{1, 2, std::numeric_limits<double>::infinity()}), ConfigError);
}

}  // namespace
}  // namespace abn::analysis
