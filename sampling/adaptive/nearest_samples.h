// The nearest samples to many places of a bounded plane.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "sampling/vec.h"

namespace abn {

/// Samples in the order of equal cells over the plane, row by row. Opposite sides are not joined: a renderer's image
/// does not go on at its other side.
class NearestSamples {
 public:
  static constexpr int most_neighbours = 32;
  static constexpr int lanes = 8;  // places searched for together

  /// Eight places that should lie close together, and what is near them, nearest first; equal distances by index.
  /// One object serves many searches.
  class Search {
   public:
    std::array<float, lanes> x{};  // [px], inside the plane
    std::array<float, lanes> y{};

    /// How many samples were found: as many as wanted, or all there are.
    int count() const { return count_; }
    /// The index of the k-th nearest to a place, 0 <= k < count().
    std::uint32_t index(int lane, int k) const { return static_cast<std::uint32_t>(bits(lane, k)); }
    /// The squared distance of the k-th nearest [px^2].
    float distance_squared(int lane, int k) const {
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits(lane, k) >> 32) - normal);
    }

   private:
    friend class NearestSamples;
    // A candidate is a double whose upper half is the squared distance as a float's bits and whose lower half is the
    // index: floats >= 0 are ordered as their bits are, so minimum and maximum of two doubles sort by distance, then
    // index. One more in the exponent keeps the doubles of tiny distances out of the slow subnormal numbers.
    static constexpr std::uint32_t normal = 0x00100000U;
    std::uint64_t bits(int lane, int k) const {
      return std::bit_cast<std::uint64_t>(candidate_[static_cast<std::size_t>(k * lanes + lane)]);
    }
    // Farther than every sample: an infinite distance.
    static constexpr double nothing = std::bit_cast<double>(std::uint64_t{0x7F800000U + normal} << 32);
    /// The largest squared distance of a `wanted`-th nearest; infinite while a place has not found so many.
    float farthest(int wanted) const {
      const double* last = candidate_.data() + static_cast<std::ptrdiff_t>(wanted - 1) * lanes;
      return std::bit_cast<float>(
          static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(*std::max_element(last, last + lanes)) >> 32) -
          normal);
    }
    alignas(64) std::array<double, std::size_t{most_neighbours} * lanes> candidate_{};
    int count_ = 0;
    float radius_ = 0;  // that was enough the last time: where to begin [px]
  };

  /// Cells for `per_cell` samples on the average; positions [px] are copied. Precondition: finite positions, fewer than
  /// 2^32 - 1. Positions outside the plane count to the nearest cell, which keeps every search correct.
  NearestSamples(std::span<const Vec2f> position, Extent plane, double per_cell);

  /// The indices of the samples in the order of the cells [number of samples].
  std::span<const std::uint32_t> order() const { return index_; }
  /// From now on samples are known by their place in that order.
  void renumber() { std::iota(index_.begin(), index_.end(), 0U); }
  /// Where in that order the samples of each row of cells begin, and the end [rows + 1].
  std::vector<std::uint32_t> row_begins() const;
  /// How many samples share a cell, on the average over the samples: what a search costs where samples are.
  double crowd() const;

  /// Finds the `wanted` (1 to most_neighbours) samples nearest to every place of `search`. Exact, with distances as
  /// computed in float; where a sample is a place, it finds itself.
  void find(int wanted, Search& search) const;

 private:
  struct Block {
    std::int32_t left, right, top, bottom;  // all included
  };
  struct Places {
    float left, right, top, bottom;  // the box around the eight
    std::int32_t row;                // of cells, in its middle
  };

  std::int32_t column_of(float x) const { return bounded(x * per_width_, columns_); }
  std::int32_t row_of(float y) const { return bounded(y * per_height_, rows_); }
  static std::int32_t bounded(float cell, std::int32_t cells);
  std::size_t cell(std::int32_t row, std::int32_t column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  Block around(const Places& places, float radius) const;
  bool whole(const Block& block) const;
  /// Looks into the cells of `block` that are not in `seen`, those near the places first.
  void scan(const Block& block, const Block& seen, const Places& places, int wanted, Search& search) const;
  void sort(std::span<const Vec2f> position);

  std::int32_t columns_ = 1;
  std::int32_t rows_ = 1;
  float per_width_ = 1;  // [1/px]
  float per_height_ = 1;
  float rounding_ = 0;                // how far rounding may shift a coordinate against the cells' borders [px]
  float spacing_ = 1;                 // mean, of the samples [px]
  std::vector<std::uint32_t> begin_;  // of every cell in the order, and the end
  std::vector<float> x_;              // in the order of the cells
  std::vector<float> y_;
  std::vector<std::uint32_t> index_;
};

}  // namespace abn
