#include "sampling/analysis/order.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::analysis {
namespace {

std::vector<Point> white_noise(std::size_t count, std::uint64_t seed) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, stream_id("order test"), i);
    const double x = rng.next() * 0x1p-32;
    points.push_back({x, rng.next() * 0x1p-32});
  }
  return points;
}

/// 26 points in each of 30 rows: 30 rows of an exact hexagonal lattice are 25.98 high.
std::vector<Point> hexagonal() {
  std::vector<Point> points;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 26; ++x) points.push_back({(x + 0.5 * (y % 2)) / 26, y / 30.0});
  }
  return points;
}

TEST(BondOrder, HexagonalLatticeIsPerfect) {
  const BondOrder order = bond_order(hexagonal());
  EXPECT_NEAR(order.local_order, 1, 1e-5);
  EXPECT_NEAR(order.global_order, 1, 1e-5);
  EXPECT_EQ(order.six_valent, 1);
  EXPECT_NEAR(order.coverage_radius, 1 / std::sqrt(3.0), 1e-3);
}

TEST(BondOrder, SquareLatticeHasFourNeighboursAndNoSixfoldOrder) {
  std::vector<Point> lattice;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) lattice.push_back({(x + 0.3) / 40, y / 40.0});
  }
  const BondOrder order = bond_order(lattice);
  EXPECT_NEAR(order.local_order, 0, 1e-6);
  EXPECT_EQ(order.six_valent, 0);
  EXPECT_NEAR(order.coverage_radius, std::sqrt(0.5) * std::sqrt(std::sqrt(3.0) / 2), 1e-9);
}

TEST(BondOrder, PatchesOfTwoOrientationsCancelGloballyOnly) {
  // psi_6 of a lattice turned by 30 degrees, x and y exchanged, is -1. Lower half one, upper half the other.
  std::vector<Point> points;
  for (const Point& p : hexagonal()) {
    if (p.y < 0.5) points.push_back(p);
    if (p.x < 0.5) points.push_back({p.y, 0.5 + p.x});
  }
  const BondOrder order = bond_order(points);
  EXPECT_GT(order.local_order, 0.85);
  EXPECT_LT(order.global_order, 0.1);
}

TEST(BondOrder, WhiteNoiseHasTheShareOfHexagonsOfThePoissonVoronoiTessellation) {
  // Share of hexagons .2947 (Drouffe & Itzykson 1984); its standard error here is about .002.
  const BondOrder order = bond_order(white_noise(50'000, 1));
  RecordProperty("local_order", std::to_string(order.local_order));
  EXPECT_NEAR(order.six_valent, 0.2947, 0.008);
  EXPECT_LT(order.global_order, 0.01);
  EXPECT_GT(order.coverage_radius, 1.2);
  EXPECT_NEAR(order.local_order, 0.361, 0.005);
}

TEST(BondOrder, CoverageRadiusIsTheHole) {
  // A hole of radius 0.2 in a fine lattice: the largest empty circle is it, give or take a spacing.
  std::vector<Point> points;
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 100; ++column) {
      const double x = std::min(column, 100 - column) / 100.0;  // around the corner of the torus
      const double y = std::min(row, 100 - row) / 100.0;
      if (std::hypot(x, y) > 0.2) points.push_back({column / 100.0, row / 100.0});
    }
  }
  const double unit = std::sqrt(2 / (std::sqrt(3.0) * static_cast<double>(points.size())));
  const double radius = bond_order(points).coverage_radius * unit;
  EXPECT_GE(radius, 0.2);
  EXPECT_LE(radius, 0.21);
}

TEST(BondOrder, AnySetIsMeasured) {
  for (std::size_t count = 1; count <= 8; ++count) {
    const BondOrder order = bond_order(white_noise(count, count));
    EXPECT_TRUE(std::isfinite(order.local_order) && order.local_order <= 1 + 1e-12);
    EXPECT_TRUE(order.global_order <= order.local_order + 1e-12);
    EXPECT_GT(order.coverage_radius, 0.3);
  }
  auto twice = white_noise(200, 3);
  const auto once = twice;
  twice.insert(twice.end(), once.begin(), once.end());
  EXPECT_EQ(bond_order(twice).six_valent, bond_order(once).six_valent);  // coincident points count once
  EXPECT_THROW(bond_order(Points{}), ConfigError);
}

TEST(BondOrder, DoesNotDependOnTheNumberOfThreads) {
  const auto points = white_noise(20'000, 8);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const BondOrder one = bond_order(points);
  omp_set_num_threads(3);
  const BondOrder three = bond_order(points);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.local_order, three.local_order);
  EXPECT_EQ(one.global_order, three.global_order);
  EXPECT_EQ(one.six_valent, three.six_valent);
  EXPECT_EQ(one.coverage_radius, three.coverage_radius);
}

}  // namespace
}  // namespace abn::analysis
