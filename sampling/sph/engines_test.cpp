// Every engine against the twin, the twin against the equations written out once more, and the engines against each
// other bit for bit.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "sampling/sph/problem.h"
#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_engines.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

/// What the equations say, by loops over all pairs and images, and the largest sum of magnitudes of force terms: the
/// scale of rounding errors, because the terms cancel.
struct Expected {
  Evaluation state;
  double term_sum = 0.1;  // at least the size of one pair's force
};

/// W without its constant and -(dW/dr)/r with int g(q) q^3 dq = 1/140, written out.
double shape_by_hand(Kernel kernel, double q) {
  if (q >= 1) return 0;
  if (kernel == Kernel::wendland) return std::pow(1 - q, 4) * (1 + 4 * q);
  if (kernel == Kernel::poly6_spiky) return std::pow(1 - q * q, 3);
  return q < 0.5 ? 1 - 6 * q * q + 6 * q * q * q : 2 * std::pow(1 - q, 3);
}
double gradient_by_hand(Kernel kernel, double q) {
  if (q >= 1) return 0;
  if (kernel == Kernel::wendland) return std::pow(1 - q, 3);
  if (kernel == Kernel::poly6_spiky) return 3.0 / 14 * std::pow(1 - q, 2) / std::max(q, 1e-3);
  return q < 0.5 ? 2.0 / 49 * (12 - 18 * q) : 2.0 / 49 * 6 * std::pow(1 - q, 2) / q;
}

/// Eqs. 2.15 to 2.19 as the header files state them. The size field and the background force are read from the tables.
Expected by_hand(const Plane& plane) {
  auto setup = plane.setup;
  setup.classes = plane.classes;
  const Problem problem = make_problem(setup, plane.positions, plane.size.size().area() > 0 ? &plane.size : nullptr);
  const std::size_t n = problem.count();
  const double length_x = problem.field.length_x;
  const double length_y = problem.field.length_y;
  const Kernel kernel = setup.kernel;
  std::vector<FieldSample<double>> field(n);
  for (std::size_t i = 0; i < n && !problem.field.uniform; ++i) {
    field[i] = sample_field(problem.field.view<double>(), wrap(problem.x[i], length_x), wrap(problem.y[i], length_y));
  }
  int classes = 1;
  for (const std::uint8_t label : plane.classes) classes = std::max(classes, label + 1);
  const double support = double{setup.support_radius};
  const double supports[] = {support, support * std::sqrt(classes)};
  const double numerator = kernel == Kernel::wendland ? 7 : kernel == Kernel::poly6_spiky ? 4 : 40.0 / 7;

  // f(j, dx, dy, spacing of the pair) for all images that could interact
  const auto for_each_image = [&](std::size_t i, const auto& f) {
    for (std::size_t j = 0; j < n; ++j) {
      const double pair = 0.5 * (field[i].size + field[j].size);
      const double reach = supports[1] * pair;
      const auto across = static_cast<int>(std::ceil(reach / length_x)) + 1;
      const auto down = static_cast<int>(std::ceil(reach / length_y)) + 1;
      for (int v = -down; v <= down; ++v) {
        for (int u = -across; u <= across; ++u) {
          const double dx = problem.x[i] - problem.x[j] + u * length_x;
          const double dy = problem.y[i] - problem.y[j] + v * length_y;
          if (dx * dx + dy * dy < reach * reach) f(j, dx, dy, pair);
        }
      }
    }
  };
  std::vector<double> densities[2] = {std::vector<double>(n, 0), std::vector<double>(n, 0)};
  double means[2] = {0, 0};
  for (std::size_t i = 0; i < n; ++i) {
    for_each_image(i, [&](std::size_t j, double dx, double dy, double pair) {
      const double r = std::hypot(dx, dy) / pair;
      const double constant = numerator / (std::numbers::pi * support * support);
      densities[0][i] += constant * shape_by_hand(kernel, r / supports[0]);
      const bool same = plane.classes.empty() || plane.classes[i] == plane.classes[j];
      if (same) densities[1][i] += constant * shape_by_hand(kernel, r / supports[1]);
    });
    for (const int k : {0, 1}) {
      if (i < problem.particles) means[k] += densities[k][i] / static_cast<double>(problem.particles);
    }
  }
  const auto pressure_at = [&](int k, std::size_t i) {
    return 1 + (densities[k][i] - means[k]) / (double{setup.stiffness_ratio} * means[k]);
  };
  Expected expected;
  for (std::size_t i = 0; i < problem.particles; ++i) {
    double force_x = 0;
    double force_y = 0;
    double term_sum = 0;
    for_each_image(i, [&](std::size_t j, double dx, double dy, double pair) {
      const double r = std::hypot(dx, dy);
      double weight = 0.5 * (pressure_at(0, i) + pressure_at(0, j)) * gradient_by_hand(kernel, r / pair / supports[0]);
      if (!plane.classes.empty()) {
        const double own = 0.5 * (pressure_at(1, i) + pressure_at(1, j));
        const bool same = plane.classes[i] == plane.classes[j];
        weight = class_share * (weight + (same ? own * gradient_by_hand(kernel, r / pair / supports[1]) : 0));
      }
      if (r == 0 && i != j) {
        coincident_offset(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), dx, dy);
      }
      force_x += weight * dx / pair;
      force_y += weight * dy / pair;
      term_sum += std::abs(weight) * r / pair;
    });
    expected.state.density.push_back(densities[0][i]);
    expected.state.force_x.push_back(force_x - field[i].pull_x);
    expected.state.force_y.push_back(force_y - field[i].pull_y);
    expected.term_sum = std::max(expected.term_sum, term_sum);
  }
  return expected;
}

