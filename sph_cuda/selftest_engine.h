// The part of abn_selftest that compares whole engines: the device's against the CPU's.
#pragma once

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "sampling/rng.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"
#include "sph_cuda/solver.h"

namespace abn::sph_cuda {

/// What one comparison starts from.
struct EngineCase {
  std::string name;
  Extent plane{500, 480};
  std::uint64_t particles = 20000;
  sph::Boundary boundary = sph::Boundary::periodic;
  double ratio = 1;  // of a size field; 1 = none
  int classes = 1;
  bool frozen = false;  // every third particle
};

inline std::unique_ptr<sph::Solver> start_case(const EngineCase& wanted, const sph::SolverFactory& make) {
  const std::vector<Vec2f> positions = sph::white_positions(wanted.plane, wanted.particles);
  auto setup = sph::setup_of(wanted.plane, positions);
  setup.boundary = wanted.boundary;
  std::vector<std::uint8_t> labels;
  for (std::uint64_t i = 0; wanted.classes > 1 && i < wanted.particles; ++i) {
    labels.push_back(static_cast<std::uint8_t>(i % static_cast<std::uint64_t>(wanted.classes)));
  }
  setup.classes = labels;
  const Grid<float> field = sph::smooth_size_field({64, 64}, wanted.ratio);
  if (wanted.ratio != 1) setup.size_field = &field;
  auto solver = make(setup);
  if (wanted.frozen) {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < wanted.particles; i += 3) ids.push_back(i);
    solver->freeze(ids);
  }
  return solver;
}

inline std::vector<Vec2f> copy_of(std::span<const Vec2f> positions) { return {positions.begin(), positions.end()}; }

/// Largest distance between two sets in mean spacings, particle by particle, and how many coordinates differ at all.
struct SetDifference {
  double largest = 0;
  std::uint64_t coordinates = 0;
};
inline SetDifference set_difference(const std::vector<Vec2f>& a, const std::vector<Vec2f>& b, Extent plane) {
  const double spacing = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(a.size()));
  const auto around = [](double d, double length) { return std::fabs(d - length * std::round(d / length)); };
  SetDifference found;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double dx = around(double{a[i].x} - double{b[i].x}, plane.width);
    const double dy = around(double{a[i].y} - double{b[i].y}, plane.height);
    // A particle that is nowhere is infinitely far away.
    const double distance = std::isfinite(dx + dy) ? std::hypot(dx, dy) / spacing : INFINITY;
    found.largest = std::fmax(found.largest, distance);
    found.coordinates += (std::bit_cast<std::uint32_t>(a[i].x) != std::bit_cast<std::uint32_t>(b[i].x) ? 1U : 0U) +
                         (std::bit_cast<std::uint32_t>(a[i].y) != std::bit_cast<std::uint32_t>(b[i].y) ? 1U : 0U);
  }
  return found;
}

/// One step from equal state: 1e-5 of a spacing, and whether it is equal to the bit.
inline bool report_step(const EngineCase& wanted) {
  const auto cpu = start_case(wanted, sph::make_cpu_solver);
  const auto gpu = start_case(wanted, make_cuda_solver);
  const sph::Evaluation a = cpu->evaluate();
  const sph::Evaluation b = gpu->evaluate();
  double worst = 0;
  for (std::size_t i = 0; i < a.density.size(); ++i) {
    const double force = std::fmax(1.0, std::hypot(a.force_x[i], a.force_y[i]));
    worst = std::fmax(worst, std::fabs(b.density[i] / a.density[i] - 1));
    worst = std::fmax(worst, std::fabs(b.force_x[i] - a.force_x[i]) / force);
    worst = std::fmax(worst, std::fabs(b.force_y[i] - a.force_y[i]) / force);
    if (!std::isfinite(b.density[i] + b.force_x[i] + b.force_y[i])) worst = INFINITY;
  }
  cpu->relax(1, false);
  gpu->relax(1, false);
  const SetDifference moved = set_difference(copy_of(cpu->positions()), copy_of(gpu->positions()), wanted.plane);
  const bool good = worst <= 1e-5 && moved.largest <= 1e-5;
  std::printf("%s one step, %-22s density and force within %.3g, positions within %.3g d, %llu coordinates not equal\n",
              good ? "ok    " : "FAILED", wanted.name.c_str(), worst, moved.largest,
              static_cast<unsigned long long>(moved.coordinates));
  return good;
}

