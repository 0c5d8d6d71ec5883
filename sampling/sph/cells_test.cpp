#include "sampling/sph/cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "sampling/rng.h"
#include "sampling/sph/problem.h"
#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

/// An image of a particle: (id, tile column, tile row); tile (0,0) is the particle itself.
using ParticleImage = std::tuple<std::uint32_t, int, int>;

/// Particles of a torus sorted into given cells, as an engine does it.
template <class Real>
struct Sorted {
  Cells<Real> cells;
  std::vector<std::uint32_t> start, id;
  std::vector<Real> x, y;  // sorted [d]

  Sorted(Cells<Real> grid, const std::vector<Vec2f>& unit) : cells(std::move(grid)) {
    const CellView<Real> view = cells.view();
    std::vector<Real> px, py;
    std::vector<std::uint32_t> cell, ids(unit.size());
    std::iota(ids.begin(), ids.end(), 0U);
    for (const Vec2f u : unit) {
      px.push_back(wrap(static_cast<Real>(u.x) * view.length_x, view.length_x));
      py.push_back(wrap(static_cast<Real>(u.y) * view.length_y, view.length_y));
      cell.push_back(view.cell(px.back(), py.back()));
    }
    CellSort().sort(cell, ids, cells.size(), 1, id, start);  // the order is that of the ids
    for (const std::uint32_t i : id) {
      x.push_back(px[i]);
      y.push_back(py[i]);
    }
  }

  /// The images met for a rectangle, in order.
  std::vector<ParticleImage> met(Real x0, Real x1, Real y0, Real y1) const {
    std::vector<ParticleImage> images;
    for_each_run(cells.view(), start.data(), x0, x1, y0, y1, [&](const Run& run) {
      for (std::uint32_t j = run.begin; j < run.end; ++j) images.emplace_back(id[j], run.image_x, run.image_y);
    });
    return images;
  }
  /// The images inside a rectangle, by looking at all.
  std::vector<ParticleImage> inside(Real x0, Real x1, Real y0, Real y1) const {
    const Real length_x = cells.view().length_x;
    const Real length_y = cells.view().length_y;
    std::vector<ParticleImage> images;
    for (std::size_t j = 0; j < id.size(); ++j) {
      for (int v = static_cast<int>(std::floor(y0 / length_y)) - 1; static_cast<Real>(v) * length_y <= y1; ++v) {
        for (int u = static_cast<int>(std::floor(x0 / length_x)) - 1; static_cast<Real>(u) * length_x <= x1; ++u) {
          const Real at_x = x[j] + static_cast<Real>(u) * length_x;
          const Real at_y = y[j] + static_cast<Real>(v) * length_y;
          if (at_x >= x0 && at_x <= x1 && at_y >= y0 && at_y <= y1) images.emplace_back(id[j], u, v);
        }
      }
    }
    return images;
  }
};

struct Torus {
  double width, height;
  std::uint64_t n;
  std::string name() const { return std::to_string(width) + "x" + std::to_string(height) + " N " + std::to_string(n); }
};
const Torus tori[] = {{20, 20, 1},    {20, 20, 2},      {20, 20, 7},    {20, 20, 400}, {37, 53, 2000}, {0.05, 140, 7},
                      {0.022, 45, 1}, {0.5, 1000, 500}, {140, 0.05, 7}, {16, 16, 300}, {100, 3, 300},  {5, 5, 25}};

/// Queries all over a torus, also far outside it, and checks what they meet.
template <class Real>
void expect_exact(const Sorted<Real>& sorted, Real radius, const std::string& where) {
  const CellView<Real> view = sorted.cells.view();
  for (std::uint64_t query = 0; query < 12; ++query) {
    Rng rng(5, stream_id("queries"), query);
    const Real x = static_cast<Real>(rng.uniform() * 1.2F - 0.1F) * view.length_x;
    const Real y = static_cast<Real>(rng.uniform() * 1.2F - 0.1F) * view.length_y;
    const Real wide = radius * static_cast<Real>(0.2F + rng.uniform());
    const Real high = radius * static_cast<Real>(0.2F + rng.uniform());
    const Real slack = view.rounding(radius);
    std::vector<ParticleImage> met = sorted.met(x - wide - slack, x + wide + slack, y - high - slack, y + high + slack);
    const std::vector<ParticleImage> larger =
        sorted.met(x - 2 * wide, x + wide + slack, y - high - slack, y + 3 * high);
    std::map<ParticleImage, int> times;
    std::map<ParticleImage, std::size_t> place;
    for (const ParticleImage& image : met) ++times[image];
    for (std::size_t k = 0; k < larger.size(); ++k) place[larger[k]] = k;
    for (const auto& entry : times) ASSERT_EQ(entry.second, 1) << "met more than once: " << where;
    for (const ParticleImage& image : sorted.inside(x - wide, x + wide, y - high, y + high)) {
      ASSERT_EQ(times.count(image), 1U) << "missed particle " << std::get<0>(image) << ": " << where;
    }
    // A wider rectangle meets them too, and in the same order.
    std::size_t last = 0;
    for (const ParticleImage& image : met) {
      const auto found = place.find(image);
      ASSERT_TRUE(found != place.end()) << "missed by the wider rectangle: " << where;
      ASSERT_GE(found->second, last) << "another order: " << where;
      last = found->second;
    }
  }
}

