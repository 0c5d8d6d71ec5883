#include "sampling/analysis/discrepancy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/vector_clones.h"

namespace abn::analysis {
namespace {

constexpr std::size_t rows_per_task = 256;
constexpr std::size_t lanes = 8;  // sums are kept apart by lane, so that every width of vector adds in the same order

struct Columns {
  std::vector<double> x, y;
};

Columns columns_of(Points points) {
  Columns columns;
  for (const Point& p : points) {
    columns.x.push_back(p.x);
    columns.y.push_back(p.y);
  }
  return columns;
}

void require_points(Points points) {
  if (points.empty()) throw ConfigError("discrepancy: the point set is empty; give at least one point");
}

std::ptrdiff_t tasks_of(std::size_t rows) {
  return static_cast<std::ptrdiff_t>((rows + rows_per_task - 1) / rows_per_task);
}

/// The largest |count/n - area| over boxes whose right border lies in [left, right], between which there is no point;
/// `y` [count] are 0, the sorted heights of the points to the left, and 1. Box j is closed at y[j] and open at y[j+1].
ABN_VECTOR_CLONES double worst_box(const double* y, std::size_t count, double left, double right, double per_point) {
  double worst = 0;
#pragma omp simd reduction(max : worst)
  for (int j = 0; j < static_cast<int>(count) - 1; ++j) {
    const double share = per_point * j;
    const double closed = std::abs(share - left * y[j]);
    const double open = std::abs(share - right * y[j + 1]);
    const double larger = closed > open ? closed : open;
    worst = larger > worst ? larger : worst;
  }
  return worst;
}

/// Sums over pairs of the six kernels, in the order of L2Discrepancies.
using PairSums = std::array<double, 6>;

/// Adds the kernels of (x[i], y[i]) with all points before i.
ABN_VECTOR_CLONES void add_row(const double* x, const double* y, std::size_t i, double* sums) {
  const double xi = x[i];
  const double yi = y[i];
  const double centre_xi = std::abs(xi - 0.5);
  const double centre_yi = std::abs(yi - 0.5);
  double star[lanes] = {}, centred[lanes] = {}, wraparound[lanes] = {};
  double generalised[lanes] = {}, unanchored[lanes] = {}, symmetric[lanes] = {};
  const auto add = [&](std::size_t j, std::size_t lane) {
    const double dx = std::abs(xi - x[j]);
    const double dy = std::abs(yi - y[j]);
    const double most_x = xi > x[j] ? xi : x[j];
    const double most_y = yi > y[j] ? yi : y[j];
    const double least_x = most_x - dx;
    const double least_y = most_y - dy;
    star[lane] += (1 - most_x) * (1 - most_y);
    centred[lane] +=
        (1 + 0.5 * (centre_xi + std::abs(x[j] - 0.5) - dx)) * (1 + 0.5 * (centre_yi + std::abs(y[j] - 0.5) - dy));
    wraparound[lane] += (1.5 - dx * (1 - dx)) * (1.5 - dy * (1 - dy));
    generalised[lane] += (2 - most_x) * (2 - most_y);
    unanchored[lane] += (1 - most_x) * least_x * ((1 - most_y) * least_y);
    symmetric[lane] += (1 - dx) * (1 - dy);
  };
  std::size_t j = 0;
  for (; j + lanes <= i; j += lanes) {
#pragma omp simd
    for (std::size_t lane = 0; lane < lanes; ++lane) add(j + lane, lane);
  }
  for (; j < i; ++j) add(j, j % lanes);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    sums[0] += star[lane];
    sums[1] += centred[lane];
    sums[2] += wraparound[lane];
    sums[3] += generalised[lane];
    sums[4] += unanchored[lane];
    sums[5] += symmetric[lane];
  }
}

}  // namespace

