// Walls and the ring of ghost particles behind them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "sampling/sph/problem.h"
#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

/// s small at all walls (dense) and large in the middle, or the other way round.
Grid<float> dense_at_the_walls(Extent size, double ratio) { return smooth_size_field(size, ratio); }
Grid<float> sparse_at_the_walls(Extent size, double ratio) {
  Grid<float> s = smooth_size_field(size, ratio);
  for (float& value : s.cells()) value = 1 / value;
  return s;
}

sph::Setup walled(Extent plane, const std::vector<Vec2f>& positions) {
  auto setup = setup_of(plane, positions);
  setup.boundary = Boundary::ghost;
  return setup;
}

/// Walls at distance 0, in local spacings: the density relative to the aim in [0,.5) [.5,1) [1,2), and inside of 3.
struct WallBands {
  std::array<double, 4> count{}, expected{};
  double density(std::size_t band) const { return count[band] / expected[band]; }
  double within_one_spacing() const { return (count[0] + count[1]) / (expected[0] + expected[1]); }
};

void add_bands(const SizeField& field, Extent plane, std::span<const Vec2f> positions, WallBands& bands) {
  const double d = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(positions.size()));
  const auto size_at = [&](double x, double y) {  // [px]
    return field.uniform ? 1.0 : sample_field(field.view<double>(), x / d, y / d).size;
  };
  const auto band_of = [&](double x, double y) -> int {
    const double depth = std::min({x, y, plane.width - x, plane.height - y}) / d / size_at(x, y);
    return depth < 0.5 ? 0 : depth < 1 ? 1 : depth < 2 ? 2 : depth < 3 ? -1 : 3;
  };
  for (const Vec2f p : positions) {
    const int band = band_of(double{p.x}, double{p.y});
    if (band >= 0) ++bands.count[static_cast<std::size_t>(band)];
  }
  constexpr int steps = 1200;
  const double mass = static_cast<double>(positions.size()) / (double{steps} * steps);
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      // Shifted by another amount in every row and column, so that narrow bands are resolved.
      const double shift_x = 0.6180339887498949 * j;
      const double shift_y = 0.6180339887498949 * i;
      const double x = (i + shift_x - std::floor(shift_x)) / steps * plane.width;
      const double y = (j + shift_y - std::floor(shift_y)) / steps * plane.height;
      const int band = band_of(x, y);
      if (band >= 0) bands.expected[static_cast<std::size_t>(band)] += mass * std::pow(size_at(x, y), -2);
    }
  }
}

TEST(SphGhosts, DensityAtTheWallsIsThatInside) {
  const Extent plane{64, 64};
  struct Case {
    const char* name;
    Grid<float> size;
    double tolerance;  // of a single band
  };
  const Case cases[] = {{"uniform", Grid<float>({64, 64}, 1.0F), 0.12},
                        {"dense_at_the_walls", dense_at_the_walls({64, 64}, 5), 0.12},
                        {"sparse_at_the_walls", sparse_at_the_walls({64, 64}, 3), 0.15}};
  for (const Case& one : cases) {
    WallBands bands;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto positions = drawn_positions(plane, one.size, 5000, seed);
      auto setup = walled(plane, positions);
      setup.seed = seed;
      const auto solver = make_cpu_solver(setup);
      solver->set_size_field(one.size);
      const RelaxReport report = solver->relax(40, false);
      EXPECT_TRUE(report.converged) << one.name;
      for (const Vec2f p : solver->positions()) {
        ASSERT_TRUE(p.x >= 0 && p.x < 64 && p.y >= 0 && p.y < 64) << one.name;
      }
      setup.background = false;
      add_bands(make_problem(setup, positions, &one.size).field, plane, solver->positions(), bands);
    }
    RecordProperty(one.name, std::to_string(bands.density(0)) + " " + std::to_string(bands.density(1)) + " " +
                                 std::to_string(bands.density(2)) + " inside " + std::to_string(bands.density(3)));
    const double relative = bands.within_one_spacing() / bands.density(3);
    EXPECT_GE(relative, 0.97) << one.name;
    EXPECT_LE(relative, 1.03) << one.name;
    for (const std::size_t band : {0U, 1U, 2U}) {
      EXPECT_NEAR(bands.density(band) / bands.density(3), 1, one.tolerance) << one.name << " band " << band;
    }
  }
}