template <class Real>
void expect_exact_on_all_tori() {
  for (const Torus& torus : tori) {
    std::vector<Vec2f> unit;
    for (std::uint64_t i = 0; i < torus.n; ++i) unit.push_back(Rng(11, stream_id("cells"), i).uniform2());
    for (const double support : {0.6, 2.0, 3.3}) {
      expect_exact(Sorted<Real>(Cells<Real>(torus.width, torus.height, support), unit), static_cast<Real>(support),
                   torus.name() + " one tile");
      for (const double tile_length : {2.5, 7.0}) {
        const std::int32_t tiles_x = std::min(Cells<Real>::tile_count(torus.width, tile_length), 40);
        const std::int32_t tiles_y = std::min(Cells<Real>::tile_count(torus.height, tile_length), 40);
        std::vector<double> density;  // tiles of very different fineness side by side
        for (std::int32_t t = 0; t < tiles_x * tiles_y; ++t) {
          density.push_back(std::pow(100.0, double{Rng(2, 3, static_cast<std::uint64_t>(t)).uniform()} - 0.5));
        }
        expect_exact(Sorted<Real>(Cells<Real>(torus.width, torus.height, support, tiles_x, tiles_y, density), unit),
                     static_cast<Real>(support), torus.name() + " tiles of " + std::to_string(tile_length));
      }
    }
  }
}

TEST(SphCells, MeetEveryImageInsideARectangleExactlyOnceAndInOneOrder) {
  expect_exact_on_all_tori<float>();
  expect_exact_on_all_tori<double>();
}

TEST(SphCells, AreExactOnLatticesWhereDistancesMeetCellBorders) {
  // All coordinates and many distances fall on cell borders: the worst case for rounding.
  std::vector<Vec2f> unit;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) unit.push_back({static_cast<float>(x) / 40, static_cast<float>(y) / 40});
  }
  for (const double support : {1.0, 2.0, 2.5}) {
    const Sorted<float> sorted(Cells<float>(40, 40, support), unit);
    for (std::size_t i = 0; i < unit.size(); i += 7) {
      const float radius = 2.0F + 0x1p-20F + sorted.cells.view().rounding(2.0F);  // just beyond two spacings
      const float x = sorted.x[i];
      const float y = sorted.y[i];
      std::vector<ParticleImage> met = sorted.met(x - radius, x + radius, y - radius, y + radius);
      std::sort(met.begin(), met.end());
      ASSERT_TRUE(std::adjacent_find(met.begin(), met.end()) == met.end());
      const std::vector<ParticleImage> inside = sorted.inside(x - radius, x + radius, y - radius, y + radius);
      ASSERT_EQ(inside.size(), 25U);
      for (const ParticleImage& image : inside) ASSERT_TRUE(std::binary_search(met.begin(), met.end(), image));
    }
  }
}

TEST(SphCells, AreAboutAsManyAsParticles) {
  for (const auto& [width, height, n] :
       {std::tuple{200U, 200U, 240000U}, {1U, 2000U, 7U}, {2000U, 1U, 7U}, {1U, 1U, 1U}}) {
    for (const double support : {0.5, 2.0, 8.0}) {
      const double d = std::sqrt(static_cast<double>(width) * height / n);
      const Cells<float> cells(width / d, height / d, support);
      EXPECT_LE(cells.size(), 2 * n + 2U) << width << "x" << height << " H " << support;
      EXPECT_GE(cells.size(), 1U);
    }
  }
  for (const SizeFieldCase& field : size_field_cases()) {
    const std::vector<Vec2f> positions = white_positions({100, 80}, 20000);
    auto setup = setup_of({100, 80}, positions);
    setup.background = false;
    const Grid<float> s = make_size_field(field.name, {256, 256});
    const Problem problem = make_problem(setup, positions, &s);
    const std::size_t cells = cells_for<float>(problem).size();
    EXPECT_LE(cells, 40000U) << field.name;
    EXPECT_GE(cells, 2000U) << field.name;
    RecordProperty("cells_per_particle_" + field.name, std::to_string(static_cast<double>(cells) / 20000));
  }
}

TEST(SphCellSort, SortsByCellAndIdForAnyNumberOfParts) {
  // Some cells hold hundreds: they are sorted by another method.
  std::vector<std::uint32_t> cell, id;
  for (std::uint32_t i = 0; i < 6000; ++i) {
    cell.push_back(Rng(3, 1, i).below(10) == 0 ? 5 : Rng(3, 2, i).below(997));
    id.push_back(i * 2741U % 6007U);  // distinct, out of order
  }
  std::vector<std::uint32_t> expected(cell.size());
  std::iota(expected.begin(), expected.end(), 0U);
  std::stable_sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(cell[a], id[a]) < std::tie(cell[b], id[b]);
  });
  CellSort sort;  // used again: nothing may be left over
  for (const int parts : {1, 2, 3, 4, 1}) {
    std::vector<std::uint32_t> order, start;
    sort.sort(cell, id, 997, parts, order, start);
    EXPECT_EQ(order, expected) << parts << " parts";
    ASSERT_EQ(start.size(), 998U);
    EXPECT_EQ(start[997], 6000U);
    for (std::uint32_t c = 0; c < 997; ++c) {
      for (std::size_t k = start[c]; k < start[c + 1]; ++k) ASSERT_EQ(cell[order[k]], c);
    }
  }
}

}  // namespace
}  // namespace abn::sph
