#include "sampling/adaptive/allocation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sampling/adaptive/map_rules.h"
#include "sampling/fixed_prefix.h"
#include "sampling/rng.h"
#include "sampling/sph/fixed_sum.h"

namespace abn {
namespace {

double sum(const Grid<float>& grid) {
  return sph::fixed_order_sum(grid.cells().size(), [&](std::size_t i) { return double{grid[i]}; });
}

double cell_area(const Grid<float>& map, Extent plane) {
  return static_cast<double>(plane.area()) / static_cast<double>(map.size().area());
}

}  // namespace

Grid<float> density_weights(const Grid<float>& driver, double floor, double exponent) {
  const double least = floor * (sum(driver) / static_cast<double>(driver.cells().size()));
  Grid<float> weight(driver.size());
  for (std::size_t i = 0; i < weight.cells().size(); ++i) weight[i] = density_weight(driver[i], least, exponent);
  return weight;
}

double samples_of(const Grid<float>& density, Extent plane) { return sum(density) * cell_area(density, plane); }

Grid<float> allocate(const Grid<float>& weight, const Grid<float>& have, double total, double most, Extent plane) {
  assert(weight.size() == have.size());
  MapRange range;
  range.have = sum(have);
  for (const float w : weight.cells()) {
    range.largest = std::max(range.largest, w);
    range.smallest = w > 0 ? std::min(range.smallest, w) : range.smallest;
  }
  FillSearch search(range, total / cell_area(have, plane), most);
  const auto density_at = [&](std::size_t i) { return filled(search.scale, weight[i], have[i], most); };
  while (!search.done) {
    search.take(sph::fixed_order_sum(weight.cells().size(), [&](std::size_t i) { return double{density_at(i)}; }));
  }
  Grid<float> density(have.size());
  for (std::size_t i = 0; i < density.cells().size(); ++i) density[i] = density_at(i);
  return density;
}

double uniform_share(const Grid<float>& variance) {
  const std::size_t cells = variance.cells().size();
  const double roots = sph::fixed_order_sum(cells, [&](std::size_t i) { return std::sqrt(double{variance[i]}); });
  const double mean = sum(variance);
  if (!(mean > 0)) return 1;
  const auto count = static_cast<double>(cells);
  return roots / count * (roots / count) / (mean / count);
}

std::vector<Vec2f> draw_deficit(const Grid<float>& wanted, const Grid<float>& have, std::uint64_t count, Extent plane,
                                std::uint64_t seed, std::uint32_t stream) {
  assert(wanted.size() == have.size());
  const Extent map = wanted.size();
  const StripOrder order(map);
  std::vector<double> lack(map.area());
  for (std::size_t k = 0; k < lack.size(); ++k) {
    const StripOrder::Cell cell = order.cell(k);
    lack[k] = deficit(wanted.at(cell.x, cell.y), have.at(cell.x, cell.y));
  }
  std::vector<double> before = fixed_order_prefix(lack);
  if (!(before.back() > 0)) before = fixed_order_prefix(std::vector<double>(map.area(), 1.0));
  const DeficitDraw draw{plane, map, count, before.back(), double{Rng(seed, stream, count).uniform()}, seed, stream};
  std::vector<Vec2f> points;
  points.reserve(count);
  for (std::size_t k = 0; k < map.area(); ++k) {
    const std::uint64_t until = draw.until(before[k + 1]);
    while (points.size() < until) points.push_back(draw.point(points.size(), order.cell(k)));
  }
  assert(points.size() == count);
  return points;
}

}  // namespace abn