TEST(SphGhosts, NoParticleSeesPastTheRing) {
  const Extent plane{30, 24};
  std::vector<std::string> words = {"step:100", "smooth:100"};
  for (const SizeFieldCase& field : size_field_cases()) words.push_back(field.name);
  for (const std::string& word : words) {
    for (const float support : {1.0F, 2.0F, 3.0F}) {
      const Grid<float> s = make_size_field(word, {32, 32});
      auto positions = drawn_positions(plane, s, 500);
      const auto more = white_positions(plane, 200);  // also where a particle is unlikely
      std::copy(more.begin(), more.end(), positions.begin());
      auto setup = walled(plane, positions);
      setup.support_radius = support;
      setup.background = false;
      const Problem problem = make_problem(setup, positions, &s);
      const SizeField& field = problem.field;
      std::vector<double> size;
      for (std::size_t i = 0; i < problem.count(); ++i) {
        size.push_back(field.uniform ? 1 : sample_field(field.view<double>(), problem.x[i], problem.y[i]).size);
      }
      const auto unwrapped = [](double at, double inside, double length) {
        return at < inside + 0.5 * (length - inside) ? at : at - length;
      };
      std::size_t past = 0;
      for (std::size_t i = 0; i < problem.particles; ++i) {
        for (std::size_t j = 0; j < problem.count(); ++j) {
          const double x = unwrapped(problem.x[j], problem.plane_x, field.length_x);
          const double y = unwrapped(problem.y[j], problem.plane_y, field.length_y);
          const double reach = problem.support * 0.5 * (size[i] + size[j]);
          for (int v = -1; v <= 1; ++v) {
            for (int u = -1; u <= 1; ++u) {
              if (u == 0 && v == 0) continue;
              const double dx = problem.x[i] - x + u * field.length_x;
              const double dy = problem.y[i] - y + v * field.length_y;
              past += dx * dx + dy * dy < reach * reach ? 1 : 0;
            }
          }
        }
      }
      EXPECT_EQ(past, 0U) << word << " H " << support;
    }
  }
}

TEST(SphGhosts, RingHasTheDensityOfTheField) {
  const Extent plane{60, 48};
  const Grid<float> fields[] = {Grid<float>({32, 32}, 1.0F), dense_at_the_walls({32, 32}, 5),
                                sparse_at_the_walls({32, 32}, 3), make_size_field("ramp", {32, 32})};
  for (const Grid<float>& s : fields) {
    const auto positions = drawn_positions(plane, s, 3000);
    const auto setup = walled(plane, positions);
    const Problem problem = make_problem(setup, positions, &s);
    const SizeField& field = problem.field;
    // By column of the torus' quarter: left and right of the plane, above and below it.
    std::array<double, 2> expected{};
    std::array<double, 2> found{};
    constexpr int steps = 1000;
    const auto side = [&](double x) -> std::size_t { return x < problem.plane_x ? 0 : 1; };
    for (int j = 0; j < steps; ++j) {
      for (int i = 0; i < steps; ++i) {
        const double x = (i + 0.5) / steps * field.length_x;
        const double y = (j + 0.5) / steps * field.length_y;
        if (x < problem.plane_x && y < problem.plane_y) continue;
        const double size = field.uniform ? 1 : sample_field(field.view<double>(), x, y).size;
        expected[side(x)] += field.length_x * field.length_y / (double{steps} * steps * size * size);
      }
    }
    for (std::size_t i = problem.particles; i < problem.count(); ++i) {
      ASSERT_FALSE(problem.x[i] < problem.plane_x && problem.y[i] < problem.plane_y) << "a ghost inside the plane";
      ASSERT_TRUE(problem.x[i] >= 0 && problem.x[i] <= field.length_x && problem.y[i] >= 0 &&
                  problem.y[i] <= field.length_y);
      ++found[side(problem.x[i])];
    }
    for (const std::size_t k : {0U, 1U}) {
      EXPECT_NEAR(found[k] / expected[k], 1, 0.03);
      RecordProperty("ring_" + std::to_string(&s - fields) + "_" + std::to_string(k),
                     std::to_string(found[k] / expected[k]));
    }
  }
}

TEST(SphGhosts, LieAroundThePlaneAndStay) {
  const Extent plane{40, 25};
  const auto positions = white_positions(plane, 1000);
  const auto solver = make_cpu_solver(walled(plane, positions));
  const std::vector<Vec2f> before(solver->ghosts().begin(), solver->ghosts().end());
  ASSERT_GT(before.size(), 300U);
  bool left = false, right = false, above = false, below = false;
  for (const Vec2f g : before) {
    EXPECT_FALSE(g.x >= 0 && g.x < 40 && g.y >= 0 && g.y < 25);
    EXPECT_TRUE(g.x > -4 && g.x < 44 && g.y > -4 && g.y < 29) << g.x << " " << g.y;
    left = left || g.x < 0;
    right = right || g.x >= 40;
    above = above || g.y < 0;
    below = below || g.y >= 25;
  }
  EXPECT_TRUE(left && right && above && below);
  solver->relax(5, false);
  const std::vector<Vec2f> after(solver->ghosts().begin(), solver->ghosts().end());
  EXPECT_EQ(before, after);
  EXPECT_TRUE(make_cpu_solver(setup_of(plane, positions))->ghosts().empty());
  auto other = walled(plane, positions);
  other.seed = 2;
  const auto reseeded = make_cpu_solver(other);
  EXPECT_NE(std::vector<Vec2f>(reseeded->ghosts().begin(), reseeded->ghosts().end()), before);
}

}  // namespace
}  // namespace abn::sph
