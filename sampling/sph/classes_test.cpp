// Several classes on one plane: blue alone and together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "sampling/rng.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

constexpr Extent plane{64, 64};

/// Distances relative to that of the hexagonal lattice of as many points, and power relative to white noise.
struct Quality {
  double radius = 0;        // the smallest nearest-neighbour distance
  double mean_nearest = 0;  // the mean one; white noise .465
  double low_power = 0;     // mean over 1/8 to 1/2 of sqrt(N) waves per side
};

Quality quality_of(const std::vector<Vec2f>& points) {
  const auto n = static_cast<double>(points.size());
  const double lattice = plane.width * std::sqrt(2 / (std::sqrt(3.0) * n));
  Quality quality;
  quality.radius = 1e9;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = 1e9;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double dx = std::remainder(double{points[i].x} - double{points[j].x}, double{plane.width});
      const double dy = std::remainder(double{points[i].y} - double{points[j].y}, double{plane.height});
      if (i != j) nearest = std::min(nearest, dx * dx + dy * dy);
    }
    quality.radius = std::min(quality.radius, std::sqrt(nearest) / lattice);
    quality.mean_nearest += std::sqrt(nearest) / lattice / n;
  }
  const auto limit = static_cast<int>(std::sqrt(n) / 2);
  int waves = 0;
  for (int v = 0; v <= limit; v += 2) {
    for (int u = -limit; u <= limit; u += 2) {
      const double length = std::hypot(u, v);
      if (length < std::sqrt(n) / 8 || length > std::sqrt(n) / 2) continue;
      std::complex<double> sum;
      for (const Vec2f p : points) {
        sum += std::polar(1.0, 2 * std::numbers::pi * (u * double{p.x} / plane.width + v * double{p.y} / plane.height));
      }
      quality.low_power += std::norm(sum) / n;
      ++waves;
    }
  }
  quality.low_power /= waves;
  return quality;
}

TEST(SphClasses, AreBlueAloneAndTogether) {
  constexpr std::size_t n = 4096;
  constexpr std::uint8_t count = 4;
  const auto positions = drawn_positions(plane, Grid<float>({1, 1}, 1.0F), n);
  std::vector<std::uint8_t> labels;  // independent of the positions
  for (std::size_t i = 0; i < n; ++i) labels.push_back(static_cast<std::uint8_t>(Rng(1, 2, i).below(count)));
  auto setup = setup_of(plane, positions);
  setup.classes = labels;
  const auto solver = make_cpu_solver(setup);
  const RelaxReport report = solver->relax(100, true);  // labels without order take longer than one class
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(report.mean_density, 1, 0.08);
  RecordProperty("steps", report.steps);
  RecordProperty("step_reductions", report.step_reductions);
  const auto relaxed = solver->positions();
  const auto record = [](const std::string& name, const Quality& quality) {
    RecordProperty(name, std::to_string(quality.radius) + " radius, nearest " + std::to_string(quality.mean_nearest) +
                             ", low power " + std::to_string(quality.low_power));
  };
  const Quality together = quality_of({relaxed.begin(), relaxed.end()});
  record("together", together);
  EXPECT_GT(together.radius, 0.3);
  EXPECT_GT(together.mean_nearest, 0.74);
  EXPECT_LT(together.low_power, 0.05);
  for (std::uint8_t label = 0; label < count; ++label) {
    std::vector<Vec2f> own;
    for (std::size_t i = 0; i < n; ++i) {
      if (labels[i] == label) own.push_back(relaxed[i]);
    }
    const Quality alone = quality_of(own);
    record("class_" + std::to_string(label), alone);
    EXPECT_GT(alone.radius, 0.4);
    EXPECT_GT(alone.mean_nearest, 0.79);
    EXPECT_LT(alone.low_power, 0.03);
  }
  // Without classes the labels are white: a quarter of a blue set is no blue set.
  const auto plain = make_cpu_solver(setup_of(plane, positions));
  plain->relax(40, false);
  std::vector<Vec2f> quarter;
  for (std::size_t i = 0; i < n; ++i) {
    if (labels[i] == 0) quarter.push_back(plain->positions()[i]);
  }
  const Quality white = quality_of(quarter);
  record("quarter_of_a_plain_set", white);
  EXPECT_LT(white.mean_nearest, 0.65);
  EXPECT_GT(white.low_power, 0.4);
}

TEST(SphClasses, OneClassIsThePlainPlane) {
  const auto positions = white_positions({20, 20}, 400);
  const std::vector<std::uint8_t> labels(400, 0);
  auto setup = setup_of({20, 20}, positions);
  const Evaluation plain = make_cpu_solver_double(setup)->evaluate();
  setup.classes = labels;
  const Evaluation classed = make_cpu_solver_double(setup)->evaluate();
  double ratio = 0;  // of the forces: a choice of weights
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_NEAR(classed.density[i], plain.density[i], 1e-13);
    if (ratio == 0) ratio = classed.force_x[i] / plain.force_x[i];
    EXPECT_NEAR(classed.force_x[i], ratio * plain.force_x[i], 1e-9);
    EXPECT_NEAR(classed.force_y[i], ratio * plain.force_y[i], 1e-9);
  }
  EXPECT_GE(ratio, 0.99);
}

}  // namespace
}  // namespace abn::sph