double star_discrepancy(Points points) {
  require_points(points);
  const std::size_t count = points.size();
  if (count > max_star_discrepancy_points) {
    throw ConfigError("star discrepancy of " + std::to_string(count) + " points: use at most " +
                      std::to_string(max_star_discrepancy_points) + ", or an L2 discrepancy");
  }
  std::vector<Point> by_x(points.begin(), points.end());
  std::sort(by_x.begin(), by_x.end(), [](const Point& p, const Point& q) { return p.x < q.x; });

  // Row i: boxes that hold, in x, the first i points. A box is worst when it is closed at points, or open just before
  // them. Among equal coordinates the counts passed lie between those of the closed and the open box, which are counted
  // too, so that ties need no care.
  const std::size_t rows = count + 1;
  const std::ptrdiff_t tasks = tasks_of(rows);
  std::vector<double> worst(static_cast<std::size_t>(tasks), 0.0);
#pragma omp parallel for schedule(dynamic, 1) if (tasks > 1)
  for (std::ptrdiff_t task = 0; task < tasks; ++task) {
    const std::size_t first = static_cast<std::size_t>(task) * rows_per_task;
    const std::size_t end = std::min(rows, first + rows_per_task);
    std::vector<double> y{0, 1};
    for (std::size_t i = 0; i < first; ++i) y.push_back(by_x[i].y);
    std::sort(y.begin(), y.end());
    for (std::size_t i = first; i < end; ++i) {
      const double left = i == 0 ? 0 : by_x[i - 1].x;
      const double right = i == count ? 1 : by_x[i].x;
      double& largest = worst[static_cast<std::size_t>(task)];
      largest = std::max(largest, worst_box(y.data(), y.size(), left, right, 1.0 / static_cast<double>(count)));
      if (i < count) y.insert(std::upper_bound(y.begin(), y.end(), by_x[i].y), by_x[i].y);
    }
  }
  return *std::max_element(worst.begin(), worst.end());
}

L2Discrepancies l2_discrepancies(Points points) {
  require_points(points);
  const Columns columns = columns_of(points);
  const std::size_t count = points.size();
  const std::ptrdiff_t tasks = tasks_of(count);
  std::vector<PairSums> partial(static_cast<std::size_t>(tasks), PairSums{});
#pragma omp parallel for schedule(dynamic, 1) if (tasks > 1)
  for (std::ptrdiff_t task = 0; task < tasks; ++task) {
    const std::size_t first = static_cast<std::size_t>(task) * rows_per_task;
    PairSums sums{};
    for (std::size_t i = first; i < std::min(count, first + rows_per_task); ++i) {
      add_row(columns.x.data(), columns.y.data(), i, sums.data());
    }
    partial[static_cast<std::size_t>(task)] = sums;
  }
  PairSums pairs{};
  for (const PairSums& sums : partial) {
    for (std::size_t k = 0; k < sums.size(); ++k) pairs[k] += 2 * sums[k];
  }

  PairSums single{};  // the middle terms, without their factors
  for (const Point& p : points) {
    const double centre_x = std::abs(p.x - 0.5);
    const double centre_y = std::abs(p.y - 0.5);
    // Each point paired with itself.
    pairs[0] += (1 - p.x) * (1 - p.y);
    pairs[1] += (1 + centre_x) * (1 + centre_y);
    pairs[2] += 1.5 * 1.5;
    pairs[3] += (2 - p.x) * (2 - p.y);
    pairs[4] += (1 - p.x) * p.x * (1 - p.y) * p.y;
    pairs[5] += 1;
    single[0] += (1 - p.x * p.x) * (1 - p.y * p.y) / 4;
    single[1] += (1 + 0.5 * centre_x * (1 - centre_x)) * (1 + 0.5 * centre_y * (1 - centre_y));
    single[3] += (3 - p.x * p.x) * (3 - p.y * p.y) / 4;
    single[4] += p.x * (1 - p.x) * p.y * (1 - p.y) / 4;
    single[5] += (1 + 2 * p.x * (1 - p.x)) * (1 + 2 * p.y * (1 - p.y));
  }
  const auto n = static_cast<double>(count);
  const auto root = [&](double constant, std::size_t k, double pair_factor = 1) {
    return std::sqrt(std::max(0.0, constant - 2 * single[k] / n + pair_factor * pairs[k] / (n * n)));
  };
  return {.star = root(1.0 / 9, 0),
          .centred = root(169.0 / 144, 1),
          .wraparound = root(-16.0 / 9, 2),
          .generalised = root(16.0 / 9, 3),
          .unanchored = root(1.0 / 144, 4),
          .symmetric = root(16.0 / 9, 5, 4)};
}

}  // namespace abn::analysis
