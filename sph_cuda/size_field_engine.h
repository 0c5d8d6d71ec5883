// prepare_size_field() on a device of relaxation.h, but the background force.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sampling/sph/size_field.h"
#include "sampling/sph/size_field_steps.h"
#include "sampling/sph/tile_density.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/reach_engine.h"
#include "sph_cuda/size_field_kernels.h"
#include "sph_cuda/sum_in_turn.h"

namespace abn::sph_cuda {

template <class Device>
class SizeFieldEngine {
 public:
  /// s [map] on the device: finite and > 0 everywhere; it stays as it is. options.background must be off.
  void prepare(Device& device, const float* s, Extent map, const sph::FieldOptions& options) {
    assert(!options.background && map.area() > 0);
    assert(map.area() <= 0xFFFFFFFFU);
    size_ = map;
    periodic_ = !options.walls;
    most_ = sph::largest_spacing(options);
    factor_.reset(1);
    s_.reset(map.area());
    normalise(device, s);
    reduce(device, options);
    const sph::GradientSteps step =
        sph::gradient_steps(options.length_x / size_.width, options.length_y / size_.height, options.gradient_limit);
    for (int round = 0; round < sph::limit_rounds && limit_gradient(device, step); ++round) {
      normalise(device, s_.data());
    }
    lay_out(device, options);
    if (!field_.uniform) {
      make_cells(device, options.support);
      find_tile_density(device);
    } else {
      tile_density_.clear();
    }
  }

  /// Without its cells.
  const sph::SizeField& field() const { return field_; }
  /// Those, on the device [field().width * field().height]; to be read only if the field is not uniform. They stay
  /// until the next call.
  sph::FieldCell* cells() { return cells_.data(); }
  const sph::FieldCell* cells() const { return cells_.data(); }
  /// tile_densities(); empty if uniform.
  const std::vector<double>& tile_density() const { return tile_density_; }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  std::uint32_t area() const { return static_cast<std::uint32_t>(size_.area()); }

  /// normalised_size_field() from `s` into s_, which it may be.
  void normalise(Device& device, const float* s) {
    lines_.reset(std::size_t{size_.height} + size_.width);
    device.launch_blocks(size_.height, FindExtremes<LinesOfRaster>{{s, size_, lines_.data()}});
    device.launch_blocks(1, FindExtremes<LargestToOne>{{lines_.data(), size_.height, factor_.data()}});
    device.launch(area(), ScaleSizes{s, factor_.data(), 1.0, s_.data()});
    for (int time = 0; time < 2; ++time) {
      const std::uint32_t rows = size_.height + (periodic_ ? 0 : 1);
      sums_.reset(rows);
      device.launch_blocks(rows, SumInTurn<RowsOfSquares>{{s_.data(), size_, periodic_, sums_.data()}});
      device.launch_blocks(
          1, SumInTurn<MeanToOne>{{sums_.data(), rows, static_cast<double>(size_.area()), factor_.data()}});
      device.launch(area(), ScaleSizes{s_.data(), factor_.data(), most_, s_.data()});
    }
  }

  void reduce(Device& device, const sph::FieldOptions& options) {
    device.launch_blocks(size_.height, FindExtremes<LinesOfRaster>{{s_.data(), size_, lines_.data()}});
    const auto least = static_cast<double>(extremes_of(lines_.download(size_.height)).smallest);
    const std::uint32_t factor_x = sph::reduction(least, options.length_x, size_.width);
    const std::uint32_t factor_y = sph::reduction(least, options.length_y, size_.height);
    if (factor_x <= 1 && factor_y <= 1) return;
    const Extent finer = std::exchange(size_, sph::reduced_extent(size_, factor_x, factor_y));
    other_.reset(size_.area());
    device.launch(area(), ReduceSizes{s_.data(), finer, size_, other_.data()});
    std::swap(s_, other_);
    normalise(device, s_.data());
  }

  /// Whether anything had to be lowered.
  bool limit_gradient(Device& device, const sph::GradientSteps& step) {
    constexpr std::uint32_t batch = 4;  // launches between two looks at what they did; even, so that s_ is the result
    other_.reset(size_.area());
    lowered_.reset(batch);
    bool ever = false;
    for (bool more = true; more;) {
      device.launch(batch, Fill<std::uint32_t>{lowered_.data(), 0});
      for (std::uint32_t k = 0; k < batch; ++k) {
        const LimitGradient body{
            s_.data(),          other_.data(), size_, step, periodic_, k == 0 ? nullptr : lowered_.data() + k - 1,
            lowered_.data() + k};
        device.launch_blocks(body.blocks(), body);
        std::swap(s_, other_);
      }
      const std::vector<std::uint32_t> lowered = lowered_.download(batch);
      ever = ever || lowered.front() != 0;
      more = lowered.back() != 0;
    }
    return ever;
  }

