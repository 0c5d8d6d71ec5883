#include "sampling/analysis/periodogram.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>

#include "sampling/analysis/point_sets_test.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::analysis {
namespace {

// The definition, in extended precision.
double direct_power(Points points, int u, int v) {
  long double cosine = 0;
  long double sine = 0;
  for (const Point p : points) {
    const long double turns = static_cast<long double>(u) * p.x + static_cast<long double>(v) * p.y;
    const long double angle = 2 * std::numbers::pi_v<long double> * (turns - std::floor(turns));
    cosine += std::cos(angle);
    sine += std::sin(angle);
  }
  return static_cast<double>((cosine * cosine + sine * sine) / static_cast<long double>(points.size()));
}

TEST(ToUnit, DividesAndWraps) {
  const std::vector<Vec2f> positions = {{0, 0}, {150, 25}, {-50, 50}, {-1e-30F, 74.999F}};
  const auto points = to_unit(positions, {200, 50});
  EXPECT_EQ(points[1].x, 0.75);
  EXPECT_EQ(points[1].y, 0.5);
  EXPECT_EQ(points[2].x, 0.75);
  EXPECT_EQ(points[2].y, 0);
  for (const Point p : points) EXPECT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
}

TEST(Periodogram, SinglePointHasPowerOne) {
  const std::vector<Point> point = {{0.3, 0.9}};
  const Periodogram spectrum(point, 60);
  EXPECT_EQ(spectrum.count(), 1U);
  for (int v = -60; v <= 60; ++v) {
    for (int u = -60; u <= 60; ++u) ASSERT_NEAR(spectrum.power(u, v), 1, 1e-12);
  }
}

TEST(Periodogram, TwoPointsInterfere) {
  const std::vector<Point> points = {{0.1, 0.7}, {0.43, 0.95}};
  const Periodogram spectrum(points, 30);
  for (int v = -30; v <= 30; ++v) {
    for (int u = -30; u <= 30; ++u) {
      ASSERT_NEAR(spectrum.power(u, v), 1 + std::cos(2 * std::numbers::pi * (u * 0.33 + v * 0.25)), 1e-12);
    }
  }
}

TEST(Periodogram, LatticeHasAllItsPowerOnTheDualLattice) {
  const auto lattice = square_lattice(16, {0.3, 0.1});
  const Periodogram spectrum(lattice, 50);
  for (int v = -50; v <= 50; ++v) {
    for (int u = -50; u <= 50; ++u) {
      const bool on_dual = u % 16 == 0 && v % 16 == 0;
      ASSERT_NEAR(spectrum.power(u, v), on_dual ? 256 : 0, 256e-11) << u << " " << v;
    }
  }
}

TEST(Periodogram, EqualsTheDefinitionInAllQuadrants) {
  for (const char* strategy : {"random", "jitter", "regular"}) {
    const auto points = make_set(strategy, 2500, 1);  // not a multiple of the block
    const Periodogram spectrum(points, 256);
    Rng rng(1, stream_id("frequencies"));
    for (int i = 0; i < 100; ++i) {
      const int u = static_cast<int>(rng.below(513)) - 256;
      const int v = static_cast<int>(rng.below(513)) - 256;
      const double expected = direct_power(points, u, v);
      ASSERT_NEAR(spectrum.power(u, v), expected, 1e-11 * 2500) << strategy << " " << u << " " << v;
      ASSERT_NEAR(spectrum.power(u, v), expected, 1e-11 * (1 + expected)) << strategy << " " << u << " " << v;
    }
    for (const int f : {-256, 256}) ASSERT_NEAR(spectrum.power(f, -f), direct_power(points, f, -f), 1e-9);
  }
}

TEST(Periodogram, SameBitsForAnyNumberOfThreads) {
  const auto points = make_set("random", 1000, 4);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Periodogram one(points, 70);
  omp_set_num_threads(3);
  const Periodogram three(points, 70);
  omp_set_num_threads(before);
  for (int v = -70; v <= 70; ++v) {
    for (int u = -70; u <= 70; ++u) ASSERT_EQ(one.power(u, v), three.power(u, v));
  }
}

TEST(PeriodogramMean, IsTheMeanOfTheSets) {
  const Periodogram a(make_set("random", 100, 1), 20);
  const Periodogram b(make_set("random", 100, 2), 20);
  PeriodogramMean mean;
  mean.add(a);
  mean.add(b);
  EXPECT_EQ(mean.sets(), 2);
  EXPECT_EQ(mean.count(), 100U);
  for (int u = -20; u <= 20; ++u) EXPECT_DOUBLE_EQ(mean.power(u, -7), (a.power(u, -7) + b.power(u, -7)) / 2);
  EXPECT_THROW(mean.add(Periodogram(make_set("random", 101, 1), 20)), ConfigError);
  EXPECT_THROW(mean.add(Periodogram(make_set("random", 100, 1), 21)), ConfigError);
}

TEST(Periodogram, BadWordsAreRefused) {
  const std::vector<Point> one(1);
  EXPECT_THROW(Periodogram({}, 10), ConfigError);
  EXPECT_THROW(Periodogram(one, 0), ConfigError);
  EXPECT_THROW(Periodogram(one, 4097), ConfigError);
}

}  // namespace
}  // namespace abn::analysis
