// Scaling a size field to its number of particles and limiting its slope: declared in size_field.h.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/sph/raster_border.h"
#include "sampling/sph/size_field.h"
#include "sampling/sph/size_field_steps.h"

namespace abn::sph {
namespace {

constexpr std::size_t parallel_from = 16384;  // cells; below, starting threads costs more than they save

void require_positive(const Grid<float>& s) {
  if (s.size().area() == 0) throw ConfigError("size field: it has no cells; give at least 1x1");
  bool good = true;
  for (const float value : s.cells()) good &= value > 0 && value <= std::numeric_limits<float>::max();
  for (std::size_t i = 0; !good && i < s.cells().size(); ++i) {
    if (!(s[i] > 0 && std::isfinite(s[i]))) {
      throw ConfigError("size field: cell " + std::to_string(i) + " is " + std::to_string(s[i]) +
                        "; every relative spacing must be finite and > 0");
    }
  }
}

/// Scratch of sum_between().
struct Squares {
  std::vector<double> t, half_sum, mean;
  explicit Squares(std::size_t count) : t(count), half_sum(count), mean(count) {}
};

/// The sum of mean_inverse_square() over the squares between two rows of cell centres. Without periodicity there is one
/// square more, and those at both ends count half: they lie half outside, where s is mirrored.
double sum_between(const float* top, const float* below, std::uint32_t width, bool periodic, Squares& squares) {
  const std::size_t count = squares.t.size();
  double* t = squares.t.data();
  double* half_sum = squares.half_sum.data();
  double* mean = squares.mean.data();
  const auto set = [&](std::size_t square, std::size_t left, std::size_t right) {
    const double p = double{top[left]} * double{below[right]};
    const double q = double{top[right]} * double{below[left]};
    t[square] = (p - q) / (p + q);
    half_sum[square] = 0.5 * (p + q);
  };
  const std::size_t first = periodic ? 0 : 1;
  if (!periodic) set(0, 0, 0);
  for (std::size_t x = 0; x + 1 < width; ++x) set(first + x, x, x + 1);
  set(count - 1, width - 1, periodic ? 0 : width - 1);
  // All take the series, without a branch; then those for which it is not exact are mended.
  int steep = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double u = t[i] * t[i];
    steep |= u < series_below ? 0 : 1;
    mean[i] = inverse_logarithmic_mean_by_series(u) / half_sum[i];
  }
  for (std::size_t i = 0; steep != 0 && i < count; ++i) {
    if (!(t[i] * t[i] < series_below)) mean[i] = inverse_logarithmic_mean(t[i]) / half_sum[i];
  }
  if (!periodic) mean[0] *= 0.5;
  if (!periodic) mean[count - 1] *= 0.5;
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += mean[i];
  return sum;
}

/// Lowers the values of a row where they rise by more than `step` from their left (direction 1) or right (-1)
/// neighbour; the row's ends are neighbours if periodic.
bool limit_along(float* row, std::uint32_t width, int direction, float step, bool periodic) {
  const auto ends = [&] {
    float& end = direction > 0 ? row[0] : row[width - 1];
    const float bound = (direction > 0 ? row[width - 1] : row[0]) + step;
    if (!periodic || !(bound < end)) return false;
    end = bound;
    return true;
  };
  const bool at_end = ends();
  // A chain of dependent minima is slow, and most rows need none.
  int rises = 0;
  if (direction > 0) {
    for (std::uint32_t x = 1; x < width; ++x) rises |= row[x - 1] + step < row[x] ? 1 : 0;
    for (std::uint32_t x = 1; rises != 0 && x < width; ++x) row[x] = std::min(row[x], row[x - 1] + step);
  } else {
    for (std::uint32_t x = 1; x < width; ++x) rises |= row[x] + step < row[x - 1] ? 1 : 0;
    for (std::uint32_t x = width - 1; rises != 0 && x > 0; --x) row[x - 1] = std::min(row[x - 1], row[x] + step);
  }
  return at_end || rises != 0;
}

/// Lowers the values of a row where they rise by more than a step from the row before.
bool limit_across(float* row, const float* before, std::uint32_t width, float step, float diagonal, bool periodic) {
  int rises = 0;
  const auto lower = [&](std::uint32_t x, std::uint32_t left, std::uint32_t right) {
    const float bound = std::min(before[x] + step, std::min(before[left], before[right]) + diagonal);
    rises |= bound < row[x] ? 1 : 0;
    row[x] = std::min(row[x], bound);
  };
  const std::uint32_t last = width - 1;
  lower(0, periodic ? last : 0, std::min(1U, last));
  for (std::uint32_t x = 1; x < last; ++x) lower(x, x - 1, x + 1);
  lower(last, last > 0 ? last - 1 : 0, periodic ? 0 : last);
  return rises != 0;
}

}  // namespace

double mean_inverse_square(const Grid<float>& s, bool periodic) {
  const Extent size = s.size();
  // Without periodicity there is a row of squares more, half of them outside.
  const std::int64_t rows = std::int64_t{size.height} + (periodic ? 0 : 1);
  std::vector<double> sums(static_cast<std::size_t>(rows));
#pragma omp parallel if (s.cells().size() >= parallel_from)
  {
    Squares squares(std::size_t{size.width} + (periodic ? 0 : 1));
#pragma omp for schedule(static)
    for (std::int64_t row = 0; row < rows; ++row) {
      const std::int64_t y = periodic ? row : row - 1;
      const float* top = &s.at(0, beyond_border(y, size.height, periodic));
      const float* below = &s.at(0, beyond_border(y + 1, size.height, periodic));
      sums[static_cast<std::size_t>(row)] = sum_between(top, below, size.width, periodic, squares);
    }
  }
  if (!periodic) sums.front() *= 0.5;
  if (!periodic) sums.back() *= 0.5;
  double total = 0;
  for (const double sum : sums) total += sum;
  return total / static_cast<double>(size.area());
}

Grid<float> normalised_size_field(const Grid<float>& s, double largest, bool periodic) {
  require_positive(s);
  Grid<float> result = s;
  const auto scale_by = [&](double factor, double limit) {
    for (float& value : result.cells()) value = scaled_size(value, factor, limit);
  };
  // Only ratios count: bring the largest value to 1 first, so that no square over- or underflows.
  scale_by(1.0 / double{*std::max_element(s.cells().begin(), s.cells().end())}, 1.0);
  scale_by(std::sqrt(mean_inverse_square(result, periodic)), largest);
  scale_by(std::sqrt(mean_inverse_square(result, periodic)), largest);
  return result;
}

bool limit_gradient(Grid<float>& s, double cell_x, double cell_y, double limit, bool periodic) {
  const Extent size = s.size();
  const GradientSteps step = gradient_steps(cell_x, cell_y, limit);
  // A sweep down and one up reach every cell inside the raster, more only across its border.
  bool ever = false;
  for (int round = 0; round < 64; ++round) {
    bool changed = false;
    for (const int direction : {1, -1}) {
      for (std::uint32_t k = 0; k < size.height; ++k) {
        const std::int64_t y = direction > 0 ? k : std::int64_t{size.height} - 1 - k;
        float* row = &s.at(0, static_cast<std::uint32_t>(y));
        const float* before = &s.at(0, beyond_border(y - direction, size.height, periodic));
        if (before != row) changed |= limit_across(row, before, size.width, step.y, step.diagonal, periodic);
        changed |= limit_along(row, size.width, 1, step.x, periodic);
        changed |= limit_along(row, size.width, -1, step.x, periodic);
      }
    }
    if (!changed) break;
    ever = true;
  }
  return ever;
}

}  // namespace abn::sph