/// Relative error of the density, and that of the force relative to the largest sum of its terms.
struct Errors {
  double density = 0, force = 0;
};
Errors errors_of(const Evaluation& got, const Evaluation& expected, double term_sum) {
  EXPECT_EQ(got.density.size(), expected.density.size());
  Errors errors;
  for (std::size_t i = 0; i < got.density.size(); ++i) {
    EXPECT_TRUE(std::isfinite(got.density[i] + got.force_x[i] + got.force_y[i]));
    errors.density = std::max(errors.density, std::abs(got.density[i] / expected.density[i] - 1));
    errors.force = std::max({errors.force, std::abs(got.force_x[i] - expected.force_x[i]) / term_sum,
                             std::abs(got.force_y[i] - expected.force_y[i]) / term_sum});
  }
  return errors;
}

/// 1e-5, and on a long plane or beside a small s more: a float coordinate is rounded in proportion to the longest side,
/// and the kernel's slope grows with 1 / (H s).
double float_tolerance(const Plane& plane) {
  auto setup = plane.setup;
  setup.classes = plane.classes;
  setup.background = false;
  const Problem problem = make_problem(setup, plane.positions, plane.size.size().area() > 0 ? &plane.size : nullptr);
  const double longest = std::max(problem.field.length_x, problem.field.length_y);
  const double least = plane.setup.kernel == Kernel::poly6_spiky ? 2e-5 : 1e-5;  // its force is steep at r = 0
  return least * std::max(1.0, longest / (16 * problem.support * problem.field.smallest));
}

/// The equations written out are slow: for every field with the Wendland kernel, for the other kernels with a few.
bool worth_by_hand(const Plane& plane) {
  return plane.setup.kernel == Kernel::wendland || plane.size.size().area() == 0 ||
         plane.name.find("step") != std::string::npos;
}

void compare_with_twin(const std::vector<Plane>& planes, Errors& worst_double, Errors& worst_float) {
  for (const Plane& plane : planes) {
    const Evaluation twin = start(plane, make_twin_solver)->evaluate();
    const Evaluation in_double = start(plane, make_cpu_solver_double)->evaluate();
    const Evaluation in_float = start(plane, make_cpu_solver)->evaluate();
    double term_sum = 1;
    if (worth_by_hand(plane)) {
      const Expected expected = by_hand(plane);
      const Errors errors = errors_of(twin, expected.state, expected.term_sum);
      EXPECT_LE(errors.density, 1e-12) << "twin " << plane.name;
      EXPECT_LE(errors.force, 1e-12) << "twin " << plane.name;
      term_sum = expected.term_sum;
    }
    const Errors of_double = errors_of(in_double, twin, term_sum);
    const Errors of_float = errors_of(in_float, twin, term_sum);
    EXPECT_LE(of_double.density, 1e-12) << plane.name;
    EXPECT_LE(of_double.force, 1e-12) << plane.name;
    const double tolerance = float_tolerance(plane);
    EXPECT_LE(of_float.density, tolerance) << plane.name;
    EXPECT_LE(of_float.force, tolerance) << plane.name;
    worst_double = {std::max(worst_double.density, of_double.density), std::max(worst_double.force, of_double.force)};
    worst_float = {std::max(worst_float.density, of_float.density), std::max(worst_float.force, of_float.force)};
  }
}

TEST(SphEngines, EqualTheTwinAndTheTwinTheEquations) {
  Errors in_double, in_float;
  compare_with_twin(all_planes(130), in_double, in_float);
  RecordProperty("double_density", std::to_string(in_double.density * 1e15) + "e-15");
  RecordProperty("double_force", std::to_string(in_double.force * 1e15) + "e-15");
  RecordProperty("float_density", std::to_string(in_float.density * 1e6) + "e-6");
  RecordProperty("float_force", std::to_string(in_float.force * 1e6) + "e-6");
}

TEST(SphEngines, EqualTheTwinWhereParticlesMeetTheirOwnImages) {
  Errors in_double, in_float;
  compare_with_twin(odd_planes(), in_double, in_float);
  RecordProperty("float_density", std::to_string(in_float.density * 1e6) + "e-6");
  RecordProperty("float_force", std::to_string(in_float.force * 1e6) + "e-6");
}

