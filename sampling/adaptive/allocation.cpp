#include "sampling/adaptive/allocation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sampling/rng.h"

namespace abn {
namespace {

double sum(const Grid<float>& grid) {
  double total = 0;
  for (const float value : grid.cells()) total += double{value};
  return total;
}

double cell_area(const Grid<float>& map, Extent plane) {
  return static_cast<double>(plane.area()) / static_cast<double>(map.size().area());
}

/// Visits the cells in strips of 16 rows, each strip column by column in turns down and up, so that cells near in the
/// order are near on the map.
template <class Visit>
void along_strips(Extent size, Visit&& visit) {
  constexpr std::uint32_t strip = 16;
  bool forward = true;
  for (std::uint32_t top = 0; top < size.height; top += strip, forward = !forward) {
    const std::uint32_t rows = std::min(strip, size.height - top);
    for (std::uint32_t k = 0; k < size.width; ++k) {
      const std::uint32_t x = forward ? k : size.width - 1 - k;
      for (std::uint32_t r = 0; r < rows; ++r) visit(x, top + (k % 2 == 0 ? r : rows - 1 - r));
    }
  }
}

}  // namespace

double samples_of(const Grid<float>& density, Extent plane) { return sum(density) * cell_area(density, plane); }

Grid<float> allocate(const Grid<float>& weight, const Grid<float>& have, double total, double most, Extent plane) {
  assert(weight.size() == have.size());
  Grid<float> density = have;
  const double wanted = total / cell_area(have, plane);  // sum over the cells
  const auto fill = [&](double scale) {
    for (std::size_t i = 0; i < density.cells().size(); ++i) {
      density[i] = std::max(static_cast<float>(std::min(scale * double{weight[i]}, most)), have[i]);
    }
    return sum(density);
  };
  const float largest = *std::max_element(weight.cells().begin(), weight.cells().end());
  if (wanted <= sum(have) || !(largest > 0)) return density;
  // Bisection on the logarithm of the scale: from nothing added to everything full.
  float smallest = largest;
  for (const float w : weight.cells()) smallest = w > 0 ? std::min(smallest, w) : smallest;
  double low = std::log(most / double{largest}) - 40;
  double high = std::log(most / double{smallest});
  if (fill(std::exp(high)) <= wanted) return density;
  for (int step = 0; step < 40 && high - low > 1e-6; ++step) {
    const double middle = 0.5 * (low + high);
    (fill(std::exp(middle)) > wanted ? high : low) = middle;
  }
  fill(std::exp(low));
  return density;
}

double uniform_share(const Grid<float>& variance) {
  double roots = 0;
  double mean = 0;
  for (const float v : variance.cells()) {
    roots += std::sqrt(double{v});
    mean += double{v};
  }
  if (!(mean > 0)) return 1;
  const auto cells = static_cast<double>(variance.cells().size());
  return roots / cells * (roots / cells) / (mean / cells);
}

std::vector<Vec2f> draw_deficit(const Grid<float>& wanted, const Grid<float>& have, std::uint64_t count, Extent plane,
                                std::uint64_t seed, std::uint32_t stream) {
  assert(wanted.size() == have.size());
  const Extent map = wanted.size();
  double total = 0;
  for (std::size_t i = 0; i < map.area(); ++i) total += std::max(0.0, double{wanted[i]} - double{have[i]});
  const bool nowhere = !(total > 0);
  if (nowhere) total = static_cast<double>(map.area());
  const float cell_width = static_cast<float>(plane.width) / static_cast<float>(map.width);
  const float cell_height = static_cast<float>(plane.height) / static_cast<float>(map.height);
  const float right = just_below(static_cast<float>(plane.width));
  const float bottom = just_below(static_cast<float>(plane.height));
  const double offset = double{Rng(seed, stream, count).uniform()};
  std::vector<Vec2f> points;
  points.reserve(count);
  double before = 0;
  along_strips(map, [&](std::uint32_t x, std::uint32_t y) {
    const std::size_t i = wanted.index(x, y);
    before += nowhere ? 1 : std::max(0.0, double{wanted[i]} - double{have[i]});
    const auto until = static_cast<std::uint64_t>(before / total * static_cast<double>(count) + offset);
    while (points.size() < std::min(until, count)) {
      const Vec2f unit = Rng(seed, stream, points.size()).uniform2();
      points.push_back({std::min((static_cast<float>(x) + unit.x) * cell_width, right),
                        std::min((static_cast<float>(y) + unit.y) * cell_height, bottom)});
    }
  });
  while (points.size() < count) {  // rounding of the last prefix
    points.push_back(to_plane(Rng(seed, stream, points.size()).uniform2(), plane));
  }
  return points;
}

}  // namespace abn