/// Mean distance to the nearest neighbour in units of that of the hexagonal lattice: "relative radius", but its mean.
inline double mean_nearest(const std::vector<Vec2f>& points, Extent plane) {
  const double spacing = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(points.size()));
  const auto columns = static_cast<std::int64_t>(std::max(1.0, std::floor(plane.width / (2 * spacing))));
  const auto rows = static_cast<std::int64_t>(std::max(1.0, std::floor(plane.height / (2 * spacing))));
  std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(columns * rows));
  const auto cell_of = [&](Vec2f p) {
    const auto x = static_cast<std::int64_t>(double{p.x} / plane.width * static_cast<double>(columns));
    const auto y = static_cast<std::int64_t>(double{p.y} / plane.height * static_cast<double>(rows));
    return std::pair(std::clamp<std::int64_t>(x, 0, columns - 1), std::clamp<std::int64_t>(y, 0, rows - 1));
  };
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto [x, y] = cell_of(points[i]);
    cells[static_cast<std::size_t>(y * columns + x)].push_back(i);
  }
  double total = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto [x, y] = cell_of(points[i]);
    double nearest = 1e30;
    for (std::int64_t v = y - 1; v <= y + 1; ++v) {
      for (std::int64_t u = x - 1; u <= x + 1; ++u) {
        const std::int64_t cell = (v + rows) % rows * columns + (u + columns) % columns;
        for (const std::uint32_t j : cells[static_cast<std::size_t>(cell)]) {
          if (j == i) continue;
          double dx = std::fabs(double{points[i].x} - double{points[j].x});
          double dy = std::fabs(double{points[i].y} - double{points[j].y});
          dx = std::fmin(dx, plane.width - dx);
          dy = std::fmin(dy, plane.height - dy);
          nearest = std::fmin(nearest, dx * dx + dy * dy);
        }
      }
    }
    total += std::sqrt(nearest);
  }
  return total / static_cast<double>(points.size()) / (spacing * std::sqrt(2 / std::sqrt(3.0)));
}

/// Relaxed to convergence on both sides: as many steps, as even a set, the same density.
inline bool report_converged(const EngineCase& wanted) {
  const auto cpu = start_case(wanted, sph::make_cpu_solver);
  const auto gpu = start_case(wanted, make_cuda_solver);
  const sph::RelaxReport a = cpu->relax(200, true);
  const sph::RelaxReport b = gpu->relax(200, true);
  const std::vector<Vec2f> on_cpu = copy_of(cpu->positions());
  const std::vector<Vec2f> on_gpu = copy_of(gpu->positions());
  const double even_a = mean_nearest(on_cpu, wanted.plane);
  const double even_b = mean_nearest(on_gpu, wanted.plane);
  const bool good = b.converged == a.converged && std::abs(a.steps - b.steps) <= 2 &&
                    std::fabs(even_a - even_b) <= 0.005 && std::fabs(a.mean_density - b.mean_density) <= 1e-3;
  std::printf(
      "%s converged, %-21s steps %d, %d; mean nearest neighbour %.4f, %.4f; mean density %.5f, %.5f; %llu "
      "coordinates not equal\n",
      good ? "ok    " : "FAILED", wanted.name.c_str(), a.steps, b.steps, even_a, even_b, a.mean_density, b.mean_density,
      static_cast<unsigned long long>(set_difference(on_cpu, on_gpu, wanted.plane).coordinates));
  return good;
}

inline bool report_deterministic(const EngineCase& wanted) {
  const auto first = start_case(wanted, make_cuda_solver);
  first->relax(40, false);
  const std::vector<Vec2f> once = copy_of(first->positions());
  bool good = true;
  for (int run = 0; run < 3; ++run) {
    const auto again = start_case(wanted, make_cuda_solver);
    again->relax(40, false);
    good &= once == copy_of(again->positions());
  }
  std::printf("%s four runs, %-21s %s\n", good ? "ok    " : "FAILED", wanted.name.c_str(),
              good ? "equal bit for bit" : "DIFFER");
  return good;
}

/// Any number of particles: the density stays 1, nobody is lost.
inline bool report_size(std::uint64_t particles) {
  EngineCase wanted;
  const auto side = static_cast<std::uint32_t>(std::clamp(std::sqrt(static_cast<double>(particles) / 6), 1.0, 60000.0));
  wanted.plane = {side, side};
  wanted.particles = particles;
  const auto solver = start_case(wanted, make_cuda_solver);
  const sph::RelaxReport report = solver->relax(20, false);
  bool inside = true;
  for (const Vec2f p : solver->positions()) {
    inside &= p.x >= 0 && p.x < static_cast<float>(side) && p.y >= 0 && p.y < static_cast<float>(side);
  }
  const bool good = inside && report.non_finite == 0 && std::fabs(report.mean_density - 1) < 0.05;
  std::printf("%s %llu particles: mean density %.5f, mean displacement %.4f d\n", good ? "ok    " : "FAILED",
              static_cast<unsigned long long>(particles), report.mean_density, report.mean_displacement);
  return good;
}

/// `large`: up to 20 million particles, some 2 GB.
inline bool run_engine_tests(bool large) {
  bool good = true;
  const std::vector<EngineCase> cases = {
      {.name = "uniform"},
      {.name = "ghosts", .boundary = sph::Boundary::ghost},
      {.name = "size field 1:10", .ratio = 10},
      {.name = "size field 1:10, ghosts", .boundary = sph::Boundary::ghost, .ratio = 10},
      {.name = "3 classes", .classes = 3},
      {.name = "frozen, ghosts", .boundary = sph::Boundary::ghost, .frozen = true}};
  for (const EngineCase& wanted : cases) good &= report_step(wanted);
  for (const EngineCase& wanted : cases) good &= report_deterministic(wanted);
  good &= report_converged({.name = "uniform", .plane = {200, 200}, .particles = 240000});
  good &= report_converged({.name = "size field 1:10", .ratio = 10});
  std::vector<std::uint64_t> sizes = {1, 2, 7, 100, 1000, 100000, 1000000};
  if (large) sizes.insert(sizes.end(), {10000000, 20000000});
  for (const std::uint64_t particles : sizes) good &= report_size(particles);
  return good;
}

}  // namespace abn::sph_cuda
