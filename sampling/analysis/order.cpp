#include "sampling/analysis/order.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "sampling/analysis/spacing.h"
#include "sampling/error.h"
#include "sampling/voronoi.h"

namespace abn::analysis {
namespace {

constexpr std::size_t points_per_task = 4096;
constexpr double shortest_edge = 1e-9;  // in units of the hexagonal spacing

/// Sums over some of the cells.
struct Tally {
  std::complex<double> psi = 0;
  double absolute_psi = 0;
  double cells = 0;
  double six_valent = 0;
  double farthest = 0;

  void add(const VoronoiCell& cell, double shortest);
  void add(const Tally& other);
};

void Tally::add(const VoronoiCell& cell, double shortest) {
  std::complex<double> sum = 0;
  int valence = 0;
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const std::size_t next = k + 1 == cell.size() ? 0 : k + 1;
    const std::complex<double> edge(cell.x[next] - cell.x[k], cell.y[next] - cell.y[k]);
    const double length = std::abs(edge);
    if (length < shortest) continue;
    ++valence;
    // The neighbour lies along the edge's outward normal; no choice among its images is needed.
    const std::complex<double> normal = std::complex<double>(edge.imag(), -edge.real()) / length;
    const std::complex<double> squared = normal * normal;
    sum += squared * squared * squared;
  }
  if (valence == 0) return;  // no cell, or one as small as the shortest edge
  const std::complex<double> own = sum / static_cast<double>(valence);
  psi += own;
  absolute_psi += std::abs(own);
  cells += 1;
  six_valent += valence == 6 ? 1 : 0;
  farthest = std::max(farthest, cell.farthest_vertex());
}

void Tally::add(const Tally& other) {
  psi += other.psi;
  absolute_psi += other.absolute_psi;
  cells += other.cells;
  six_valent += other.six_valent;
  farthest = std::max(farthest, other.farthest);
}

}  // namespace

BondOrder bond_order(Points points) {
  if (points.empty()) throw ConfigError("bond order: the point set is empty; give at least one point");
  std::vector<Vec2d> positions;
  positions.reserve(points.size());
  for (const Point& p : points) positions.push_back({p.x, p.y});
  const PeriodicVoronoi voronoi(positions, 1, 1);
  const auto order = voronoi.order();
  const double unit = hexagonal_spacing(points.size());

  const auto tasks = static_cast<std::ptrdiff_t>((points.size() + points_per_task - 1) / points_per_task);
  std::vector<Tally> tallies(static_cast<std::size_t>(tasks));
#pragma omp parallel for schedule(dynamic, 1) if (tasks > 1)
  for (std::ptrdiff_t task = 0; task < tasks; ++task) {
    const std::size_t first = static_cast<std::size_t>(task) * points_per_task;
    VoronoiCell cell;
    for (const std::size_t i : order.subspan(first, std::min(points_per_task, points.size() - first))) {
      voronoi.cell(i, cell);
      tallies[static_cast<std::size_t>(task)].add(cell, shortest_edge * unit);
    }
  }

  Tally all;
  for (const Tally& tally : tallies) all.add(tally);
  return {.local_order = all.absolute_psi / all.cells,
          .global_order = std::abs(all.psi) / all.cells,
          .six_valent = all.six_valent / all.cells,
          .coverage_radius = all.farthest / unit};
}

}  // namespace abn::analysis
