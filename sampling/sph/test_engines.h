// Planes on which the tests compare engines, and what must be equal.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {

/// One plane to compare engines on.
struct Plane {
  std::string name;
  sph::Setup setup;
  std::vector<Vec2f> positions;
  std::vector<std::uint8_t> classes;
  Grid<float> size;  // empty = uniform
};

inline const char* name_of(Kernel kernel) {
  return kernel == Kernel::wendland ? "wendland" : kernel == Kernel::cubic ? "cubic" : "poly6_spiky";
}

/// "" = no field. Half of the particles start by the field's density, half anywhere, a few at one place.
inline Plane make_plane(Extent extent, std::uint64_t n, const std::string& field, Kernel kernel, Boundary boundary) {
  Plane plane;
  plane.name = std::to_string(extent.width) + "x" + std::to_string(extent.height) + " N " + std::to_string(n) + " " +
               field + " " + name_of(kernel) + (boundary == Boundary::ghost ? " ghost" : "");
  plane.positions = white_positions(extent, n);
  if (!field.empty()) {
    plane.size = make_size_field(field, boundary == Boundary::ghost ? Extent{16, 16} : Extent{32, 32});
    const std::vector<Vec2f> drawn = drawn_positions(extent, plane.size, n / 2);
    std::copy(drawn.begin(), drawn.end(), plane.positions.begin());
  }
  for (std::uint64_t k = 0; k < n / 100; ++k) plane.positions[n - 1 - k] = plane.positions[n / 2 + k / 3];
  plane.setup.plane = extent;
  plane.setup.kernel = kernel;
  plane.setup.boundary = boundary;
  return plane;
}

inline std::unique_ptr<Solver> start(const Plane& plane, const SolverFactory& make) {
  auto setup = plane.setup;
  setup.positions = plane.positions;
  setup.classes = plane.classes;
  auto solver = make(setup);
  if (plane.size.size().area() > 0) solver->set_size_field(plane.size);
  return solver;
}

inline std::vector<Plane> all_planes(std::uint64_t n) {
  std::vector<Plane> planes;
  for (const Kernel kernel : {Kernel::wendland, Kernel::poly6_spiky, Kernel::cubic}) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
      planes.push_back(make_plane({20, 17}, n, "", kernel, boundary));
      for (const SizeFieldCase& field : size_field_cases()) {
        planes.push_back(make_plane({20, 17}, n, field.name, kernel, boundary));
      }
      planes.push_back(make_plane({20, 17}, n, "step:100", kernel, boundary));
    }
    for (const int classes : {2, 4}) {
      Plane plane = make_plane({20, 17}, n, "", kernel, Boundary::periodic);
      plane.name += " classes " + std::to_string(classes);
      for (std::uint64_t i = 0; i < n; ++i) plane.classes.push_back(static_cast<std::uint8_t>(i % 7 % classes));
      planes.push_back(plane);
    }
  }
  return planes;
}

/// Tori on which particles meet their own images, and very long ones.
inline std::vector<Plane> odd_planes() {
  std::vector<Plane> planes;
  const std::pair<Extent, std::uint64_t> shapes[] = {{{60, 7}, 400},   {{20, 20}, 1},    {{20, 20}, 2},
                                                     {{20, 20}, 7},    {{1, 2000}, 1},   {{1, 2000}, 7},
                                                     {{1, 2000}, 200}, {{2000, 1}, 100}, {{1, 1}, 100}};
  for (const auto& [extent, n] : shapes) {
    for (const char* field : {"", "smooth", "step:100"}) {
      for (const float support : {0.7F, 2.0F, 3.0F}) {
        planes.push_back(make_plane(extent, n, field, Kernel::wendland, Boundary::periodic));
        planes.back().setup.support_radius = support;
        planes.back().name += " H " + std::to_string(support);
      }
    }
  }
  return planes;
}

/// Everything that must not differ in a single bit after some steps.
struct Outcome {
  RelaxReport report;
  std::vector<Vec2f> positions;
  Evaluation state;
};
inline Outcome outcome(const Plane& plane, const SolverFactory& make, int steps) {
  const auto solver = start(plane, make);
  Outcome result;
  result.report = solver->relax(steps, false);
  const auto positions = solver->positions();
  result.positions.assign(positions.begin(), positions.end());
  result.state = solver->evaluate();
  return result;
}
inline void expect_same(const Outcome& a, const Outcome& b, const std::string& where) {
  EXPECT_EQ(a.positions, b.positions) << where;
  EXPECT_EQ(a.state.density, b.state.density) << where;
  EXPECT_EQ(a.state.force_x, b.state.force_x) << where;
  EXPECT_EQ(a.state.force_y, b.state.force_y) << where;
  EXPECT_EQ(a.report.mean_displacement, b.report.mean_displacement) << where;
  EXPECT_EQ(a.report.max_displacement, b.report.max_displacement) << where;
  EXPECT_EQ(a.report.mean_density, b.report.mean_density) << where;
  EXPECT_EQ(a.report.still, b.report.still) << where;
}

}  // namespace abn::sph
