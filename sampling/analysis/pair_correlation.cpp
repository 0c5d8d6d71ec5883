#include "sampling/analysis/pair_correlation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>

#include "sampling/error.h"

namespace abn::analysis {
namespace {

// Points sorted by the cells of a grid on the torus, row by row.
struct CellGrid {
  std::size_t side;                // cells a side
  std::vector<std::size_t> start;  // [side * side + 1]
  std::vector<double> x, y, size;  // [N]

  CellGrid(Points points, std::span<const double> sizes) {
    // About six points per cell: rows of cells then are long enough to run through.
    side = std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(static_cast<double>(points.size()) / 6)));
    const auto cell_of = [&](Point p) {
      const auto cell = [&](double t) {
        return std::min(side - 1, static_cast<std::size_t>(t * static_cast<double>(side)));
      };
      return cell(p.y) * side + cell(p.x);
    };
    start.resize(side * side + 1);
    for (const Point p : points) ++start[cell_of(p) + 1];
    for (std::size_t c = 0; c < side * side; ++c) start[c + 1] += start[c];
    x.resize(points.size());
    y.resize(points.size());
    size.resize(points.size());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t k = next[cell_of(points[i])]++;
      x[k] = points[i].x;
      y[k] = points[i].y;
      size[k] = sizes[i];
    }
  }

  // Calls visit(first, last, shift_x, shift_y) for runs of points that together hold all within `radius` <= 1/2 of (px,
  // py); the shift is what wrapping adds to their coordinates. A run may come twice, with shifts that differ by 1.
  template <class Visit>
  void for_each_run(double px, double py, double radius, Visit visit) const {
    const auto n = static_cast<double>(side);
    const auto cells = static_cast<std::ptrdiff_t>(side);
    const auto bottom = static_cast<std::ptrdiff_t>(std::floor((py - radius) * n));
    const auto left = static_cast<std::ptrdiff_t>(std::floor((px - radius) * n));
    const auto top = static_cast<std::ptrdiff_t>(std::floor((py + radius) * n));
    const auto right = static_cast<std::ptrdiff_t>(std::floor((px + radius) * n));
    for (std::ptrdiff_t row = bottom; row <= top; ++row) {
      const std::ptrdiff_t turns_y = row < 0 ? -1 : row >= cells ? 1 : 0;
      for (std::ptrdiff_t from = left; from <= right;) {
        const std::ptrdiff_t turns_x = from < 0 ? -1 : from >= cells ? 1 : 0;
        const std::ptrdiff_t to = std::min(right, (turns_x + 1) * cells - 1);
        const std::size_t first_of_row = static_cast<std::size_t>(row - turns_y * cells) * side;
        visit(start[first_of_row + static_cast<std::size_t>(from - turns_x * cells)],
              start[first_of_row + static_cast<std::size_t>(to - turns_x * cells) + 1], static_cast<double>(turns_x),
              static_cast<double>(turns_y));
        from = to + 1;
      }
    }
  }
};

struct Histogram {
  std::vector<std::uint64_t> radial;      // [bins] pairs
  std::vector<std::uint64_t> difference;  // [bins * bins] one of the two differences of each pair

  void add(const Histogram& other) {
    for (std::size_t i = 0; i < radial.size(); ++i) radial[i] += other.radial[i];
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] += other.difference[i];
  }
};

// The pairs of point i with all smaller points, and with those of its size that follow it.
void count_pairs(const CellGrid& grid, std::size_t i, double spacings, double bins_per_spacing, std::size_t bins,
                 Histogram& histogram) {
  const double range = static_cast<double>(bins) / bins_per_spacing;
  const double xi = grid.x[i];
  const double yi = grid.y[i];
  const double si = grid.size[i];
  const double bins_per_length = 2 * spacings * bins_per_spacing;  // divided by s_i + s_j
  const auto limit = static_cast<double>(bins);
  const auto cell = [&](double bin) {  // of the picture; a sum on the far border belongs to its last cell
    return std::min(bins - 1, static_cast<std::size_t>((bin + limit) * 0.5));
  };
  const double radius = range * si / spacings * (1 + 1e-12);  // rounding must not lose a pair
  grid.for_each_run(xi, yi, radius, [&](std::size_t first, std::size_t last, double shift_x, double shift_y) {
    for (std::size_t j = first; j < last; ++j) {
      const double sj = grid.size[j];
      if (sj > si || (sj == si && j <= i)) continue;
      const double scale = bins_per_length / (si + sj);
      const double dx = (grid.x[j] + shift_x - xi) * scale;
      const double dy = (grid.y[j] + shift_y - yi) * scale;
      const double squared = dx * dx + dy * dy;
      if (squared >= limit * limit) continue;
      ++histogram.radial[std::min(bins - 1, static_cast<std::size_t>(std::sqrt(squared)))];
      ++histogram.difference[cell(dy) * bins + cell(dx)];
    }
  });
}

