// What a relaxation does, on the engine to use.
#include "sampling/sph/solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

TEST(SphSolver, UniformForcesConserveMomentum) {
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

TEST(SphSolver, SquareLatticeIsAnEquilibrium) {
  std::vector<Vec2f> lattice;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) lattice.push_back({static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F});
  }
  for (const Kernel kernel : {Kernel::wendland, Kernel::poly6_spiky, Kernel::cubic}) {
    auto setup = setup_of({32, 32}, lattice);
    setup.kernel = kernel;
    const auto solver = make_cpu_solver_double(setup);
    const Evaluation state = solver->evaluate();
    for (std::size_t i = 0; i < lattice.size(); ++i) {
      EXPECT_NEAR(state.force_x[i], 0, 1e-13);
      EXPECT_NEAR(state.force_y[i], 0, 1e-13);
      EXPECT_NEAR(state.density[i], state.density[0], 1e-13);
    }
    const RelaxReport report = solver->relax(3, false);
    EXPECT_LT(report.max_displacement, 1e-11);
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.mean_converged_at, 1);
    EXPECT_EQ(report.every_converged_at, 1);
    EXPECT_EQ(report.still, 1);
  }
}

TEST(SphSolver, FrozenParticlesNeverMoveAndStayInTheSums) {
  for (const bool sized : {false, true}) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
      const auto positions = white_positions({30, 30}, 900);
      auto setup = setup_of({30, 30}, positions);
      setup.boundary = boundary;
      const auto solver = make_cpu_solver(setup);
      if (sized) solver->set_size_field(smooth_size_field({16, 16}, 2));
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
      EXPECT_LT(report.mean_displacement, 0.04);

      std::vector<std::uint32_t> all(900);
      for (std::uint32_t i = 0; i < 900; ++i) all[i] = i;
      // A new field makes a new ring; what is frozen stays frozen.
      const std::vector<Vec2f> between(solver->positions().begin(), solver->positions().end());
      solver->set_size_field(smooth_size_field({16, 16}, 2));
      solver->relax(2, false);
      for (std::uint32_t i = 0; i < 900; i += 3) {
        EXPECT_NEAR(solver->positions()[i].x, between[i].x, 1e-5);
        EXPECT_NEAR(solver->positions()[i].y, between[i].y, 1e-5);
      }
      solver->freeze(all);
      const RelaxReport still = solver->relax(2, true);
      EXPECT_EQ(still.max_displacement, 0);
      EXPECT_TRUE(still.converged);
      EXPECT_EQ(still.steps, 1);
    }
  }
}

TEST(SphSolver, StopsEarlyOnlyIfAsked) {
  const auto positions = white_positions({32, 32}, 1024);
  const auto setup = setup_of({32, 32}, positions);
  const RelaxReport early = make_cpu_solver(setup)->relax(200, true);
  EXPECT_TRUE(early.converged);
  EXPECT_GE(early.steps, 10);
  EXPECT_LE(early.steps, 40);  // 19 steps for N = 1024 in the trials
  EXPECT_LT(early.mean_displacement, 0.01);
  EXPECT_EQ(early.mean_converged_at, early.steps);
  const RelaxReport full = make_cpu_solver(setup)->relax(60, false);
  EXPECT_EQ(full.steps, 60);
  EXPECT_EQ(full.mean_converged_at, early.steps);
  EXPECT_EQ(make_cpu_solver(setup)->relax(0, true).steps, 0);
}

