#include "sampling/sph/reach.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace abn::sph {
namespace {

/// Blocks of side x side squares over a periodic raster of squares; the last ones may be narrower.
struct Blocks {
  Extent squares;
  std::uint32_t side = 1;
  Grid<float> most;  // the largest s in every block
};

/// The largest s at the corners of every block's squares.
Blocks finest_blocks(const Grid<float>& s, std::uint32_t side) {
  const Extent size = s.size();
  Blocks blocks{size, side, Grid<float>({(size.width + side - 1) / side, (size.height + side - 1) / side})};
  const Extent count = blocks.most.size();
#pragma omp parallel
  {
    std::vector<float> column(std::size_t{size.width} + 1);
#pragma omp for schedule(static)
    for (std::int64_t row = 0; row < std::int64_t{count.height}; ++row) {
      const auto first = static_cast<std::uint32_t>(row) * side;
      std::fill(column.begin(), column.end(), 0.0F);
      for (std::uint32_t y = first; y <= std::min(first + side, size.height); ++y) {
        const float* line = &s.at(0, y < size.height ? y : 0);
        for (std::uint32_t x = 0; x < size.width; ++x) column[x] = std::max(column[x], line[x]);
      }
      column.back() = column.front();
      for (std::uint32_t x = 0; x < count.width; ++x) {
        const auto begin = column.begin() + std::ptrdiff_t{x} * side;
        const auto last = column.begin() + std::min((x + 1) * side, size.width);
        blocks.most.at(x, static_cast<std::uint32_t>(row)) = *std::max_element(begin, last + 1);
      }
    }
  }
  return blocks;
}

Blocks coarser(const Blocks& fine, std::uint32_t factor) {
  const Extent size = fine.most.size();
  Blocks blocks{fine.squares, fine.side * factor,
                Grid<float>({(size.width + factor - 1) / factor, (size.height + factor - 1) / factor})};
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      float& most = blocks.most.at(x / factor, y / factor);
      most = std::max(most, fine.most.at(x, y));
    }
  }
  return blocks;
}

/// The blocks along one axis that are closer than some radius to one of them.
struct Strip {
  std::vector<std::uint32_t> index;
  std::vector<double> squared_gap;  // [d^2]

  void find(const BlockAxis& axis, std::uint32_t block, double radius) {
    index.clear();
    squared_gap.clear();
    axis.for_each_near(block, radius, [&](std::uint32_t i, double gap) {
      index.push_back(i);
      squared_gap.push_back(gap);
    });
  }
};

/// The dilation, from that of blocks a few times as large: it bounds the window that has to be searched.
Grid<float> dilated(const Blocks& blocks, double cell_x, double cell_y, double half_support) {
  const Extent count = blocks.most.size();
  Grid<float> bound({1, 1}, *std::max_element(blocks.most.cells().begin(), blocks.most.cells().end()));
  std::uint32_t bound_side = std::max(count.width, count.height);
  if (bound_side > 2 * reach_factor) {
    bound = dilated(coarser(blocks, reach_factor), cell_x, cell_y, half_support);
    bound_side = reach_factor;
  }
  Grid<float> reach(count);
#pragma omp parallel
  {
    Strip across, along;
#pragma omp for schedule(dynamic, 1)
    for (std::int64_t row = 0; row < std::int64_t{count.height}; ++row) {
      const auto y = static_cast<std::uint32_t>(row);
      for (std::uint32_t x = 0; x < count.width; ++x) {
        const float own = blocks.most.at(x, y);
        const double radius = reach_distance(half_support, own, bound.at(x / bound_side, y / bound_side));
        along.find({count.width, blocks.side, blocks.squares.width, cell_x}, x, radius);
        across.find({count.height, blocks.side, blocks.squares.height, cell_y}, y, radius);
        float most = own;
        for (std::size_t j = 0; j < across.index.size(); ++j) {
          const float* line = &blocks.most.at(0, across.index[j]);
          for (std::size_t i = 0; i < along.index.size(); ++i) {
            const float there = line[along.index[i]];
            if (!(there > most)) continue;
            const double near = reach_distance(half_support, own, there);
            if (along.squared_gap[i] + across.squared_gap[j] < near * near) most = there;
          }
        }
        reach.at(x, y) = most;
      }
    }
  }
  return reach;
}

}  // namespace

Grid<float> reach_by_block(const Grid<float>& s, double cell_x, double cell_y, double support) {
  return dilated(finest_blocks(s, reach_block), cell_x, cell_y, support / 2);
}

}  // namespace abn::sph