double mean_of_outer_quarter(std::span<const double> g) {
  const std::size_t from = g.size() - (g.size() + 3) / 4;
  double sum = 0;
  double area = 0;
  for (std::size_t k = from; k < g.size(); ++k) {
    const double ring = 2 * static_cast<double>(k) + 1;
    sum += g[k] * ring;
    area += ring;
  }
  return sum / area;
}

void require(bool fine, const std::string& problem) {
  if (!fine) throw ConfigError("pair correlation: " + problem);
}

}  // namespace

PairCorrelation pair_correlation(Points points, std::span<const float> size, PairCorrelationOptions options) {
  const std::size_t n = points.size();
  require(n >= 2, std::to_string(n) + " points have no pairs; give at least 2");
  require(size.empty() || size.size() == n, std::to_string(size.size()) + " sizes for " + std::to_string(n) +
                                                " points; give one per point, or none for a uniform set");
  require(options.range > 0 && options.range <= 1e6,
          "range " + std::to_string(options.range) + " is outside (0, 1e6]; give it in mean spacings");
  require(options.bins_per_spacing >= 1 && options.bins_per_spacing <= 1024,
          "bins_per_spacing " + std::to_string(options.bins_per_spacing) + " is outside [1, 1024]");
  std::vector<double> sizes(n, 1.0);
  double largest = size.empty() ? 1 : 0;
  double squares = size.empty() ? static_cast<double>(n) : 0;
  for (std::size_t i = 0; i < size.size(); ++i) {
    require(std::isfinite(size[i]) && size[i] > 0,
            "size " + std::to_string(size[i]) + " of point " + std::to_string(i) + " is not positive and finite");
    sizes[i] = size[i];
    largest = std::max(largest, sizes[i]);
    squares += sizes[i] * sizes[i];
  }
  const double mean_size = std::sqrt(squares / static_cast<double>(n));
  const double spacings = mean_size * std::sqrt(static_cast<double>(n));  // d' [spacings] = d spacings 2 / (s_i + s_j)

  // Beyond half the torus a pair would have two differences.
  const double furthest = 0.5 * spacings / largest;
  // An even number, so that the middle part of `difference` is that of a shorter range (mean_of()).
  const auto fitting = static_cast<std::size_t>(std::min(options.range, furthest) * options.bins_per_spacing);
  const std::size_t bins = fitting - fitting % 2;
  require(bins >= 2, "range " + std::to_string(options.range) + " with " + std::to_string(options.bins_per_spacing) +
                         " bins per spacing holds fewer than two bins for " + std::to_string(n) +
                         " points; raise either, or give sizes that differ less");

  const CellGrid grid(points, sizes);
  Histogram total{std::vector<std::uint64_t>(bins), std::vector<std::uint64_t>(bins * bins)};
#pragma omp parallel
  {
    Histogram mine{std::vector<std::uint64_t>(bins), std::vector<std::uint64_t>(bins * bins)};
#pragma omp for schedule(dynamic, 1024)
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(n); ++i) {
      count_pairs(grid, static_cast<std::size_t>(i), spacings, options.bins_per_spacing, bins, mine);
    }
#pragma omp critical
    total.add(mine);  // integers: any order gives the same
  }

  PairCorrelation result;
  result.count = n;
  result.bin_width = 1.0 / options.bins_per_spacing;
  result.range = static_cast<double>(bins) * result.bin_width;
  result.g.resize(bins);
  // A Poisson process has n (n - 1) area ordered pairs, with the area on the unit torus, that is [spacings^2] / n.
  const double per_area = static_cast<double>(n - 1);
  for (std::size_t k = 0; k < bins; ++k) {
    const double ring = std::numbers::pi * (2 * static_cast<double>(k) + 1) * result.bin_width * result.bin_width;
    result.g[k] = 2 * static_cast<double>(total.radial[k]) / (per_area * ring);
    result.pairs += total.radial[k];
  }
  const auto side = static_cast<std::uint32_t>(bins);
  result.difference = Grid<double>({side, side});
  const double cell_area = 4 * result.bin_width * result.bin_width;
  for (std::size_t c = 0; c < bins * bins; ++c) {
    const std::uint64_t both = total.difference[c] + total.difference[bins * bins - 1 - c];  // d' and -d'
    result.difference[c] = static_cast<double>(both) / (per_area * cell_area);
  }
  result.plateau = mean_of_outer_quarter(result.g);
  return result;
}

