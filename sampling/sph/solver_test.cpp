#include "sampling/sph/solver.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <string>

#include "sampling/error.h"
#include "sampling/sph/brute_force.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

sph::Setup setup_of(Extent plane, const std::vector<Vec2f>& positions) {
  sph::Setup setup;
  setup.plane = plane;
  setup.positions = positions;
  return setup;
}

/// 1e-5, and on a long plane more: a float coordinate is rounded in proportion to the longest side, and the kernel's
/// slope grows with 1/H.
double float_tolerance(const sph::Setup& setup) {
  const double spacing =
      std::sqrt(static_cast<double>(setup.plane.area()) / static_cast<double>(setup.positions.size()));
  const double longest = std::max(setup.plane.width, setup.plane.height) / spacing;
  return 1e-5 * std::max(1.0, longest / (16 * setup.support_radius));
}

/// Density relative to itself; force relative to the largest sum of magnitudes of its terms, because they cancel.
void expect_equal(const Evaluation& got, const BruteForce& twin, double tolerance, const std::string& where) {
  double scale = 0;
  const Evaluation expected = twin.evaluate(&scale);
  scale = std::max(scale, 0.1);  // no neighbours at all: the size of one pair's force
  ASSERT_EQ(got.density.size(), expected.density.size());
  double density_error = 0;
  double force_error = 0;
  for (std::size_t i = 0; i < got.density.size(); ++i) {
    density_error = std::max(density_error, std::abs(got.density[i] / expected.density[i] - 1));
    force_error = std::max({force_error, std::abs(got.force_x[i] - expected.force_x[i]) / scale,
                            std::abs(got.force_y[i] - expected.force_y[i]) / scale});
    ASSERT_TRUE(std::isfinite(got.force_x[i] + got.force_y[i])) << where;
  }
  EXPECT_LE(density_error, tolerance) << where;
  EXPECT_LE(force_error, tolerance) << where;
}

void expect_inside_and_finite(std::span<const Vec2f> positions, Extent plane, const std::string& where) {
  for (const Vec2f p : positions) {
    ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width)) << where << " x " << p.x;
    ASSERT_TRUE(p.y >= 0 && p.y < static_cast<float>(plane.height)) << where << " y " << p.y;
  }
}

struct Case {
  const char* name;
  Extent plane;
  std::uint64_t n;
};
const Case cases[] = {{"square", {20, 20}, 500}, {"wide", {60, 7}, 400},       {"one", {20, 20}, 1},
                      {"two", {20, 20}, 2},      {"seven", {20, 20}, 7},       {"thin 1", {1, 2000}, 1},
                      {"thin 7", {1, 2000}, 7},  {"thin 200", {1, 2000}, 200}, {"flat", {2000, 1}, 100},
                      {"one pixel", {1, 1}, 100}};

TEST(Solver, UniformDensityAndForceEqualBruteForce) {
  for (const auto& [name, plane, n] : cases) {
    const auto positions = white_positions(plane, n);
    for (const float support : {0.7F, 2.0F, 3.0F}) {
      auto setup = setup_of(plane, positions);
      setup.support_radius = support;
      const BruteForce expected(setup);
      expect_equal(make_cpu_solver_double(setup)->evaluate(), expected, 1e-12, name);
      expect_equal(make_cpu_solver(setup)->evaluate(), expected, float_tolerance(setup), name);
    }
  }
}

TEST(Solver, SizeFieldDensityAndForceEqualBruteForce) {
  for (const auto& [name, plane, n] : cases) {
    for (const bool jump : {false, true}) {
      const Grid<float> size = jump ? jump_size_field({8, 8}, 100.0F) : smooth_size_field({16, 16}, 10);
      for (const bool dense : {false, true}) {
        const auto positions = dense ? positions_by_size(plane, size, n) : white_positions(plane, n);
        const auto setup = setup_of(plane, positions);
        const BruteForce expected(setup, &size);
        const std::string where = std::string(name) + (jump ? " jump" : " smooth") + (dense ? " dense" : " white");
        const auto in_double = make_cpu_solver_double(setup);
        in_double->set_size_field(size);
        expect_equal(in_double->evaluate(), expected, 1e-12, where);
        const auto in_float = make_cpu_solver(setup);
        in_float->set_size_field(size);
        expect_equal(in_float->evaluate(), expected, float_tolerance(setup), where);
      }
    }
  }
}

