// reach_by_block() on a device of relaxation.h: the largest s in blocks, in blocks of those, and so on, then from the
// coarsest down how far every block has to look.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampling/hd.h"
#include "sampling/sph/reach.h"
#include "sampling/vec.h"

namespace abn::sph_cuda {

/// The largest s at the corners of every finest block's squares.
struct FindFinestBlocks {
  const float* s;
  Extent squares;
  std::uint32_t blocks_x;
  float* most;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t first_x = i % blocks_x * sph::reach_block;
    const std::uint32_t first_y = i / blocks_x * sph::reach_block;
    float largest = 0;
    for (std::uint32_t y = first_y; y <= first_y + sph::reach_block && y <= squares.height; ++y) {
      const float* line = s + std::size_t{y < squares.height ? y : 0} * squares.width;
      for (std::uint32_t x = first_x; x <= first_x + sph::reach_block && x <= squares.width; ++x) {
        const float here = line[x < squares.width ? x : 0];
        largest = here > largest ? here : largest;
      }
    }
    most[i] = largest;
  }
};

/// The largest value in every block of side x side values.
struct FindCoarserBlocks {
  const float* fine;
  Extent size;  // of `fine`
  std::uint32_t side;
  std::uint32_t blocks_x;
  float* most;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t first_x = i % blocks_x * side;
    const std::uint32_t first_y = i / blocks_x * side;
    float largest = 0;
    for (std::uint32_t y = first_y; y < first_y + side && y < size.height; ++y) {
      for (std::uint32_t x = first_x; x < first_x + side && x < size.width; ++x) {
        const float here = fine[std::size_t{y} * size.width + x];
        largest = here > largest ? here : largest;
      }
    }
    most[i] = largest;
  }
};

/// The largest s that a particle of a block may meet.
struct DilateBlocks {
  const float* most;  // [along.count * across.count]
  sph::BlockAxis along, across;
  const float* bound;  // of what is found, by blocks of bound_side of these
  std::uint32_t bound_side, bounds_x;
  double half_support;
  float* reach;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t x = i % along.count;
    const std::uint32_t y = i / along.count;
    const float own = most[i];
    const float furthest = bound[std::size_t{y / bound_side} * bounds_x + x / bound_side];
    const double radius = sph::reach_distance(half_support, own, furthest);
    float largest = own;
    across.for_each_near(y, radius, [&](std::uint32_t row, double gap_y) {
      const float* line = most + std::size_t{row} * along.count;
      along.for_each_near(x, radius, [&](std::uint32_t column, double gap_x) {
        const float there = line[column];
        if (!(there > largest)) return;
        const double near = sph::reach_distance(half_support, own, there);
        if (gap_x + gap_y < near * near) largest = there;
      });
    });
    reach[i] = largest;
  }
};

template <class Device>
class ReachEngine {
 public:
  /// s on the device, periodic. Leaves the answer in reach(), by blocks of reach_block squares a side.
  void find(Device& device, const float* s, Extent squares, double cell_x, double cell_y, double support) {
    Extent count = blocks_over(squares, sph::reach_block);
    std::uint32_t side = sph::reach_block;
    std::size_t last = 0;
    for (;; ++last, count = blocks_over(count, sph::reach_factor), side *= sph::reach_factor) {
      if (last == levels_.size()) levels_.emplace_back();
      Level& level = levels_[last];
      level.along = {count.width, side, squares.width, cell_x};
      level.across = {count.height, side, squares.height, cell_y};
      for (auto* buffer : {&level.most, &level.reach}) buffer->reset(count.area());
      const auto blocks = static_cast<std::uint32_t>(count.area());
      if (last == 0) {
        device.launch(blocks, FindFinestBlocks{s, squares, count.width, level.most.data()});
      } else {
        Level& finer = levels_[last - 1];
        device.launch(blocks, FindCoarserBlocks{finer.most.data(), finer.count(), sph::reach_factor, count.width,
                                                level.most.data()});
      }
      if (std::max(count.width, count.height) <= 2 * sph::reach_factor) break;
    }
    // The few blocks of the coarsest level look as far as the largest s of all.
    const std::uint32_t whole = std::max(count.width, count.height);
    largest_.reset(1);
    device.launch(1, FindCoarserBlocks{levels_[last].most.data(), count, whole, 1, largest_.data()});
    for (std::size_t k = last + 1; k-- > 0;) {
      Level& level = levels_[k];
      const bool coarsest = k == last;
      device.launch(
          static_cast<std::uint32_t>(level.count().area()),
          DilateBlocks{level.most.data(), level.along, level.across,
                       coarsest ? largest_.data() : levels_[k + 1].reach.data(), coarsest ? whole : sph::reach_factor,
                       coarsest ? 1 : levels_[k + 1].along.count, support / 2, level.reach.data()});
    }
  }
  const float* reach() const { return levels_.front().reach.data(); }
  Extent blocks() const { return levels_.front().count(); }

 private:
  using Floats = typename Device::template Buffer<float>;
  struct Level {
    sph::BlockAxis along, across;
    Floats most, reach;
    Extent count() const { return {along.count, across.count}; }
  };

  static Extent blocks_over(Extent size, std::uint32_t side) {
    return {(size.width + side - 1) / side, (size.height + side - 1) / side};
  }

  std::vector<Level> levels_;
  Floats largest_;
};

}  // namespace abn::sph_cuda
