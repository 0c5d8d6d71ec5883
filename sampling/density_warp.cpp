#include "sampling/density_warp.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "sampling/error.h"

namespace abn {
namespace {

// A cell must hold many floats, or a position in it may not be representable.
constexpr std::uint32_t max_side = 1U << 20;

/// Where `target` lies in a cumulative sum: which step, and how far in it, in [0,1].
struct Inverse {
  std::uint32_t step = 0;
  double fraction = 0;
};

/// `ends` are cumulative ends of the steps, not falling, the last one > 0; 0 <= target <= last. Steps without
/// mass are never chosen.
Inverse invert(std::span<const double> ends, double target) {
  auto end = std::upper_bound(ends.begin(), ends.end(), target);
  // Rounding up to the total: the last step with mass.
  if (end == ends.end()) end = std::lower_bound(ends.begin(), ends.end(), ends.back());
  const double before = end == ends.begin() ? 0.0 : *(end - 1);
  return {static_cast<std::uint32_t>(end - ends.begin()), std::min((target - before) / (*end - before), 1.0)};
}

/// The float nearest to (cell + fraction) / cells that lies in that cell, whether a reader multiplies in float or in
/// double: rounding must not carry a point into a neighbour where the density may be 0.
float coordinate(Inverse inverse, std::uint32_t cells) {
  const double count = cells;
  const double cell = inverse.step;
  const auto in_float = [&](float value) { return std::floor(static_cast<double>(value * static_cast<float>(cells))); };
  const auto in_double = [&](float value) { return std::floor(static_cast<double>(value) * count); };
  auto value = static_cast<float>((cell + inverse.fraction) / count);
  while (in_float(value) > cell || in_double(value) > cell) value = just_below(value);
  while (in_float(value) < cell || in_double(value) < cell) value = std::nextafter(value, 1.0F);
  return value;
}

}  // namespace

DensityWarp::DensityWarp(const Grid<float>& density) : size_(density.size()) {
  if (size_.area() == 0) throw ConfigError("the density has no cells; give an image with at least one");
  if (size_.width > max_side || size_.height > max_side) {
    throw ConfigError("the density is " + std::to_string(size_.width) + "x" + std::to_string(size_.height) +
                      "; give at most " + std::to_string(max_side) + " cells a side");
  }
  std::size_t bad = 0;
  std::size_t first_bad = 0;
  for (std::size_t i = density.cells().size(); i-- > 0;) {
    if (!(density[i] >= 0) || !std::isfinite(density[i])) {
      ++bad;
      first_bad = i;
    }
  }
  if (bad > 0) {
    throw ConfigError("the density has " + std::to_string(bad) + " negative or non-finite cells, the first at (" +
                      std::to_string(first_bad % size_.width) + ", " + std::to_string(first_bad / size_.width) +
                      "); give finite values >= 0");
  }

  cell_ends_.resize(size_.area());
  row_ends_.resize(size_.height);
  double total = 0;
  for (std::uint32_t y = 0; y < size_.height; ++y) {
    double row = 0;
    for (std::uint32_t x = 0; x < size_.width; ++x) {
      row += static_cast<double>(density.at(x, y));
      cell_ends_[density.index(x, y)] = row;
    }
    total += row;
    row_ends_[y] = total;
  }
  if (!(total > 0)) throw ConfigError("the density is 0 everywhere; give an image with at least one positive value");
}

Vec2f DensityWarp::operator()(Vec2f unit) const {
  assert(unit.x >= 0 && unit.x < 1 && unit.y >= 0 && unit.y < 1);
  const Inverse row = invert(row_ends_, static_cast<double>(unit.y) * row_ends_.back());
  const auto cells = std::span(cell_ends_).subspan(std::size_t{row.step} * size_.width, size_.width);
  const Inverse column = invert(cells, static_cast<double>(unit.x) * cells.back());
  return {coordinate(column, size_.width), coordinate(row, size_.height)};
}

}  // namespace abn
