// The kernels that prepare a size field: the formulas are those of sampling/sph/size_field_steps.h.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/mean_inverse_square.h"
#include "sampling/sph/raster_border.h"
#include "sampling/sph/reach.h"
#include "sampling/sph/size_field_steps.h"
#include "sampling/sph/tile_density.h"
#include "sampling/vec.h"
#include "sph_cuda/sum_in_turn.h"

namespace abn::sph_cuda {

/// The extremes of every row, and then of every column: FindExtremes with as many blocks as one wants of them.
struct LinesOfRaster {
  const float* s;
  Extent size;
  Extremes* line;
  ABN_HD std::uint32_t count(std::uint32_t block) const { return block < size.height ? size.width : size.height; }
  ABN_HD Extremes value(std::uint32_t block, std::uint32_t i) const {
    const bool row = block < size.height;
    const float here = s[row ? std::size_t{block} * size.width + i : std::size_t{i} * size.width + block - size.height];
    return {here, here};
  }
  ABN_HD void store(std::uint32_t block, const Extremes& extremes) const { line[block] = extremes; }
};

/// What brings the largest value of all rows to 1: one block.
struct LargestToOne {
  const Extremes* row;
  std::uint32_t rows;
  double* factor;
  ABN_HD std::uint32_t count(std::uint32_t) const { return rows; }
  ABN_HD Extremes value(std::uint32_t, std::uint32_t i) const { return row[i]; }
  ABN_HD void store(std::uint32_t, const Extremes& all) const { *factor = 1.0 / static_cast<double>(all.largest); }
};

struct ScaleSizes {
  const float* from;
  const double* factor;
  double largest;  // [d]
  float* to;       // may be `from`
  ABN_HD void operator()(std::uint32_t i) const { to[i] = sph::scaled_size(from[i], *factor, largest); }
};

/// mean_inverse_square() of a row of squares between cell centres; without periodicity there is one square more in
/// every row, and one row more, and those at the ends count half. SumInTurn with a block per row.
struct RowsOfSquares {
  const float* s;
  Extent size;
  bool periodic;
  double* sum;  // [rows]
  ABN_HD std::uint32_t rows() const { return size.height + (periodic ? 0 : 1); }
  ABN_HD std::uint32_t count(std::uint32_t) const { return size.width + (periodic ? 0 : 1); }
  ABN_HD double value(std::uint32_t row, std::uint32_t i) const {
    const std::int64_t before = periodic ? 0 : 1;
    const float* top = line(row - before);
    const float* below = line(row - before + 1);
    const std::uint32_t left = sph::beyond_border(i - before, size.width, periodic);
    const std::uint32_t right = sph::beyond_border(i - before + 1, size.width, periodic);
    const double mean = sph::mean_inverse_square(static_cast<double>(top[left]), static_cast<double>(top[right]),
                                                 static_cast<double>(below[left]), static_cast<double>(below[right]));
    return !periodic && (i == 0 || i == size.width) ? mean * 0.5 : mean;
  }
  ABN_HD void store(std::uint32_t row, double total) const {
    sum[row] = !periodic && (row == 0 || row == size.height) ? total * 0.5 : total;
  }

 private:
  ABN_HD const float* line(std::int64_t y) const {
    return s + std::size_t{sph::beyond_border(y, size.height, periodic)} * size.width;
  }
};

/// What brings their mean to 1: one block.
struct MeanToOne {
  const double* sum;
  std::uint32_t rows;
  double area;  // [cells]
  double* factor;
  ABN_HD std::uint32_t count(std::uint32_t) const { return rows; }
  ABN_HD double value(std::uint32_t, std::uint32_t i) const { return sum[i]; }
  ABN_HD void store(std::uint32_t, double total) const { *factor = std::sqrt(total / area); }
};

struct ReduceSizes {
  const float* s;
  Extent from, to;
  float* reduced;
  ABN_HD void operator()(std::uint32_t i) const {
    reduced[i] = sph::reduced_size(s, from, to, i % to.width, i / to.width);
  }
};

/// Some rounds of limit_gradient() on a square of cells. A value falls to the lowest that its eight neighbours allow,
/// again and again; in whatever order that is done it ends at the same values, the largest that allow each other: so
/// every block goes on alone for a while, with the neighbours of its square as they were.
struct LimitGradient {
  static constexpr std::uint32_t threads = 256;
  static constexpr std::uint32_t side = 32;    // cells of a square
  static constexpr std::uint32_t width = 34;   // with those around it
  static constexpr std::uint32_t rounds = 32;  // even: the result is where the first values were
  struct Shared {
    float value[2][width * width];
    std::uint32_t lowered[rounds + 1];  // 1 = by this round
  };

  const float* from;
  float* to;
  Extent size;
  sph::GradientSteps step;
  bool periodic;
  const std::uint32_t* before;  // 0 = the last launch lowered nothing, and `to` is as it should be; null = go on
  std::uint32_t* lowered;       // set to 1 if this one does

