#include "sampling/sph/cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "sampling/sph/brute_force.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

/// Particles of a plane sorted into cells, as an engine does it.
template <class Real>
struct Sorted {
  CellGrid<Real> grid;
  std::vector<std::uint32_t> start, id;
  std::vector<Real> x, y;

  Sorted(Extent plane, const std::vector<Vec2f>& positions, Real height, int parts = 1) {
    const double d = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(positions.size()));
    grid = CellGrid<Real>(static_cast<Real>(plane.width / d), static_cast<Real>(plane.height / d), height);
    std::vector<Real> px, py;
    std::vector<std::uint32_t> cell;
    for (const Vec2f p : positions) {
      px.push_back(wrap(static_cast<Real>(p.x / d), grid.length_x));
      py.push_back(wrap(static_cast<Real>(p.y / d), grid.length_y));
      cell.push_back(grid.cell(px.back(), py.back()));
    }
    CellSort().sort(cell, grid.size(), parts, start);
    x.resize(px.size());
    y.resize(px.size());
    id.resize(px.size());
    for (std::size_t i = 0; i < cell.size(); ++i) {
      x[cell[i]] = px[i];
      y[cell[i]] = py[i];
      id[cell[i]] = static_cast<std::uint32_t>(i);
    }
  }

  /// What the cells find within `radius` of sorted particle i; fails the test if an image is met twice.
  std::vector<ParticleImage> neighbours(std::size_t i, Real radius) const {
    std::multiset<ParticleImage> met;
    std::vector<ParticleImage> found;
    const Real reach = radius + grid.rounding(radius);
    for_each_run(grid, start.data(), x[i] - reach, x[i] + reach, y[i] - reach, y[i] + reach,
                 [&](std::size_t begin, std::size_t end, Real shift_x, Real shift_y) {
                   for (std::size_t j = begin; j < end; ++j) {
                     const ParticleImage image{id[j], static_cast<int>(std::lround(shift_x / grid.length_x)),
                                               static_cast<int>(std::lround(shift_y / grid.length_y))};
                     met.insert(image);
                     const Real dx = x[i] - shift_x - x[j];
                     const Real dy = y[i] - shift_y - y[j];
                     if (kernel_distance(dx * dx + dy * dy, 1 / radius) < 1) found.push_back(image);
                   }
                 });
    const std::set<ParticleImage> once(met.begin(), met.end());
    EXPECT_EQ(once.size(), met.size()) << "an image was met twice";
    std::sort(found.begin(), found.end());
    return found;
  }
};

TEST(CellGrid, HasNoMoreCellsThanParticles) {
  for (const auto& [width, height, n] :
       {std::tuple{200U, 200U, 240000U}, {1U, 2000U, 7U}, {2000U, 1U, 7U}, {1U, 1U, 1U}}) {
    for (const float support : {0.5F, 2.0F, 8.0F}) {
      const double d = std::sqrt(static_cast<double>(width) * height / n);
      const CellGrid<float> grid(static_cast<float>(width / d), static_cast<float>(height / d), support);
      EXPECT_LE(grid.size(), n + 1U) << width << "x" << height << " H " << support;
      EXPECT_GE(grid.size(), 1U);
    }
  }
}

TEST(CellSort, IsStableForAnyNumberOfParts) {
  std::vector<std::uint32_t> cell;
  for (std::uint32_t i = 0; i < 5000; ++i) cell.push_back(Rng(3, 1, i).below(97));
  for (const int parts : {1, 2, 3, 8}) {
    std::vector<std::uint32_t> place = cell;
    std::vector<std::uint32_t> start;
    CellSort().sort(place, 97, parts, start);
    std::vector<std::uint32_t> order(cell.size());
    for (std::uint32_t i = 0; i < place.size(); ++i) order[place[i]] = i;
    for (std::size_t k = 1; k < order.size(); ++k) {
      ASSERT_TRUE(std::tie(cell[order[k - 1]], order[k - 1]) < std::tie(cell[order[k]], order[k]));
    }
    ASSERT_EQ(start.size(), 98U);
    EXPECT_EQ(start[97], 5000U);
    for (std::uint32_t c = 0; c < 97; ++c) {
      for (std::size_t k = start[c]; k < start[c + 1]; ++k) ASSERT_EQ(cell[order[k]], c);
    }
  }
}

TEST(Cells, FindEveryImageWithinTheSupportExactlyOnce) {
  const std::tuple<Extent, std::uint64_t> planes[] = {
      {{20, 20}, 1},    {{20, 20}, 2},   {{20, 20}, 7},    {{20, 20}, 30},    {{17, 23}, 300},
      {{1, 2000}, 1},   {{1, 2000}, 7},  {{1, 2000}, 500}, {{2000, 1}, 40},   {{2000, 3}, 3000},
      {{3, 2000}, 900}, {{16, 16}, 256}, {{5, 5}, 400},    {{64, 2}, 64 * 2}, {{100, 100}, 100}};
  for (const auto& [plane, n] : planes) {
    for (const float support : {0.6F, 2.0F, 3.3F}) {
      const auto positions = white_positions(plane, n, 11);
      sph::Setup setup;
      setup.plane = plane;
      setup.positions = positions;
      setup.support_radius = support;
      const BruteForce twin(setup);
      const Sorted<double> sorted(plane, positions, support);
      for (std::size_t i = 0; i < n; i += 1 + n / 100) {
        ASSERT_EQ(sorted.neighbours(i, support), twin.neighbours(sorted.id[i]))
            << plane.width << "x" << plane.height << " N " << n << " H " << support << " particle " << sorted.id[i];
      }
    }
  }
}

TEST(Cells, AreExactOnLatticesWhereDistancesMeetCellBorders) {
  // All coordinates and many distances fall on cell borders: the worst case for rounding.
  std::vector<Vec2f> positions;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) positions.push_back({static_cast<float>(x), static_cast<float>(y)});
  }
  sph::Setup setup;
  setup.plane = {40, 40};
  setup.positions = positions;
  setup.support_radius = 2.0F + 0x1p-20F;  // just beyond two spacings
  const BruteForce twin(setup);
  for (const double height : {1.0, 2.0, 2.5}) {
    const Sorted<double> in_double(setup.plane, positions, height);
    const Sorted<float> in_float(setup.plane, positions, static_cast<float>(height));
    for (std::size_t i = 0; i < positions.size(); i += 7) {
      ASSERT_EQ(in_double.neighbours(i, setup.support_radius), twin.neighbours(in_double.id[i]));
      ASSERT_EQ(in_float.neighbours(i, setup.support_radius), twin.neighbours(in_float.id[i]));
    }
  }
  EXPECT_EQ(twin.neighbours(0).size(), 13U);
}

}  // namespace
}  // namespace abn::sph
