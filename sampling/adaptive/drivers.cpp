#include "sampling/adaptive/drivers.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "sampling/adaptive/local_variance.h"
#include "sampling/adaptive/map_rules.h"
#include "sampling/adaptive/pixel_variance.h"
#include "sampling/rng.h"
#include "sampling/sobol2d.h"
#include "sampling/sph/fixed_sum.h"

namespace abn {
namespace {

std::uint32_t cell_of(float at, std::uint32_t side, std::uint32_t cells) {
  const auto cell = static_cast<std::uint32_t>(at / static_cast<float>(side) * static_cast<float>(cells));
  return std::min(cell, cells - 1);
}

}  // namespace

Grid<float> local_mean(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                       Extent plane, Extent map, int reach) {
  assert(value.size() == position.size() * channels);
  Grid<float> sum(map);
  Grid<float> count(map);
  double total = 0;
  for (std::size_t i = 0; i < position.size(); ++i) {
    float mean = 0;
    for (std::uint32_t c = 0; c < channels; ++c) mean += value[i * channels + c] / static_cast<float>(channels);
    const std::size_t cell =
        sum.index(cell_of(position[i].x, plane.width, map.width), cell_of(position[i].y, plane.height, map.height));
    sum[cell] += mean;
    count[cell] += 1;
    total += double{mean};
  }
  const auto overall = static_cast<float>(position.empty() ? 0.0 : total / static_cast<double>(position.size()));
  Grid<float> result(map, overall);
  Grid<float> known(map);
  // Wider and wider: a cell takes the narrowest bell that has met a sample's share worth speaking of.
  for (int passes = reach * reach; passes > 0 && passes <= 4096; passes *= 4) {
    blur(sum, passes);
    blur(count, passes);
    bool complete = true;
    for (std::size_t i = 0; i < map.area(); ++i) {
      if (known[i] > 0) continue;
      if (count[i] > 1e-3F) {
        result[i] = sum[i] / count[i];
        known[i] = 1;
      } else {
        complete = false;
      }
    }
    if (complete) break;
  }
  return result;
}

Grid<float> squared_gradient(const Grid<float>& map) {
  const Extent size = map.size();
  Grid<float> result(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const std::uint32_t above = y > 0 ? y - 1 : y;
    const std::uint32_t below = std::min(y + 1, size.height - 1);
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const std::uint32_t left = x > 0 ? x - 1 : x;
      const std::uint32_t right = std::min(x + 1, size.width - 1);
      const float dx = right > left ? (map.at(right, y) - map.at(left, y)) / static_cast<float>(right - left) : 0;
      const float dy = below > above ? (map.at(x, below) - map.at(x, above)) / static_cast<float>(below - above) : 0;
      result.at(x, y) = dx * dx + dy * dy;
    }
  }
  return result;
}

Grid<float> both_drivers(const Grid<float>& a, const Grid<float>& b, double exponent, double share) {
  assert(a.size() == b.size() && exponent > 0);
  const std::size_t cells = a.cells().size();
  const auto part_of = [&](const Grid<float>& map, double part) {
    const double sum =
        sph::fixed_order_sum(cells, [&](std::size_t i) { return driver_power(double{map[i]}, exponent); });
    return sum > 0 ? part * static_cast<double>(cells) / sum : 0;
  };
  const double part_a = part_of(a, 1 - share);
  const double part_b = part_of(b, share);
  Grid<float> both(a.size());
  for (std::size_t i = 0; i < cells; ++i) both[i] = both_drivers(a[i], b[i], part_a, part_b, exponent);
  return both;
}

std::vector<Vec2f> draw_per_pixel(const Grid<float>& density, std::uint64_t count, Extent plane, std::uint64_t seed) {
  assert(count >= plane.area());
  const Grid<float> per_pixel = resampled(density, plane);
  const std::uint64_t extra = count - plane.area();
  double total = 0;
  for (const float n : per_pixel.cells()) total += std::max(0.0, double{n} - 1);
  const bool flat = !(total > 0);
  if (flat) total = static_cast<double>(plane.area());
  const std::uint32_t stream = stream_id("sph_adaptive per pixel");
  const double offset = double{Rng(seed, stream, plane.area()).uniform()};
  std::vector<Vec2f> points;
  points.reserve(count);
  double before = 0;
  std::uint64_t given = 0;
  for (std::size_t p = 0; p < plane.area(); ++p) {
    before += flat ? 1 : std::max(0.0, double{per_pixel[p]} - 1);
    auto until = static_cast<std::uint64_t>(before / total * static_cast<double>(extra) + offset);
    until = p + 1 == plane.area() ? extra : std::min(until, extra);
    const std::uint64_t here = 1 + until - given;
    given = until;
    Rng rng(seed, stream, p);
    const std::uint32_t seed_x = rng.next();
    const std::uint32_t seed_y = rng.next();
    for (std::uint32_t k = 0; k < here; ++k) {
      const Vec2f unit{unit_float(reverse_bits(owen_hash(k, seed_x))),
                       unit_float(reverse_bits(owen_hash(pascal_bits(k), seed_y)))};
      points.push_back(
          to_pixel(unit, static_cast<std::uint32_t>(p % plane.width), static_cast<std::uint32_t>(p / plane.width)));
    }
  }
  return points;
}

}  // namespace abn
