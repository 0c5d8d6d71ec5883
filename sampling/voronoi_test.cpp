#include "sampling/voronoi.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

std::vector<Vec2d> white_noise(std::size_t count, std::uint64_t seed, double width = 1, double height = 1) {
  std::vector<Vec2d> points;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, stream_id("voronoi test"), i);
    const double x = rng.next() * 0x1p-32;
    points.push_back({x * width, rng.next() * 0x1p-32 * height});
  }
  return points;
}

/// The right half of the unit square is a hundred times as dense as the left one.
std::vector<Vec2d> density_jump(std::size_t count) {
  auto points = white_noise(count, 3);
  for (std::size_t i = 0; i < count; ++i) points[i].x = i % 101 == 0 ? points[i].x / 2 : 0.5 + points[i].x / 2;
  return points;
}

double total_area(const PeriodicVoronoi& voronoi) {
  VoronoiCell cell;
  double sum = 0;
  for (std::size_t i = 0; i < voronoi.size(); ++i) {
    voronoi.cell(i, cell);
    sum += cell.area();
  }
  return sum;
}

/// Total length of the edges between each ordered pair of points, without those too short to mean anything.
std::map<std::pair<std::uint32_t, std::uint32_t>, double> borders(const PeriodicVoronoi& voronoi, double shortest) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> lengths;
  VoronoiCell cell;
  for (std::uint32_t i = 0; i < voronoi.size(); ++i) {
    voronoi.cell(i, cell);
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const std::size_t next = (k + 1) % cell.size();
      const double length = std::hypot(cell.x[next] - cell.x[k], cell.y[next] - cell.y[k]);
      if (length > shortest) lengths[{i, cell.neighbour[k]}] += length;
    }
  }
  return lengths;
}

double torus_squared(Vec2d a, Vec2d b, double width, double height) {
  const double dx = std::abs(a.x - b.x);
  const double dy = std::abs(a.y - b.y);
  const double x = std::min(dx, width - dx);
  const double y = std::min(dy, height - dy);
  return x * x + y * y;
}

TEST(PeriodicVoronoi, SquareLatticeHasUnitSquares) {
  std::vector<Vec2f> lattice;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 12; ++x) lattice.push_back({static_cast<float>(x) + 0.25F, static_cast<float>(y) + 0.5F});
  }
  const PeriodicVoronoi voronoi(lattice, {12, 8});
  ASSERT_EQ(voronoi.size(), lattice.size());
  VoronoiCell cell;
  for (std::uint32_t i = 0; i < lattice.size(); ++i) {
    voronoi.cell(i, cell);
    EXPECT_NEAR(cell.area(), 1, 1e-12);
    EXPECT_NEAR(cell.farthest_vertex(), std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(cell.centroid().x, 0, 1e-12);
    EXPECT_NEAR(cell.centroid().y, 0, 1e-12);
    std::vector<std::uint32_t> found;
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const std::size_t next = (k + 1) % cell.size();
      if (std::hypot(cell.x[next] - cell.x[k], cell.y[next] - cell.y[k]) > 1e-9) found.push_back(cell.neighbour[k]);
    }
    std::sort(found.begin(), found.end());
    const std::uint32_t x = i % 12;
    const std::uint32_t y = i / 12;
    std::vector<std::uint32_t> expected{y * 12 + (x + 1) % 12, y * 12 + (x + 11) % 12, (y + 1) % 8 * 12 + x,
                                        (y + 7) % 8 * 12 + x};
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(found, expected);
  }
}

TEST(PeriodicVoronoi, HexagonalLatticeHasHexagons) {
  // Rows of spacing 1 at the distance sqrt(3) / 2, every second one shifted by half.
  const double row = std::sqrt(3.0) / 2;
  std::vector<Vec2d> lattice;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 7; ++x) lattice.push_back({x + (y % 2) * 0.5, y * row});
  }
  const PeriodicVoronoi voronoi(lattice, 7, 10 * row);
  VoronoiCell cell;
  for (std::size_t i = 0; i < lattice.size(); ++i) {
    voronoi.cell(i, cell);
    EXPECT_EQ(cell.size(), 6U);
    EXPECT_NEAR(cell.area(), row, 1e-12);
    EXPECT_NEAR(cell.farthest_vertex(), 1 / std::sqrt(3.0), 1e-12);
  }
}

