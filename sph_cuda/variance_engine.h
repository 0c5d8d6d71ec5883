// local_variance() on a device of engine.h: samples into cells, then a search in rings of cells for every place.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sampling/adaptive/variance_of_samples.h"
#include "sampling/grid.h"
#include "sampling/hd.h"
#include "sampling/vec.h"
#include "sph_cuda/kernels.h"

namespace abn::sph_cuda {

/// Equal cells over the plane. Opposite sides are not joined.
struct SampleCells {
  std::int32_t columns = 1, rows = 1;
  float per_width = 1, per_height = 1;  // [1/px]
  float width = 1, height = 1;          // of a cell [px]
  float rounding = 0;                   // how far rounding may shift a coordinate against the cells' borders [px]

  ABN_HD std::int32_t column(float x) const { return bounded(x * per_width, columns); }
  ABN_HD std::int32_t row(float y) const { return bounded(y * per_height, rows); }

 private:
  ABN_HD static std::int32_t bounded(float cell, std::int32_t count) {
    return cell > 0 ? (cell < static_cast<float>(count) ? static_cast<std::int32_t>(cell) : count - 1) : 0;
  }
};

struct CountSampleCells {
  SampleCells cells;
  const Vec2f* position;
  std::uint32_t* cell;   // [n]
  std::uint32_t* place;  // [n], in the cell, in no particular order
  std::uint32_t* count;  // [cells + 1], 0 before
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t here = static_cast<std::uint32_t>(cells.row(position[i].y) * cells.columns) +
                               static_cast<std::uint32_t>(cells.column(position[i].x));
    cell[i] = here;
    place[i] = add_atomically(count + here, 1);
  }
};

struct GatherSamples {
  const Vec2f* position;
  const std::uint32_t* cell;
  const std::uint32_t* place;
  const std::uint32_t* cell_start;
  Vec2f* sorted;         // [n]
  std::uint32_t* index;  // [n], of the sample
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t to = cell_start[cell[i]] + place[i];
    sorted[to] = position[i];
    index[to] = i;
  }
};

/// The variance of the samples nearest to a cell of the map; equal distances by index, so that the order in the cells
/// does not matter.
struct FindVariance {
  SampleCells cells;
  const std::uint32_t* cell_start;
  const Vec2f* sorted;
  const std::uint32_t* index;
  const float* value;  // [n * channels]
  std::uint32_t channels;
  std::int32_t wanted;  // 2 <= wanted <= most_variance_samples, at most n
  std::uint32_t map_width;
  double step_x, step_y;  // of the map [px]
  float* variance;        // [map]

  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t map_row = i / map_width;
    const float x = static_cast<float>((i - map_row * map_width + 0.5) * step_x);
    const float y = static_cast<float>((map_row + 0.5) * step_y);
    Nearest nearest;
    const std::int32_t column = cells.column(x);
    const std::int32_t row = cells.row(y);
    for (std::int32_t ring = 0;; ++ring) {
      const std::int32_t left = column - ring;
      const std::int32_t right = column + ring;
      const std::int32_t top = row - ring;
      const std::int32_t bottom = row + ring;
      for (std::int32_t r = top > 0 ? top : 0; r <= bottom && r < cells.rows; ++r) {
        if (r == top || r == bottom) {
          look(r, left, right, x, y, nearest);
        } else {
          look(r, left, left, x, y, nearest);
          look(r, right, right, x, y, nearest);
        }
      }
      if (left <= 0 && top <= 0 && right >= cells.columns - 1 && bottom >= cells.rows - 1) break;
      if (nearest.count < wanted) continue;
      // Nothing that has not been seen is nearer than the nearest side of the rings that is not the plane's border.
      float seen = std::numeric_limits<float>::infinity();
      if (left > 0) seen = least(seen, x - static_cast<float>(left) * cells.width);
      if (top > 0) seen = least(seen, y - static_cast<float>(top) * cells.height);
      if (right < cells.columns - 1) seen = least(seen, static_cast<float>(right + 1) * cells.width - x);
      if (bottom < cells.rows - 1) seen = least(seen, static_cast<float>(bottom + 1) * cells.height - y);
      if (std::sqrt(nearest.distance[wanted - 1]) * (1 + 0x1p-20F) + cells.rounding <= seen) break;
    }
    variance[i] = variance_of_samples(
        wanted, [&](int k) { return nearest.index[k]; }, value, channels);
  }

 private:
  struct Nearest {
    float distance[most_variance_samples];  // squared [px^2], rising
    std::uint32_t index[most_variance_samples];
    std::int32_t count = 0;
  };

  ABN_HD static float least(float a, float b) { return a < b ? a : b; }

  ABN_HD void look(std::int32_t row, std::int32_t first, std::int32_t last, float x, float y, Nearest& nearest) const {
    if (first >= cells.columns || last < 0) return;
    const std::uint32_t* start = cell_start + row * cells.columns;
    const std::uint32_t end = start[(last < cells.columns ? last : cells.columns - 1) + 1];
    for (std::uint32_t k = start[first > 0 ? first : 0]; k < end; ++k) {
      const float dx = sorted[k].x - x;
      const float dy = sorted[k].y - y;
      offer(dx * dx + dy * dy, index[k], nearest);
    }
  }

  ABN_HD void offer(float distance, std::uint32_t sample, Nearest& nearest) const {
    std::int32_t to = nearest.count;
    if (to == wanted) {
      if (!before(distance, sample, nearest, to - 1)) return;
      --to;
    } else {
      ++nearest.count;
    }
    for (; to > 0 && before(distance, sample, nearest, to - 1); --to) {
      nearest.distance[to] = nearest.distance[to - 1];
      nearest.index[to] = nearest.index[to - 1];
    }
    nearest.distance[to] = distance;
    nearest.index[to] = sample;
  }
  ABN_HD static bool before(float distance, std::uint32_t sample, const Nearest& nearest, std::int32_t k) {
    return distance < nearest.distance[k] || (distance == nearest.distance[k] && sample < nearest.index[k]);
  }
};