TEST(SphSolver, ReportsBothCriteria) {
  const auto positions = white_positions({32, 32}, 1024);
  auto setup = setup_of({32, 32}, positions);
  const RelaxReport full = make_cpu_solver(setup)->relax(300, false);
  ASSERT_GT(full.mean_converged_at, 0);
  EXPECT_GT(full.every_converged_at, full.mean_converged_at);  // an extreme value: later
  setup.criterion = Criterion::every;
  const RelaxReport every = make_cpu_solver(setup)->relax(300, true);
  EXPECT_TRUE(every.converged);
  EXPECT_EQ(every.steps, full.every_converged_at);
  EXPECT_EQ(every.every_converged_at, every.steps);
  EXPECT_EQ(every.mean_converged_at, full.mean_converged_at);
  EXPECT_LT(every.max_displacement, 0.01);
  EXPECT_EQ(every.still, 1);
  setup.criterion = Criterion::mean;
  const RelaxReport mean = make_cpu_solver(setup)->relax(300, true);
  EXPECT_EQ(mean.steps, full.mean_converged_at);
  EXPECT_EQ(mean.every_converged_at, -1);
  EXPECT_LT(mean.still, 1);
  EXPECT_GT(mean.still, 0.4);
  EXPECT_GE(mean.max_displacement, 0.01);
  const RelaxReport one = make_cpu_solver(setup)->relax(1, true);
  EXPECT_FALSE(one.converged);
  EXPECT_EQ(one.mean_converged_at, -1);
  EXPECT_NEAR(full.mean_density, 1, 0.05);
}

TEST(SphSolver, AdaptiveStepCalmsWhatAFixedOneDoesNot) {
  const auto positions = white_positions({40, 40}, 1600);
  // Stiff by Delta, which shortens the step from the start; by the support or by the step itself, which the motion
  // tells.
  struct Case {
    float stiffness_ratio, support_radius, step;
    bool reduces;
  };
  for (const Case& one : {Case{0.05F, 2, 1.2F, false}, {0.3F, 3, 1.2F, true}, {1, 2, 4, true}, {1, 4, 4, true}}) {
    auto setup = setup_of({40, 40}, positions);
    setup.stiffness_ratio = one.stiffness_ratio;
    setup.support_radius = one.support_radius;
    setup.step = one.step;
    setup.adaptive_step = false;
    const RelaxReport fixed = make_cpu_solver(setup)->relax(150, false);
    EXPECT_FALSE(fixed.converged);
    EXPECT_EQ(fixed.step_reductions, 0);
    EXPECT_EQ(fixed.step, double{one.step});
    EXPECT_GT(fixed.mean_displacement, 0.1);
    setup.adaptive_step = true;
    const RelaxReport adaptive = make_cpu_solver(setup)->relax(150, false);
    EXPECT_TRUE(adaptive.converged);
    EXPECT_LT(adaptive.mean_displacement, 0.003);
    EXPECT_LT(adaptive.step, fixed.step);
    EXPECT_EQ(adaptive.step_reductions > 0, one.reduces);
  }
}

TEST(SphSolver, DefaultStepIsNeverReduced) {
  for (const bool sized : {false, true}) {
    const auto positions =
        sized ? drawn_positions({40, 40}, smooth_size_field({40, 40}, 10), 3000) : white_positions({40, 40}, 3000);
    const auto solver = make_cpu_solver(setup_of({40, 40}, positions));
    if (sized) solver->set_size_field(smooth_size_field({40, 40}, 10));
    const RelaxReport report = solver->relax(60, false);
    EXPECT_EQ(report.step_reductions, 0);
    EXPECT_TRUE(report.converged);
  }
}

TEST(SphSolver, ConstantSizeFieldIsTheUniformPlane) {
  for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
    const auto positions = white_positions({25, 25}, 600);
    auto setup = setup_of({25, 25}, positions);
    setup.boundary = boundary;
    const auto uniform = make_cpu_solver(setup);
    const auto constant = make_cpu_solver(setup);
    constant->set_size_field(Grid<float>({7, 3}, 5.0F));
    uniform->relax(5, false);
    constant->relax(5, false);
    for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(uniform->positions()[i], constant->positions()[i]);
  }
}

TEST(SphSolver, SettlesForEveryKernel) {
  for (const Kernel kernel : {Kernel::wendland, Kernel::poly6_spiky, Kernel::cubic}) {
    const auto positions = white_positions({32, 32}, 1024);
    auto setup = setup_of({32, 32}, positions);
    setup.kernel = kernel;
    const auto solver = make_cpu_solver(setup);
    const RelaxReport report = solver->relax(60, true);
    EXPECT_TRUE(report.converged);
    const auto relaxed = solver->positions();
    double mean_nearest = 0;
    for (std::size_t i = 0; i < relaxed.size(); ++i) {
      double nearest = 1e9;
      for (std::size_t j = 0; j < relaxed.size(); ++j) {
        const double dx = std::remainder(double{relaxed[i].x} - double{relaxed[j].x}, 32.0);
        const double dy = std::remainder(double{relaxed[i].y} - double{relaxed[j].y}, 32.0);
        if (i != j) nearest = std::min(nearest, std::hypot(dx, dy));
      }
      mean_nearest += nearest / 1024;
    }
    mean_nearest /= std::sqrt(2 / std::sqrt(3.0));  // of the hexagonal lattice's
    RecordProperty("mean_nearest_" + std::to_string(static_cast<int>(kernel)), std::to_string(mean_nearest));
    EXPECT_GT(mean_nearest, 0.8);
  }
}