TEST(SphEngines, InstructionSetsAreBitIdentical) {
  std::vector<Plane> planes = all_planes(130);
  const std::vector<Plane> odd = odd_planes();
  planes.insert(planes.end(), odd.begin(), odd.end());
  for (const Plane& plane : planes) {
    const Outcome cpu = outcome(plane, make_cpu_solver, 6);
    expect_same(cpu, outcome(plane, make_cpu_solver_baseline, 6), plane.name + " baseline");
  }
}

TEST(SphEngines, AreBitIdenticalForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  std::vector<Plane> planes = {make_plane({100, 61}, 9500, "", Kernel::wendland, Boundary::periodic),
                               make_plane({100, 61}, 9500, "step", Kernel::wendland, Boundary::periodic),
                               make_plane({100, 61}, 9500, "smooth", Kernel::poly6_spiky, Boundary::ghost),
                               make_plane({100, 61}, 9500, "", Kernel::wendland, Boundary::periodic)};
  for (std::size_t i = 0; i < 9500; ++i) planes.back().classes.push_back(static_cast<std::uint8_t>(i % 3));
  planes.back().name += " classes 3";
  for (const Plane& plane : planes) {
    omp_set_num_threads(1);
    const Outcome alone = outcome(plane, make_cpu_solver, 5);
    for (const int count : {2, 3, 4}) {
      omp_set_num_threads(count);
      expect_same(alone, outcome(plane, make_cpu_solver, 5), plane.name + " threads " + std::to_string(count));
    }
    omp_set_num_threads(threads);
  }
}

TEST(SphEngines, DoubleFollowsTheTwinThroughSeveralSteps) {
  for (const char* field : {"", "smooth", "step"}) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
      const Plane plane = make_plane({20, 17}, 150, field, Kernel::wendland, boundary);
      const Outcome fast = outcome(plane, make_cpu_solver_double, 5);
      const Outcome slow = outcome(plane, make_twin_solver, 5);
      for (std::size_t i = 0; i < 150; ++i) {
        ASSERT_NEAR(fast.positions[i].x, slow.positions[i].x, 1e-5) << plane.name;
        ASSERT_NEAR(fast.positions[i].y, slow.positions[i].y, 1e-5) << plane.name;
      }
      EXPECT_NEAR(fast.report.mean_displacement, slow.report.mean_displacement, 1e-9) << plane.name;
      EXPECT_NEAR(fast.report.mean_density, slow.report.mean_density, 1e-9) << plane.name;
    }
  }
}

TEST(SphEngines, ThesisCellsMissNeighboursOnlyBesideASizeField) {
  for (const char* field : {"", "smooth"}) {
    Plane plane = make_plane({20, 17}, 300, field, Kernel::wendland, Boundary::periodic);
    const Evaluation right = start(plane, make_twin_solver)->evaluate();
    plane.setup.thesis_cells = true;
    const Evaluation wrong = start(plane, make_twin_solver)->evaluate();
    double missing = 0;
    for (std::size_t i = 0; i < 300; ++i) missing = std::max(missing, 1 - wrong.density[i] / right.density[i]);
    if (*field == '\0') {
      EXPECT_EQ(missing, 0);
    } else {
      EXPECT_GT(missing, 0.2);
    }
  }
}

TEST(SphEngines, NameTheirBackend) {
  const std::vector<Vec2f> one = {{1, 1}};
  const std::string best = make_cpu_solver(setup_of({5, 5}, one))->backend();
  EXPECT_TRUE(best == "cpu avx2" || best == "cpu") << best;
  EXPECT_STREQ(make_cpu_solver_baseline(setup_of({5, 5}, one))->backend(), "cpu");
  EXPECT_STREQ(make_cpu_solver_double(setup_of({5, 5}, one))->backend(), "cpu double");
  EXPECT_STREQ(make_twin_solver(setup_of({5, 5}, one))->backend(), "twin");
}

TEST(SphEngines, StartWithASizeFieldIsAsIfItWereSet) {
  for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
    Plane plane = make_plane({40, 30}, 1500, "smooth", Kernel::wendland, boundary);
    const auto set = start(plane, make_cpu_solver);
    plane.setup.positions = plane.positions;
    plane.setup.size_field = &plane.size;
    const auto given = make_cpu_solver(plane.setup);
    EXPECT_EQ(std::vector<Vec2f>(set->ghosts().begin(), set->ghosts().end()),
              std::vector<Vec2f>(given->ghosts().begin(), given->ghosts().end()));
    // Positions that were set had been rounded once more.
    const Evaluation a = set->evaluate();
    const Evaluation b = given->evaluate();
    for (std::size_t i = 0; i < a.density.size(); ++i) ASSERT_NEAR(a.density[i], b.density[i], 1e-3 * a.density[i]);
  }
}

}  // namespace
}  // namespace abn::sph