TEST(PeriodicVoronoi, AreasSumToThePlane) {
  EXPECT_NEAR(total_area(PeriodicVoronoi(white_noise(20'000, 1), 1, 1)), 1, 1e-9);
  EXPECT_NEAR(total_area(PeriodicVoronoi(density_jump(20'000), 1, 1)), 1, 1e-9);
  EXPECT_NEAR(total_area(PeriodicVoronoi(white_noise(500, 2, 1, 2000), 1, 2000)) / 2000, 1, 1e-9);
  EXPECT_NEAR(total_area(PeriodicVoronoi(white_noise(500, 2, 3000, 2), 3000, 2)) / 6000, 1, 1e-9);
  for (std::size_t count = 1; count <= 40; ++count) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      EXPECT_NEAR(total_area(PeriodicVoronoi(white_noise(count, seed, 3, 2), 3, 2)), 6, 1e-9) << count << " " << seed;
    }
  }
}

TEST(PeriodicVoronoi, NeighboursShareTheirBorder) {
  for (const auto& points : {white_noise(3000, 4), density_jump(3000), white_noise(3, 5), white_noise(2, 6)}) {
    const auto lengths = borders(PeriodicVoronoi(points, 1, 1), 1e-12);
    EXPECT_GE(lengths.size(), points.size());
    for (const auto& entry : lengths) {
      const auto other = lengths.find({entry.first.second, entry.first.first});
      ASSERT_NE(other, lengths.end()) << entry.first.first << " " << entry.first.second << " " << entry.second;
      EXPECT_NEAR(entry.second, other->second, 1e-11);
    }
  }
}

TEST(PeriodicVoronoi, EdgesLieHalfWayAndNoPointIsNearerToAVertex) {
  // The definition itself, by brute force, on a plane that is not square.
  for (const std::size_t count : {2U, 5U, 60U, 400U}) {
    const auto points = white_noise(count, 7, 5, 1);
    const PeriodicVoronoi voronoi(points, 5, 1);
    VoronoiCell cell;
    for (std::size_t i = 0; i < count; ++i) {
      voronoi.cell(i, cell);
      for (std::size_t k = 0; k < cell.size(); ++k) {
        const Vec2d vertex{points[i].x + cell.x[k], points[i].y + cell.y[k]};
        const Vec2d on_plane{vertex.x - 5 * std::floor(vertex.x / 5), vertex.y - std::floor(vertex.y)};
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec2d p : points) nearest = std::min(nearest, torus_squared(p, on_plane, 5, 1));
        const double own = cell.x[k] * cell.x[k] + cell.y[k] * cell.y[k];
        EXPECT_NEAR(nearest, own, 1e-12) << count;
      }
    }
  }
}

TEST(PeriodicVoronoi, CellsAreCounterClockwiseAndConvex) {
  const PeriodicVoronoi voronoi(density_jump(5000), 1, 1);
  VoronoiCell cell;
  for (std::size_t i = 0; i < voronoi.size(); ++i) {
    voronoi.cell(i, cell);
    ASSERT_GE(cell.size(), 3U);
    EXPECT_EQ(cell.x.size(), cell.neighbour.size());
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const std::size_t b = (k + 1) % cell.size();
      const std::size_t c = (k + 2) % cell.size();
      const double turn =
          (cell.x[b] - cell.x[k]) * (cell.y[c] - cell.y[b]) - (cell.y[b] - cell.y[k]) * (cell.x[c] - cell.x[b]);
      EXPECT_GT(turn, -1e-14);
      EXPECT_GT(cell.x[k] * cell.y[b] - cell.x[b] * cell.y[k], -1e-14);
    }
  }
}

TEST(PeriodicVoronoi, CentroidsAgreeWithMonteCarlo) {
  // 64 jittered points on 8 x 8; 400 000 random points are counted to the nearest: about 6 250 each, so that the mean
  // of their offsets has a standard error of about 0.3 / sqrt(6250) = 0.004 px.
  std::vector<Vec2f> points;
  for (std::uint64_t i = 0; i < 64; ++i) {
    points.push_back(to_pixel(Rng(1, stream_id("jittered"), i).uniform2(), i % 8, static_cast<std::uint32_t>(i / 8)));
  }
  const PeriodicVoronoi voronoi(points, {8, 8});
  std::vector<double> hits(64, 0), x(64, 0), y(64, 0);
  constexpr int trials = 400'000;
  for (const Vec2d q : white_noise(trials, 11, 8, 8)) {
    std::size_t owner = 0;
    for (std::size_t i = 1; i < 64; ++i) {
      if (torus_squared(voronoi.position(i), q, 8, 8) < torus_squared(voronoi.position(owner), q, 8, 8)) owner = i;
    }
    const double dx = q.x - voronoi.position(owner).x;
    const double dy = q.y - voronoi.position(owner).y;
    hits[owner] += 1;
    x[owner] += dx - 8 * std::round(dx / 8);
    y[owner] += dy - 8 * std::round(dy / 8);
  }
  VoronoiCell cell;
  for (std::size_t i = 0; i < 64; ++i) {
    voronoi.cell(i, cell);
    EXPECT_NEAR(cell.area(), hits[i] * 64 / trials, 5 * std::sqrt(hits[i]) * 64 / trials);
    EXPECT_NEAR(cell.centroid().x, x[i] / hits[i], 0.025);
    EXPECT_NEAR(cell.centroid().y, y[i] / hits[i], 0.025);
  }
}

TEST(PeriodicVoronoi, OnePointOwnsThePlane) {
  const PeriodicVoronoi voronoi(std::vector<Vec2f>{{2.5F, 0.25F}}, {3, 2});
  VoronoiCell cell;
  voronoi.cell(0, cell);
  EXPECT_DOUBLE_EQ(cell.area(), 6);
  EXPECT_EQ(cell.neighbour, std::vector<std::uint32_t>(4, 0));
  EXPECT_DOUBLE_EQ(cell.farthest_vertex(), std::sqrt(1.5 * 1.5 + 1));
}

TEST(PeriodicVoronoi, PointsOnALineShareItInStrips) {
  for (const std::size_t count : {2U, 3U, 50U}) {
    std::vector<Vec2d> points;
    for (std::size_t i = 0; i < count; ++i)
      points.push_back({0.3, static_cast<double>(i) / static_cast<double>(count)});
    const PeriodicVoronoi voronoi(points, 1, 1);
    VoronoiCell cell;
    for (std::size_t i = 0; i < count; ++i) {
      voronoi.cell(i, cell);
      EXPECT_NEAR(cell.area(), 1.0 / static_cast<double>(count), 1e-13);
      EXPECT_NEAR(cell.farthest_vertex(), std::hypot(0.5, 0.5 / static_cast<double>(count)), 1e-13);
    }
  }
}

TEST(PeriodicVoronoi, TheLowestIndexOwnsCoincidentPoints) {
  auto points = white_noise(50, 8);
  points[20] = points[10];
  points[49] = points[10];
  const PeriodicVoronoi voronoi(points, 1, 1);
  VoronoiCell cell;
  for (std::size_t i = 0; i < points.size(); ++i) {
    voronoi.cell(i, cell);
    EXPECT_EQ(cell.empty(), i == 20 || i == 49);
    EXPECT_EQ(std::count(cell.neighbour.begin(), cell.neighbour.end(), 20U), 0);
    if (cell.empty()) {
      EXPECT_EQ(cell.area(), 0);
      EXPECT_EQ(cell.farthest_vertex(), 0);
      EXPECT_EQ(cell.centroid(), Vec2d{});
    }
  }
  EXPECT_NEAR(total_area(voronoi), 1, 1e-12);
  // Also where others have the same x, in any order.
  std::vector<Vec2d> column;
  for (std::size_t i = 0; i < 200; ++i) column.push_back({0.5, static_cast<double>(i * 37 % 50) / 50});
  const PeriodicVoronoi strips(column, 1, 1);
  for (std::size_t i = 0; i < column.size(); ++i) {
    strips.cell(i, cell);
    EXPECT_EQ(cell.empty(), i >= 50);
    EXPECT_NEAR(cell.area(), i < 50 ? 0.02 : 0, 1e-13);
  }
  EXPECT_NEAR(total_area(PeriodicVoronoi(std::vector<Vec2d>(1000, Vec2d{0.5, 0.5}), 1, 1)), 1, 1e-12);
}

TEST(PeriodicVoronoi, PointsCloserThanTheRoundingLoseNoMoreThanTheirCells) {
  auto points = white_noise(20, 9);
  for (std::size_t i = 0; i < 6; ++i) {
    const double angle = static_cast<double>(i);
    points.push_back({1e-30 * std::cos(angle) + 1e-29, 1e-30 * std::sin(angle) + 1e-29});
  }
  const PeriodicVoronoi voronoi(points, 1, 1);
  VoronoiCell cell;
  for (std::size_t i = 0; i < points.size(); ++i) {
    voronoi.cell(i, cell);
    for (std::size_t k = 0; k < cell.size(); ++k) EXPECT_TRUE(std::isfinite(cell.x[k]) && std::isfinite(cell.y[k]));
    if (i < 20) {
      EXPECT_GT(cell.area(), 0);
    }
  }
}

TEST(PeriodicVoronoi, OutsidePositionsAreWrapped) {
  const PeriodicVoronoi voronoi(std::vector<Vec2f>{{-0.5F, 1.5F}, {3.25F, -4.0F}, {3.0F, 2.0F}}, {3, 2});
  EXPECT_EQ(voronoi.position(0), (Vec2d{2.5, 1.5}));
  EXPECT_EQ(voronoi.position(1), (Vec2d{0.25, 0}));
  EXPECT_EQ(voronoi.position(2), (Vec2d{0, 0}));
  EXPECT_NEAR(total_area(voronoi), 6, 1e-12);
}

TEST(PeriodicVoronoi, WrongInputIsRefused) {
  const std::vector<Vec2f> bad{{std::numeric_limits<float>::quiet_NaN(), 0}};
  EXPECT_THROW(PeriodicVoronoi(bad, {1, 1}), ConfigError);
  EXPECT_THROW(PeriodicVoronoi(std::vector<Vec2f>{{0, 0}}, {0, 1}), ConfigError);
  EXPECT_EQ(PeriodicVoronoi(std::vector<Vec2f>{}, {1, 1}).size(), 0U);
}

}  // namespace
}  // namespace abn