TEST(SphSolver, DropsAndCountsNonFiniteSteps) {
  const auto positions = white_positions({10, 10}, 200);
  auto setup = setup_of({10, 10}, positions);
  setup.stiffness_ratio = 1e-38F;  // pressures overflow a float
  setup.adaptive_step = false;
  const auto solver = make_cpu_solver(setup);
  const RelaxReport report = solver->relax(3, false);
  EXPECT_GT(report.non_finite, 0U);
  for (const Vec2f p : solver->positions()) {
    EXPECT_TRUE(p.x >= 0 && p.x < 10 && p.y >= 0 && p.y < 10);
  }
}

TEST(SphSolver, RefusesWrongSetups) {
  const std::vector<Vec2f> good = {{1, 1}, {2, 2}};
  EXPECT_THROW(make_cpu_solver(setup_of({0, 5}, good)), ConfigError);
  EXPECT_THROW(make_cpu_solver(setup_of({5, 5}, {})), ConfigError);
  for (const Vec2f bad : {Vec2f{5, 1}, Vec2f{-1, 1}, Vec2f{1, std::nanf("")}}) {
    const std::vector<Vec2f> positions = {good[0], bad};
    EXPECT_THROW(make_cpu_solver(setup_of({5, 5}, positions)), ConfigError);
  }
  const auto refuses = [&](auto change) {
    auto setup = setup_of({5, 5}, good);
    change(setup);
    for (const auto& make : {make_cpu_solver, make_cpu_solver_double, make_twin_solver}) {
      EXPECT_THROW(make(setup), ConfigError);
    }
  };
  const float nan = std::nanf("");
  refuses([](sph::Setup& s) { s.stiffness_ratio = 0; });
  refuses([&](sph::Setup& s) { s.stiffness_ratio = nan; });
  refuses([](sph::Setup& s) { s.support_radius = 0; });
  refuses([&](sph::Setup& s) { s.support_radius = nan; });
  refuses([](sph::Setup& s) { s.step = -1; });
  refuses([&](sph::Setup& s) { s.step = nan; });
  refuses([](sph::Setup& s) { s.damping = 1.5F; });
  refuses([](sph::Setup& s) { s.velocity_cap = 0; });
  refuses([](sph::Setup& s) { s.gradient_limit = 0; });
  const std::vector<std::uint8_t> one_class = {0};
  refuses([&](sph::Setup& s) { s.classes = one_class; });
  const std::vector<std::uint8_t> classes = {0, 1};
  refuses([&](sph::Setup& s) {
    s.classes = classes;
    s.boundary = Boundary::ghost;
  });
  auto setup = setup_of({5, 5}, good);
  setup.classes = classes;
  EXPECT_THROW(make_cpu_solver(setup)->set_size_field(smooth_size_field({4, 4}, 3)), ConfigError);
  EXPECT_NO_THROW(make_cpu_solver(setup)->set_size_field(Grid<float>({4, 4}, 3.0F)));
}

TEST(SphSolver, RefusedSizeFieldLeavesTheSolverAsItWas) {
  const auto positions = white_positions({10, 10}, 100);
  const auto solver = make_cpu_solver(setup_of({10, 10}, positions));
  solver->set_size_field(smooth_size_field({8, 8}, 3));
  const Evaluation before = solver->evaluate();
  EXPECT_THROW(solver->set_size_field(Grid<float>({3, 3}, 0.0F)), ConfigError);
  EXPECT_EQ(solver->evaluate().density, before.density);
}

}  // namespace
}  // namespace abn::sph