  std::uint32_t blocks() const { return columns() * ((size.height - 1) / side + 1); }
  ABN_HD int phases(std::uint32_t) const {
    return before != nullptr && *before == 0 ? 0 : static_cast<int>(rounds) + 2;
  }
  std::size_t shared_bytes() const { return sizeof(Shared); }
  ABN_HD void operator()(int phase, std::uint32_t block, std::uint32_t thread, void* memory) const {
    auto& shared = *static_cast<Shared*>(memory);
    const std::uint32_t first_x = block % columns() * side;
    const std::uint32_t first_y = block / columns() * side;
    if (phase == 0) {
      load(shared, first_x, first_y, thread);
      return;
    }
    const auto round = static_cast<std::uint32_t>(phase);
    if (round <= rounds && round > 1 && shared.lowered[round - 1] == 0) return;  // both copies are the same
    for (std::uint32_t k = thread; k < side * side; k += threads) {
      const std::uint32_t x = k % side;
      const std::uint32_t y = k / side;
      if (first_x + x >= size.width || first_y + y >= size.height) continue;
      const std::uint32_t place = (y + 1) * width + x + 1;
      if (round > rounds) {
        to[std::size_t{first_y + y} * size.width + first_x + x] = shared.value[0][place];
      } else {
        const float* value = shared.value[(round + 1) % 2];
        const float limit = limit_at(value + place);
        if (limit < value[place]) shared.lowered[round] = 1;
        shared.value[round % 2][place] = limit < value[place] ? limit : value[place];
      }
    }
    if (round > rounds && thread == 0 && shared.lowered[1] != 0) *lowered = 1;
  }

 private:
  ABN_HD std::uint32_t columns() const { return (size.width - 1) / side + 1; }
  ABN_HD void load(Shared& shared, std::uint32_t first_x, std::uint32_t first_y, std::uint32_t thread) const {
    for (std::uint32_t k = thread; k < width * width; k += threads) {
      const std::uint32_t x = sph::beyond_border(std::int64_t{first_x} + k % width - 1, size.width, periodic);
      const std::uint32_t y = sph::beyond_border(std::int64_t{first_y} + k / width - 1, size.height, periodic);
      shared.value[0][k] = shared.value[1][k] = from[std::size_t{y} * size.width + x];
    }
    if (thread <= rounds) shared.lowered[thread] = 0;
  }
  /// The most that the neighbours allow.
  ABN_HD float limit_at(const float* value) const {
    const float* above = value - width;
    const float* below = value + width;
    const float beside = lesser(value[-1], value[1]) + step.x;
    return lesser(beside, lesser(limit_from(above), limit_from(below)));
  }
  ABN_HD float limit_from(const float* row) const {
    return lesser(row[0] + step.y, lesser(row[-1], row[1]) + step.diagonal);
  }
  ABN_HD static float lesser(float a, float b) { return b < a ? b : a; }
};

/// The plane's cells on the torus.
struct ExtendSizes {
  const float* s;
  Extent plane;
  std::uint32_t ring_x, ring_y;
  float* extended;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t width = plane.width + 2 * ring_x;
    const std::uint32_t x = sph::cell_on_plane(i % width, plane.width, ring_x);
    const std::uint32_t y = sph::cell_on_plane(i / width, plane.height, ring_y);
    extended[i] = s[std::size_t{y} * plane.width + x];
  }
};

struct MakeFieldCells {
  const float* s;
  const float* reach;  // by block
  std::uint32_t width;
  std::uint32_t blocks_x;
  sph::FieldCell* cells;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t block_x = i % width / sph::reach_block;
    const std::uint32_t block_y = i / width / sph::reach_block;
    cells[i] = sph::field_cell(s[i], reach[std::size_t{block_y} * blocks_x + block_x]);
  }
};

/// tile_densities(): SumInTurn with a block per tile.
struct RectanglesOfTiles {
  sph::TileRectangles rectangles;
  const std::uint32_t* column;        // of rectangles, tile by tile
  const std::uint32_t* column_start;  // [tiles_x + 1]
  const std::uint32_t* row;
  const std::uint32_t* row_start;  // [tiles_y + 1]
  std::uint32_t tiles_x;
  double* density;  // [tiles]
  ABN_HD std::uint32_t count(std::uint32_t tile) const { return columns(tile) * rows(tile); }
  ABN_HD double value(std::uint32_t tile, std::uint32_t i) const {
    const std::uint32_t x = column[column_start[tile % tiles_x] + i % columns(tile)];
    const std::uint32_t y = row[row_start[tile / tiles_x] + i / columns(tile)];
    return rectangles.mean(x, y);
  }
  ABN_HD void store(std::uint32_t tile, double total) const {
    density[tile] = total / static_cast<double>(count(tile));
  }

 private:
  ABN_HD std::uint32_t columns(std::uint32_t tile) const {
    return column_start[tile % tiles_x + 1] - column_start[tile % tiles_x];
  }
  ABN_HD std::uint32_t rows(std::uint32_t tile) const {
    return row_start[tile / tiles_x + 1] - row_start[tile / tiles_x];
  }
};

}  // namespace abn::sph_cuda
