// What happens to one cell of the maps that an adaptive plane follows: for loops on the host and threads of a device.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "sampling/hd.h"
#include "sampling/rng.h"
#include "sampling/vec.h"

namespace abn {

/// The sparsest a pass shall make the plane, relative to the mean density.
inline constexpr float least_share_of_mean = 0.15F;

/// 1-2-1 over a value and those before and after it.
ABN_HD inline float blurred(float before, float here, float after) {
  return (0.25F * before + 0.25F * after) + 0.5F * here;
}

/// A driver raised to the exponent by which density grows with it.
ABN_HD inline double driver_power(double driver, double exponent) {
  return exponent == 0.5 ? std::sqrt(driver) : std::pow(driver, exponent);  // .5 is the rule, and pow() is slow
}

/// What the density of a cell shall be proportional to.
ABN_HD inline float density_weight(float driver, double least, double exponent) {
  return static_cast<float>(driver_power(static_cast<double>(driver) + least, exponent));
}

/// (part_a a^e + part_b b^e)^(1/e), but not above 1e30.
ABN_HD inline float both_drivers(float a, float b, double part_a, double part_b, double exponent) {
  double sum = part_a * driver_power(static_cast<double>(a), exponent);
  sum += part_b * driver_power(static_cast<double>(b), exponent);
  const double both = exponent == 0.5 ? sum * sum : std::pow(sum, 1 / exponent);
  return static_cast<float>(both < 1e30 ? both : 1e30);
}

/// The spacing wanted where the density is `density` [1/px^2]; `least`: what density is at least taken to be, > 0.
ABN_HD inline float spacing_for(float density, float least) { return 1 / std::sqrt(density > least ? density : least); }

/// The density of a cell that is filled up to scale * weight, but not above `most` nor below what it has.
ABN_HD inline float filled(double scale, float weight, float have, double most) {
  const double wanted = scale * static_cast<double>(weight);
  const auto density = static_cast<float>(wanted < most ? wanted : most);
  return density < have ? have : density;
}

/// What filling a map must know of it.
struct MapRange {
  double have = 0;                                     // sum over the cells
  float largest = 0;                                   // weight
  float smallest = std::numeric_limits<float>::max();  // weight above 0
};

/// Of two parts of a map together.
ABN_HD inline void accumulate(MapRange& sum, const MapRange& value) {
  sum.have += value.have;
  sum.largest = value.largest > sum.largest ? value.largest : sum.largest;
  sum.smallest = value.smallest < sum.smallest ? value.smallest : sum.smallest;
}

/// Finds the scale at which filled() adds up to what is wanted, by bisection of its logarithm: from nothing added to
/// everything full. Whoever uses it sums filled() over the map for `scale` and tells the sum, until it is done.
class FillSearch {
 public:
  double scale = 0;  // 0: what is there stays
  double most = 0;
  bool done = true;

  FillSearch() = default;
  /// wanted: sum over the cells.
  ABN_HD FillSearch(const MapRange& range, double wanted, double most_density) : most(most_density), wanted_(wanted) {
    done = wanted <= range.have || !(range.largest > 0);
    if (done) return;
    low_ = std::log(most / static_cast<double>(range.largest)) - 40;
    high_ = std::log(most / static_cast<double>(range.smallest));
    scale = std::exp(high_);
  }
  ABN_HD void take(double sum) {
    if (done) return;
    if (step_ == 0) {
      done = sum <= wanted_;  // does not fit: everything is full
      if (done) return;
    } else {
      (sum > wanted_ ? high_ : low_) = middle_;
    }
    done = step_ == 40 || !(high_ - low_ > 1e-6);
    ++step_;
    middle_ = 0.5 * (low_ + high_);
    scale = std::exp(done ? low_ : middle_);
  }

 private:
  double wanted_ = 0, low_ = 0, high_ = 0, middle_ = 0;
  int step_ = 0;
};

/// The order in which a map's cells are dealt points: strips of 16 rows, each column by column in turns down and up,
/// so that cells near in the order are near on the map.
class StripOrder {
 public:
  ABN_HD explicit StripOrder(Extent map) : map_(map) {}
  struct Cell {
    std::uint32_t x, y;
  };
  ABN_HD Cell cell(std::uint64_t k) const {
    const std::uint64_t of_strip = std::uint64_t{rows_} * map_.width;
    const auto strip = static_cast<std::uint32_t>(k / of_strip);
    const auto within = static_cast<std::uint32_t>(k - strip * of_strip);
    const std::uint32_t top = strip * rows_;
    const std::uint32_t rows = map_.height - top < rows_ ? map_.height - top : rows_;
    const std::uint32_t column = within / rows;
    const std::uint32_t row = within - column * rows;
    return {strip % 2 == 0 ? column : map_.width - 1 - column, top + (column % 2 == 0 ? row : rows - 1 - row)};
  }

 private:
  static constexpr std::uint32_t rows_ = 16;
  Extent map_;
};

/// How many samples a cell lacks, up to a constant.
ABN_HD inline double deficit(float wanted, float have) {
  const double lack = static_cast<double>(wanted) - static_cast<double>(have);
  return lack > 0 ? lack : 0;
}

/// `count` points dealt to the cells of a map in proportion to their deficit, by running rounding.
struct DeficitDraw {
  Extent plane, map;
  std::uint64_t count = 0;
  double total = 0;   // of all deficits
  double offset = 0;  // of the rounding, in [0,1)
  std::uint64_t seed = 0;
  std::uint32_t stream = 0;

  /// How many points lie in cells that have together the deficit `before`.
  ABN_HD std::uint64_t until(double before) const {
    const auto points = static_cast<std::uint64_t>(before / total * static_cast<double>(count) + offset);
    return points < count ? points : count;
  }
  /// Point k, which lies in that cell.
  ABN_HD Vec2f point(std::uint64_t k, StripOrder::Cell cell) const {
    const Vec2f unit = Rng(seed, stream, k).uniform2();
    const float x =
        (static_cast<float>(cell.x) + unit.x) * (static_cast<float>(plane.width) / static_cast<float>(map.width));
    const float y =
        (static_cast<float>(cell.y) + unit.y) * (static_cast<float>(plane.height) / static_cast<float>(map.height));
    const float right = just_below(static_cast<float>(plane.width));
    const float bottom = just_below(static_cast<float>(plane.height));
    return {x < right ? x : right, y < bottom ? y : bottom};
  }
};

}  // namespace abn