template <class Device>
class VarianceEngine {
 public:
  explicit VarianceEngine(Device device = {}) : device_(std::move(device)) {}

  Grid<float> operator()(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                         Extent plane, Extent map, int neighbours) {
    assert(channels >= 1 && value.size() == position.size() * channels);
    assert(neighbours >= 1 && neighbours <= most_variance_samples);
    Grid<float> variance(map);
    const auto n = static_cast<std::uint32_t>(position.size());
    const auto wanted = static_cast<std::int32_t>(std::min<std::size_t>(static_cast<std::size_t>(neighbours), n));
    if (wanted < 2 || map.area() == 0) return variance;
    const SampleCells cells = cells_for(n, plane);
    const auto cell_count = static_cast<std::uint32_t>(cells.columns) * static_cast<std::uint32_t>(cells.rows);
    position_.reset(n);
    position_.upload(position);
    value_.reset(value.size());
    value_.upload(value);
    sorted_.reset(n);
    for (auto* buffer : {&cell_, &place_, &index_}) buffer->reset(n);
    for (auto* buffer : {&count_, &start_}) buffer->reset(cell_count + 1);
    variance_.reset(map.area());
    device_.prepare_sums(cell_count + 1);

    device_.launch(cell_count + 1, SetZero{count_.data()});
    device_.launch(n, CountSampleCells{cells, position_.data(), cell_.data(), place_.data(), count_.data()});
    device_.exclusive_sum(count_.data(), start_.data(), cell_count + 1);
    device_.launch(
        n, GatherSamples{position_.data(), cell_.data(), place_.data(), start_.data(), sorted_.data(), index_.data()});
    device_.launch(static_cast<std::uint32_t>(map.area()),
                   FindVariance{cells, start_.data(), sorted_.data(), index_.data(), value_.data(), channels, wanted,
                                map.width, static_cast<double>(plane.width) / map.width,
                                static_cast<double>(plane.height) / map.height, variance_.data()});
    const std::vector<float> found = variance_.download(map.area());
    std::copy(found.begin(), found.end(), variance.cells().begin());
    return variance;
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  static SampleCells cells_for(std::uint32_t n, Extent plane) {
    constexpr double samples_per_cell = 2;  // fewer cost empty cells, more cost distances
    const double count = std::clamp(n / samples_per_cell, 1.0, 0x1p28);
    const double side = std::sqrt(static_cast<double>(plane.area()) / count);
    const auto fit = [&](double length) {
      return static_cast<std::int32_t>(std::max(1.0, std::ceil(std::min(length / side, count))));
    };
    SampleCells cells;
    cells.columns = fit(plane.width);
    cells.rows = fit(plane.height);
    cells.per_width = static_cast<float>(cells.columns / static_cast<double>(plane.width));
    cells.per_height = static_cast<float>(cells.rows / static_cast<double>(plane.height));
    cells.width = static_cast<float>(static_cast<double>(plane.width) / cells.columns);
    cells.height = static_cast<float>(static_cast<double>(plane.height) / cells.rows);
    cells.rounding =
        16 * std::numeric_limits<float>::epsilon() * static_cast<float>(std::max(plane.width, plane.height));
    return cells;
  }

  Device device_;
  Buffer<Vec2f> position_, sorted_;
  Buffer<float> value_, variance_;
  Buffer<std::uint32_t> cell_, place_, index_, count_, start_;
};

}  // namespace abn::sph_cuda
