#include "sampling/lloyd.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "sampling/relaxation_start.h"
#include "sampling/voronoi.h"

namespace abn {
namespace {

constexpr std::size_t chunk_size = 256;                // points whose statistics are summed together
constexpr std::size_t parallel_from = 4 * chunk_size;  // below, starting threads costs more than it saves

/// Integral of |x|^2 over a cell, x relative to its point: over the triangles of the point and an edge.
double second_moment(const VoronoiCell& cell) {
  double moment = 0;
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const std::size_t next = k + 1 < cell.size() ? k + 1 : 0;
    const double ax = cell.x[k], ay = cell.y[k];
    const double bx = cell.x[next], by = cell.y[next];
    moment += (ax * by - ay * bx) * (ax * ax + ay * ay + ax * bx + ay * by + bx * bx + by * by) / 12;
  }
  return moment;
}

double wrap(double x, double length) {
  if (x < 0 || x >= length) x -= length * std::floor(x / length);
  return x < length ? x : 0;
}

/// One chunk's sums; a cache line each, because threads write neighbouring chunks at the same time.
struct alignas(64) Chunk {
  double energy = 0;
  double displacement = 0;
};

class Relaxation {
 public:
  Relaxation(const std::vector<Vec2f>& positions, Extent plane)
      : width_(plane.width), height_(plane.height), now_(positions.size()) {
    for (std::size_t i = 0; i < now_.size(); ++i) now_[i] = {double{positions[i].x}, double{positions[i].y}};
    const auto n = static_cast<double>(now_.size());
    spacing_ = std::sqrt(width_ * height_ / n);
    energy_unit_ = width_ * height_ * (width_ * height_ / n);
  }

  /// Moves every point the given share of the way to its centroid; returns the energy before.
  double move(double relaxation, double& mean_displacement) {
    const PeriodicVoronoi voronoi(now_, width_, height_);
    const auto order = voronoi.order();
    const std::size_t n = now_.size();
    std::vector<Chunk> chunks((n + chunk_size - 1) / chunk_size);
    const auto count = static_cast<std::int64_t>(chunks.size());
#pragma omp parallel if (n >= parallel_from)
    {
      VoronoiCell cell;
#pragma omp for schedule(dynamic, 1)
      for (std::int64_t c = 0; c < count; ++c) {
        const auto number = static_cast<std::size_t>(c);
        Chunk sums;
        for (std::size_t k = number * chunk_size; k < std::min(n, (number + 1) * chunk_size); ++k) {
          const std::size_t i = order[k];
          voronoi.cell(i, cell);
          const Vec2d centroid = cell.centroid();
          sums.energy += second_moment(cell);
          sums.displacement += relaxation * std::hypot(centroid.x, centroid.y);
          now_[i] = {wrap(now_[i].x + relaxation * centroid.x, width_),
                     wrap(now_[i].y + relaxation * centroid.y, height_)};
        }
        chunks[number] = sums;
      }
    }
    double energy = 0;
    double displacement = 0;
    for (const Chunk& chunk : chunks) {
      energy += chunk.energy;
      displacement += chunk.displacement;
    }
    mean_displacement = displacement / (static_cast<double>(n) * spacing_);
    return energy / energy_unit_;
  }

  void copy_out(std::vector<Vec2f>& positions, Extent plane) const {
    for (std::size_t i = 0; i < now_.size(); ++i) {
      positions[i] = {wrap_to_plane(now_[i].x, plane.width), wrap_to_plane(now_[i].y, plane.height)};
    }
  }

 private:
  double width_, height_;   // [px]
  double spacing_ = 1;      // [px]
  double energy_unit_ = 1;  // area^2/N [px^4]
  std::vector<Vec2d> now_;  // [px]
};

}  // namespace

LloydReport relax_lloyd(std::vector<Vec2f>& positions, Extent plane, const LloydDescent& descent) {
  LloydReport report;
  if (positions.empty()) return report;
  Relaxation state(positions, plane);
  for (int i = 0; i < descent.iterations && !report.converged; ++i) {
    const double energy = state.move(descent.relaxation, report.mean_displacement);
    if (i == 0) report.first_energy = energy;
    report.iterations = i + 1;
    report.converged = report.mean_displacement < descent.tolerance;
  }
  double nowhere = 0;
  report.energy = state.move(0, nowhere);
  if (report.iterations == 0) report.first_energy = report.energy;
  state.copy_out(positions, plane);
  return report;
}

const StrategyInfo Lloyd::info = {
    .name = "lloyd",
    .family = "blue noise",
    .summary = "Lloyd's relaxation: every sample moves to the centroid of its Voronoi cell, again and again.",
    .cite =
        "Lloyd 1982, Least squares quantization in PCM; Du, Faber, Gunzburger 1999, Centroidal Voronoi tessellations",
    .advice = "For comparison and for stippling; long runs crystallise, and then alias like a lattice.",
};

std::vector<Field<Lloyd::Params>> Lloyd::fields() {
  return {
      {"iterations", &Params::iterations, "iterations, at most; hundreds crystallise", 0, 1000000},
      {"relaxation", &Params::relaxation, "share of the way to the centroid; above 1 overshoots and is faster", 0.01,
       1.99},
      {"tolerance", &Params::tolerance, "stop early when the mean move is below [spacings]; 0 = never stop early", 0.0,
       1.0},
      start_field<Params>(),
  };
}

Lloyd::Lloyd(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  require_budget(info.name, task.budget, std::numeric_limits<std::uint32_t>::max());
}

SampleBatch Lloyd::next(const Feedback&) {
  if (samples_.empty()) {
    std::vector<Vec2f> positions = relaxation_start(params_.start, task_.plane, task_.budget, task_.seed);
    report_ = relax_lloyd(
        positions, task_.plane,
        {.relaxation = params_.relaxation, .iterations = params_.iterations, .tolerance = params_.tolerance});
    samples_.assign(positions, task_.plane);
  }
  return samples_.next();
}

std::vector<Diagnostic> Lloyd::diagnostics() const {
  if (samples_.empty()) return {};
  return {
      {"iterations", static_cast<double>(report_.iterations)},
      {"mean_displacement", report_.mean_displacement},
      {"first_energy", report_.first_energy},
      {"energy", report_.energy},
      {"converged", report_.converged ? 1.0 : 0.0},
      {"backend", 0, "cpu"},
  };
}

}  // namespace abn