  /// Decides on uniformity and ring, and puts the raster on the torus.
  void lay_out(Device& device, const sph::FieldOptions& options) {
    const std::uint32_t lines = size_.height + (options.walls ? size_.width : 0);
    device.launch_blocks(lines, FindExtremes<LinesOfRaster>{{s_.data(), size_, lines_.data()}});
    const std::vector<Extremes> line = lines_.download(lines);
    const Extremes all = extremes_of({line.begin(), line.begin() + std::ptrdiff_t{size_.height}});
    if (all.smallest == all.largest) {
      field_ = sph::uniform_size_field(options);
      return;
    }
    const auto ring = [&](std::uint32_t first, std::uint32_t cells, double length) {
      const auto largest_at = [&](std::uint32_t depth) {
        return std::max(line[first + depth].largest, line[first + cells - 1 - depth].largest);
      };
      return sph::ring_cells(sph::ring_width(options, cells, length / cells, largest_at), length / cells);
    };
    const std::uint32_t ring_x = options.walls ? ring(size_.height, size_.width, options.length_x) : 0;
    const std::uint32_t ring_y = options.walls ? ring(0, size_.height, options.length_y) : 0;
    field_ = sph::laid_out_field(options, size_, ring_x, ring_y);
    field_.smallest = static_cast<double>(all.smallest);
    field_.largest = static_cast<double>(all.largest);
    if (!options.walls) return;
    const Extent plane = std::exchange(size_, Extent{field_.width, field_.height});
    other_.reset(size_.area());
    device.launch(area(), ExtendSizes{s_.data(), plane, ring_x, ring_y, other_.data()});
    std::swap(s_, other_);
  }

  void make_cells(Device& device, double support) {
    reach_.find(device, s_.data(), size_, field_.length_x / field_.width, field_.length_y / field_.height, support);
    cells_.reset(size_.area());
    device.launch(area(), MakeFieldCells{s_.data(), reach_.reach(), size_.width, reach_.blocks().width, cells_.data()});
  }

  void find_tile_density(Device& device) {
    const sph::TileLayout layout = sph::lay_out_tiles(field_);
    upload_by_tile(layout.tile_of_column, layout.tiles_x, column_, column_start_);
    upload_by_tile(layout.tile_of_row, layout.tiles_y, row_, row_start_);
    sph::FieldView<double> view = field_.view<double>();
    view.cells = cells_.data();
    const std::uint32_t tiles = layout.tiles_x * layout.tiles_y;
    density_.reset(tiles);
    device.launch_blocks(tiles,
                         SumInTurn<RectanglesOfTiles>{{{view, static_cast<std::uint32_t>(layout.tile_of_column.size()),
                                                        static_cast<std::uint32_t>(layout.tile_of_row.size())},
                                                       column_.data(),
                                                       column_start_.data(),
                                                       row_.data(),
                                                       row_start_.data(),
                                                       layout.tiles_x,
                                                       density_.data()}});
    tile_density_ = density_.download(tiles);
  }

  static Extremes extremes_of(const std::vector<Extremes>& lines) {
    Extremes all;
    for (const Extremes& line : lines) all.include(line);
    return all;
  }

  /// The indices of every tile's columns (or rows), rising, tile by tile; where each tile's begin.
  static void upload_by_tile(const std::vector<std::uint32_t>& tile_of, std::uint32_t tiles,
                             Buffer<std::uint32_t>& index, Buffer<std::uint32_t>& start) {
    std::vector<std::uint32_t> first(std::size_t{tiles} + 1);
    for (const std::uint32_t tile : tile_of) ++first[tile + 1];
    for (std::uint32_t tile = 0; tile < tiles; ++tile) first[tile + 1] += first[tile];
    start.reset(first.size());
    start.upload(first);
    std::vector<std::uint32_t> indices(tile_of.size());
    for (std::uint32_t i = 0; i < tile_of.size(); ++i) indices[first[tile_of[i]]++] = i;
    index.reset(indices.size());
    index.upload(indices);
  }

  Extent size_;  // of s_
  bool periodic_ = true;
  double most_ = 1;
  sph::SizeField field_;
  std::vector<double> tile_density_;
  ReachEngine<Device> reach_;
  Buffer<float> s_, other_;
  Buffer<double> factor_, sums_, density_;
  Buffer<Extremes> lines_;  // rows, then columns
  Buffer<std::uint32_t> lowered_, column_, column_start_, row_, row_start_;
  Buffer<sph::FieldCell> cells_;
};

}  // namespace abn::sph_cuda
