// Hard cases: whatever the field, the start, the number of particles and the plane, no position is ever not finite or
// outside, and what has not settled is reported so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/sph/draw.h"
#include "sampling/sph/problem.h"
#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

void expect_sound(Solver& solver, const RelaxReport& report, Extent plane, const std::string& where) {
  EXPECT_EQ(report.non_finite, 0U) << where;
  EXPECT_TRUE(std::isfinite(report.mean_displacement) && std::isfinite(report.mean_density)) << where;
  EXPECT_LE(report.max_displacement, 0.3 * (1 + 1e-6)) << where;
  EXPECT_LE(report.mean_displacement, report.max_displacement * (1 + 1e-6)) << where;
  EXPECT_TRUE(report.still >= 0 && report.still <= 1) << where;
  EXPECT_EQ(report.converged, report.mean_displacement < 0.01) << where;
  for (const Vec2f p : solver.positions()) {
    ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width)) << where << " x " << p.x;
    ASSERT_TRUE(p.y >= 0 && p.y < static_cast<float>(plane.height)) << where << " y " << p.y;
  }
}

std::vector<std::string> words() {
  std::vector<std::string> all = {"step:100", "smooth:100", "ring:1000", "random:100"};
  for (const SizeFieldCase& field : size_field_cases()) all.push_back(field.name);
  return all;
}

TEST(SphStability, EveryFieldOnEveryPlane) {
  struct Case {
    Extent plane;
    std::uint64_t n;
  };
  const Case cases[] = {{{20, 20}, 500}, {{20, 20}, 1},    {{20, 20}, 2},    {{20, 20}, 7}, {{1, 2000}, 1},
                        {{1, 2000}, 7},  {{1, 2000}, 200}, {{2000, 1}, 100}, {{1, 1}, 100}};
  for (const auto& [plane, n] : cases) {
    const auto positions = white_positions(plane, n, 5);
    for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
      // A ring on a thin plane takes long to prepare: fewer fields.
      const std::vector<std::string> few = {"step:100", "spikes", "ramp"};
      for (const std::string& word : boundary == Boundary::ghost ? few : words()) {
        auto setup = setup_of(plane, positions);
        setup.boundary = boundary;
        const auto solver = make_cpu_solver(setup);
        solver->set_size_field(make_size_field(word, {16, 16}));
        const std::string where = word + (boundary == Boundary::ghost ? " ghost " : " ") + std::to_string(plane.width) +
                                  "x" + std::to_string(plane.height) + " N " + std::to_string(n);
        expect_sound(*solver, solver->relax(5, false), plane, where);
      }
    }
  }
}

TEST(SphStability, HardFieldsSettleFromTheirDensity) {
  const Extent plane{60, 60};
  for (const std::string& word : words()) {
    const Grid<float> s = make_size_field(word, {64, 64});
    // From the field as the engine prepares it: its gradient is limited, so that a spike holds more than its own cell.
    const std::vector<Vec2f> anywhere(4000, Vec2f{0, 0});
    auto setup = setup_of(plane, anywhere);
    setup.background = false;
    const Problem problem = make_problem(setup, anywhere, &s);
    const SizeField& field = problem.field;
    const auto density = [&](double u, double v) {
      if (field.uniform) return 1.0;
      return std::pow(sample_field(field.view<double>(), u * field.length_x, v * field.length_y).size, -2);
    };
    std::vector<Vec2f> positions;
    for (const UnitPosition p : draw_by_density(density, 1, 4000, 1)) {
      positions.push_back(to_plane({static_cast<float>(p.x), static_cast<float>(p.y)}, plane));
    }
    const auto solver = make_cpu_solver(setup_of(plane, positions));
    solver->set_size_field(s);
    const RelaxReport report = solver->relax(40, false);
    expect_sound(*solver, report, plane, word);
    RecordProperty(word, std::to_string(report.mean_displacement) + " mean displacement, still " +
                             std::to_string(report.still) + ", at " + std::to_string(report.mean_converged_at));
    EXPECT_LT(report.mean_displacement, word == "ring:1000" ? 0.2 : 0.06) << word;
  }
}

TEST(SphStability, SizeFieldsThatAreNoneAreRefused) {
  const auto positions = white_positions({20, 20}, 100);
  for (const auto& make : {make_cpu_solver, make_cpu_solver_double, make_twin_solver}) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
      auto setup = setup_of({20, 20}, positions);
      setup.boundary = boundary;
      const auto solver = make(setup);
      for (const float bad : {0.0F, -1.0F, std::nanf(""), std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity()}) {
        Grid<float> s({5, 4}, 1.0F);
        s.at(4, 3) = bad;
        EXPECT_THROW(solver->set_size_field(s), ConfigError) << bad;
      }
      EXPECT_THROW(solver->set_size_field(Grid<float>()), ConfigError);
    }
  }
}

TEST(SphStability, CoincidentParticlesSeparate) {
  const Extent plane{10, 10};
  const std::vector<Vec2f> all_at_one_place(120, Vec2f{3.25F, 7.5F});
  for (const char* word : {"", "smooth:3", "step:100", "spikes"}) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
      for (const auto& make : {make_cpu_solver, make_cpu_solver_double}) {
        auto setup = setup_of(plane, all_at_one_place);
        setup.boundary = boundary;
        const auto solver = make(setup);
        if (*word != '\0') solver->set_size_field(make_size_field(word, {8, 8}));
        const RelaxReport report = solver->relax(60, false);
        expect_sound(*solver, report, plane, std::string("coincident ") + word);
        const auto relaxed = solver->positions();
        double nearest = 1e9;
        for (std::size_t i = 0; i < relaxed.size(); ++i) {
          for (std::size_t j = 0; j < i; ++j) {
            nearest = std::min<double>(nearest, std::hypot(relaxed[i].x - relaxed[j].x, relaxed[i].y - relaxed[j].y));
          }
        }
        EXPECT_GT(nearest, *word == '\0' || std::string(word) == "smooth:3" ? 0.02 : 1e-4) << word;
      }
    }
  }
}

TEST(SphStability, ManyAtOnePlaceAmongMany) {
  // A thousand in one cell: no quadratic sort, no missed pair.
  const Extent plane{50, 50};
  auto positions = white_positions(plane, 10000);
  for (std::size_t i = 0; i < 1000; ++i) positions[i * 10] = {25, 25};
  const auto solver = make_cpu_solver(setup_of(plane, positions));
  const RelaxReport report = solver->relax(10, false);
  expect_sound(*solver, report, plane, "crowd");
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.mean_converged_at, -1);
}

TEST(SphStability, AMillionParticles) {
  const Extent plane{400, 400};
  const auto positions = drawn_positions(plane, smooth_size_field({200, 200}, 10), 1000000);
  for (const bool sized : {false, true}) {
    const auto solver = make_cpu_solver(setup_of(plane, positions));
    if (sized) solver->set_size_field(smooth_size_field({200, 200}, 10));
    const RelaxReport report = solver->relax(sized ? 2 : 1, false);
    expect_sound(*solver, report, plane, sized ? "sized" : "uniform");
    EXPECT_FALSE(report.converged);
  }
}

}  // namespace
}  // namespace abn::sph