TEST(Solver, CoincidentParticlesEqualBruteForceAndSeparate) {
  auto positions = white_positions({10, 10}, 100);
  for (std::size_t i = 0; i < 20; ++i) positions[50 + i] = positions[i / 4];
  const auto setup = setup_of({10, 10}, positions);
  expect_equal(make_cpu_solver_double(setup)->evaluate(), BruteForce(setup), 1e-12, "coincident");

  const std::vector<Vec2f> all_at_one_place(120, Vec2f{3.25F, 7.5F});
  for (const bool sized : {false, true}) {
    for (const auto& make : {make_cpu_solver, make_cpu_solver_double}) {
      const auto solver = make(setup_of({10, 10}, all_at_one_place));
      if (sized) solver->set_size_field(smooth_size_field({5, 5}, 3));
      const RelaxReport report = solver->relax(60, false);
      EXPECT_EQ(report.non_finite, 0U);
      const auto relaxed = solver->positions();
      expect_inside_and_finite(relaxed, {10, 10}, "coincident");
      double nearest = 1e9;
      for (std::size_t i = 0; i < relaxed.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          nearest = std::min<double>(nearest, std::hypot(relaxed[i].x - relaxed[j].x, relaxed[i].y - relaxed[j].y));
        }
      }
      EXPECT_GT(nearest, 0.02) << (sized ? "sized" : "uniform");
    }
  }
}

TEST(Solver, UniformForcesConserveMomentum) {
  const auto positions = white_positions({50, 40}, 3000);
  const auto setup = setup_of({50, 40}, positions);
  for (const auto& [make, tolerance] : {std::pair{&make_cpu_solver, 1e-6}, {&make_cpu_solver_double, 1e-14}}) {
    const Evaluation state = make(setup)->evaluate();
    double x = 0, y = 0, sum = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      x += state.force_x[i];
      y += state.force_y[i];
      sum += std::hypot(state.force_x[i], state.force_y[i]);
    }
    EXPECT_LE(std::hypot(x, y) / sum, tolerance);
  }
}

TEST(Solver, SquareLatticeIsAnEquilibrium) {
  std::vector<Vec2f> lattice;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) lattice.push_back({static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F});
  }
  const auto solver = make_cpu_solver_double(setup_of({32, 32}, lattice));
  const Evaluation state = solver->evaluate();
  for (std::size_t i = 0; i < lattice.size(); ++i) {
    EXPECT_NEAR(state.force_x[i], 0, 1e-13);
    EXPECT_NEAR(state.force_y[i], 0, 1e-13);
    EXPECT_NEAR(state.density[i], state.density[0], 1e-13);
  }
  const RelaxReport report = solver->relax(3, false);
  EXPECT_LT(report.max_displacement, 1e-11);
  EXPECT_TRUE(report.converged);
}

TEST(Solver, IsBitIdenticalForAnyNumberOfThreads) {
  const Extent plane{100, 61};
  const auto positions = white_positions(plane, 9000);
  const int threads = omp_get_max_threads();
  for (const bool sized : {false, true}) {
    std::vector<std::vector<Vec2f>> results;
    std::vector<RelaxReport> reports;
    for (const int count : {1, 2, 5}) {
      omp_set_num_threads(count);
      const auto solver = make_cpu_solver(setup_of(plane, positions));
      if (sized) solver->set_size_field(smooth_size_field({20, 20}, 4));
      reports.push_back(solver->relax(6, false));
      results.emplace_back(solver->positions().begin(), solver->positions().end());
    }
    omp_set_num_threads(threads);
    for (std::size_t k = 1; k < results.size(); ++k) {
      EXPECT_EQ(results[k], results[0]);
      EXPECT_EQ(reports[k].mean_displacement, reports[0].mean_displacement);
      EXPECT_EQ(reports[k].max_displacement, reports[0].max_displacement);
      EXPECT_EQ(reports[k].mean_density, reports[0].mean_density);
    }
  }
}

TEST(Solver, EvaluateDoesNotChangeTheCourse) {
  const auto positions = white_positions({30, 30}, 500);
  const auto plain = make_cpu_solver(setup_of({30, 30}, positions));
  const auto watched = make_cpu_solver(setup_of({30, 30}, positions));
  plain->relax(10, false);
  for (int step = 0; step < 10; ++step) {
    watched->evaluate();
    watched->relax(1, false);
  }
  for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(plain->positions()[i], watched->positions()[i]);
}

TEST(Solver, FloatAndDoubleAgreeAfterOneStep) {
  const Extent plane{40, 40};
  const auto positions = white_positions(plane, 4000);
  const auto in_float = make_cpu_solver(setup_of(plane, positions));
  const auto in_double = make_cpu_solver_double(setup_of(plane, positions));
  in_float->relax(1, false);
  in_double->relax(1, false);
  const double spacing = std::sqrt(1600.0 / 4000.0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    double dx = in_float->positions()[i].x - in_double->positions()[i].x;
    double dy = in_float->positions()[i].y - in_double->positions()[i].y;
    dx -= 40 * std::round(dx / 40);
    dy -= 40 * std::round(dy / 40);
    ASSERT_LT(std::hypot(dx, dy) / spacing, 5e-5);
  }
}