PairCorrelation mean_of(std::span<const PairCorrelation> sets) {
  require(!sets.empty(), "the mean of no sets; give at least 1");
  PairCorrelation mean =
      *std::min_element(sets.begin(), sets.end(),
                        [](const PairCorrelation& a, const PairCorrelation& b) { return a.g.size() < b.g.size(); });
  const std::size_t bins = mean.g.size();
  std::fill(mean.g.begin(), mean.g.end(), 0.0);
  std::fill(mean.difference.cells().begin(), mean.difference.cells().end(), 0.0);
  mean.pairs = 0;
  mean.sets = 0;
  for (const PairCorrelation& set : sets) {
    require(set.count == mean.count && set.bin_width == mean.bin_width,
            "sets of " + std::to_string(set.count) + " and " + std::to_string(mean.count) +
                " points, or of different bins, cannot be averaged; give sets of equal count");
    for (std::size_t k = 0; k < bins; ++k) mean.g[k] += set.g[k];
    const std::size_t side = set.g.size();
    const std::size_t border = (side - bins) / 2;
    for (std::size_t y = 0; y < bins; ++y) {
      for (std::size_t x = 0; x < bins; ++x) {
        const double dx = 2 * static_cast<double>(x) + 1 - static_cast<double>(bins);
        const double dy = 2 * static_cast<double>(y) + 1 - static_cast<double>(bins);
        const double reach = static_cast<double>(bins);
        if (side > bins && dx * dx + dy * dy > reach * reach) continue;  // beyond the shorter range
        mean.difference[y * bins + x] += set.difference[(y + border) * side + x + border];
      }
    }
    mean.pairs += set.pairs;
    mean.sets += set.sets;
  }
  const auto n = static_cast<double>(sets.size());
  for (double& value : mean.g) value /= n;
  for (double& value : mean.difference.cells()) value /= n;
  mean.plateau = mean_of_outer_quarter(mean.g);
  return mean;
}

std::vector<double> radial_power(const PairCorrelation& correlation, std::span<const double> frequency) {
  const std::size_t bins = correlation.g.size();
  std::vector<double> weighted(bins);  // 2 pi (g - 1) w r dr, r in spacings: there N dr r is 1 dr r
  for (std::size_t k = 0; k < bins; ++k) {
    const double middle = (static_cast<double>(k) + 0.5) / static_cast<double>(bins);
    const double window =
        0.42 + 0.5 * std::cos(std::numbers::pi * middle) + 0.08 * std::cos(2 * std::numbers::pi * middle);
    weighted[k] =
        2 * std::numbers::pi * (correlation.g[k] - 1) * window * middle * correlation.range * correlation.bin_width;
  }
  std::vector<double> power(frequency.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t f = 0; f < static_cast<std::int64_t>(frequency.size()); ++f) {
    const auto i = static_cast<std::size_t>(f);
    double sum = 1;
    for (std::size_t k = 0; k < bins; ++k) {
      const double r = (static_cast<double>(k) + 0.5) * correlation.bin_width;
      sum += weighted[k] * std::cyl_bessel_j(0.0, 2 * std::numbers::pi * std::abs(frequency[i]) * r);
    }
    power[i] = std::abs(sum);
  }
  return power;
}

}  // namespace abn::analysis