TEST(Solver, FrozenParticlesStayAndStillPush) {
  const Extent plane{30, 30};
  const auto positions = white_positions(plane, 900);
  const auto solver = make_cpu_solver(setup_of(plane, positions));
  solver->relax(3, false);  // so that they have a velocity to lose
  const std::vector<Vec2f> before(solver->positions().begin(), solver->positions().end());
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = 0; i < 900; i += 3) ids.push_back(i);
  solver->freeze(ids);
  solver->freeze(ids);  // again: no effect
  const RelaxReport report = solver->relax(25, false);
  const auto after = solver->positions();
  std::size_t moved = 0;
  for (std::uint32_t i = 0; i < 900; ++i) {
    if (i % 3 == 0) {
      EXPECT_EQ(after[i], before[i]) << "frozen " << i;
    } else {
      moved += after[i] == before[i] ? 0 : 1;
    }
  }
  EXPECT_GT(moved, 590U);
  EXPECT_GT(report.mean_displacement, 0);
  EXPECT_LT(report.mean_displacement, 0.02);

  std::vector<std::uint32_t> all(900);
  for (std::uint32_t i = 0; i < 900; ++i) all[i] = i;
  solver->freeze(all);
  const RelaxReport still = solver->relax(2, true);
  EXPECT_EQ(still.max_displacement, 0);
  EXPECT_TRUE(still.converged);
  EXPECT_EQ(still.steps, 1);
}

TEST(Solver, StopsEarlyOnlyIfAsked) {
  const auto positions = white_positions({32, 32}, 1024);
  const auto setup = setup_of({32, 32}, positions);
  const RelaxReport early = make_cpu_solver(setup)->relax(200, true);
  EXPECT_TRUE(early.converged);
  EXPECT_GE(early.steps, 10);
  EXPECT_LE(early.steps, 40);  // 19 steps for N = 1024 in numerics.md
  EXPECT_LT(early.mean_displacement, 0.01);
  const RelaxReport full = make_cpu_solver(setup)->relax(60, false);
  EXPECT_EQ(full.steps, 60);
  EXPECT_EQ(make_cpu_solver(setup)->relax(0, true).steps, 0);
}

TEST(Solver, ConstantSizeFieldIsTheUniformPlane) {
  const auto positions = white_positions({25, 25}, 600);
  const auto uniform = make_cpu_solver(setup_of({25, 25}, positions));
  const auto constant = make_cpu_solver(setup_of({25, 25}, positions));
  constant->set_size_field(Grid<float>({7, 3}, 5.0F));
  uniform->relax(5, false);
  constant->relax(5, false);
  for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(uniform->positions()[i], constant->positions()[i]);
}

TEST(Solver, HardCasesStayFiniteAndInside) {
  for (const auto& [name, plane, n] : cases) {
    for (const int field : {0, 1, 2}) {
      const auto positions = white_positions(plane, n, 5);
      const auto solver = make_cpu_solver(setup_of(plane, positions));
      if (field == 1) solver->set_size_field(smooth_size_field({16, 16}, 10));
      if (field == 2) solver->set_size_field(jump_size_field({2, 2}, 100.0F));
      const RelaxReport report = solver->relax(10, false);
      EXPECT_EQ(report.non_finite, 0U) << name << " field " << field;
      EXPECT_TRUE(std::isfinite(report.mean_displacement) && std::isfinite(report.mean_density)) << name;
      EXPECT_LE(report.max_displacement, 0.3 * (1 + 1e-6)) << name;
      expect_inside_and_finite(solver->positions(), plane, name);
    }
  }
}

TEST(Solver, DropsAndCountsNonFiniteSteps) {
  const auto positions = white_positions({10, 10}, 200);
  auto setup = setup_of({10, 10}, positions);
  setup.stiffness_ratio = 1e-38F;  // pressures overflow a float
  const auto solver = make_cpu_solver(setup);
  const RelaxReport report = solver->relax(3, false);
  EXPECT_GT(report.non_finite, 0U);
  expect_inside_and_finite(solver->positions(), {10, 10}, "overflow");
}

TEST(Solver, RefusesWrongSetups) {
  const std::vector<Vec2f> good = {{1, 1}, {2, 2}};
  EXPECT_THROW(make_cpu_solver(setup_of({0, 5}, good)), ConfigError);
  EXPECT_THROW(make_cpu_solver(setup_of({5, 5}, {})), ConfigError);
  for (const Vec2f bad : {Vec2f{5, 1}, Vec2f{-1, 1}, Vec2f{1, std::nanf("")}}) {
    const std::vector<Vec2f> positions = {good[0], bad};
    EXPECT_THROW(make_cpu_solver(setup_of({5, 5}, positions)), ConfigError);
  }
  auto setup = setup_of({5, 5}, good);
  setup.stiffness_ratio = 0;
  EXPECT_THROW(make_cpu_solver_double(setup), ConfigError);
}

TEST(Solver, NamesItsBackend) {
  const std::vector<Vec2f> one = {{1, 1}};
  EXPECT_STREQ(make_cpu_solver(setup_of({5, 5}, one))->backend(), "cpu");
  EXPECT_STREQ(make_cpu_solver_double(setup_of({5, 5}, one))->backend(), "cpu double");
}

}  // namespace
}  // namespace abn::sph
