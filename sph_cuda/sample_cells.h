// Samples in the cells of NearestSamples on a device of engine.h, and an exact search for those nearest to a place.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sampling/hd.h"
#include "sampling/vec.h"
#include "sph_cuda/channel_sums.h"
#include "sph_cuda/kernels.h"

namespace abn::sph_cuda {

/// Equal cells over the plane, those of NearestSamples. Opposite sides are not joined.
struct SampleCells {
  std::int32_t columns = 1, rows = 1;
  float per_width = 1, per_height = 1;  // [1/px]
  float width = 1, height = 1;          // of a cell [px]
  float rounding = 0;                   // how far rounding may shift a coordinate against the cells' borders [px]

  ABN_HD std::int32_t column(float x) const { return bounded(x * per_width, columns); }
  ABN_HD std::int32_t row(float y) const { return bounded(y * per_height, rows); }
  ABN_HD std::uint32_t cell(Vec2f at) const {
    return static_cast<std::uint32_t>(row(at.y)) * static_cast<std::uint32_t>(columns) +
           static_cast<std::uint32_t>(column(at.x));
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(columns) * static_cast<std::uint32_t>(rows); }

 private:
  ABN_HD static std::int32_t bounded(float cell, std::int32_t count) {
    return cell > 0 ? (cell < static_cast<float>(count) ? static_cast<std::int32_t>(cell) : count - 1) : 0;
  }
};

/// Cells for `per_cell` of n samples on the average; fewer cost empty cells, more cost distances.
inline SampleCells cells_of_samples(std::uint32_t n, Extent plane, double per_cell) {
  const double width = plane.width;
  const double height = plane.height;
  const double count = std::clamp(n / per_cell, 1.0, 0x1p28);
  const double side = std::sqrt(width * height / count);
  const auto fit = [&](double length) {
    return static_cast<std::int32_t>(std::max(1.0, std::ceil(std::min(length / side, count))));
  };
  SampleCells cells;
  cells.columns = fit(width);
  cells.rows = fit(height);
  cells.per_width = static_cast<float>(cells.columns / width);
  cells.per_height = static_cast<float>(cells.rows / height);
  cells.width = static_cast<float>(width / cells.columns);
  cells.height = static_cast<float>(height / cells.rows);
  cells.rounding = 16 * std::numeric_limits<float>::epsilon() * static_cast<float>(std::max(width, height));
  return cells;
}

/// Samples in the order of their cells, row by row, those of a cell by index.
struct SamplesInCells {
  SampleCells cells;
  const std::uint32_t* start = nullptr;  // [cells + 1]
  const Vec2f* position = nullptr;       // [n], in that order
  const std::uint32_t* index = nullptr;  // [n], what a sample is known by; null = by its place in that order
};

/// The samples nearest to a place, nearest first; equal distances by index.
struct NearestFound {
  static constexpr int most = 32;
  std::uint64_t key[most];  // the squared distance's bits, which order floats >= 0, and the index
  int count = 0;

  ABN_HD std::uint32_t index(int k) const { return static_cast<std::uint32_t>(key[k]); }
  ABN_HD float squared(int k) const { return std::bit_cast<float>(static_cast<std::uint32_t>(key[k] >> 32)); }

  ABN_HD void offer(float squared_distance, std::uint32_t sample, int wanted) {
    const std::uint64_t offered = std::uint64_t{std::bit_cast<std::uint32_t>(squared_distance)} << 32 | sample;
    int to = count;
    if (to == wanted) {
      if (offered > key[to - 1]) return;
      --to;
    } else {
      ++count;
    }
    for (; to > 0 && offered < key[to - 1]; --to) key[to] = key[to - 1];
    key[to] = offered;
  }
};

inline constexpr std::uint32_t no_sample = 0xFFFFFFFFU;

/// Finds the `wanted` samples (1 to NearestFound::most) nearest to a place, or all there are, without the one known as
/// `except`. Exact, with distances as computed in float. Looks at rings of cells, from the place outwards.
ABN_HD inline void find_nearest(const SamplesInCells& all, Vec2f at, int wanted, std::uint32_t except,
                                NearestFound& found) {
  found.count = 0;
  const SampleCells& cells = all.cells;
  const auto look = [&](std::int32_t row, std::int32_t first, std::int32_t last) {
    if (first >= cells.columns || last < 0) return;
    const std::uint32_t* start =
        all.start + std::uint64_t{static_cast<std::uint32_t>(row)} * static_cast<std::uint32_t>(cells.columns);
    const std::uint32_t end = start[(last < cells.columns ? last : cells.columns - 1) + 1];
    for (std::uint32_t k = start[first > 0 ? first : 0]; k < end; ++k) {
      const std::uint32_t sample = all.index != nullptr ? all.index[k] : k;
      if (sample == except) continue;
      const float dx = all.position[k].x - at.x;
      const float dy = all.position[k].y - at.y;
      found.offer(dx * dx + dy * dy, sample, wanted);
    }
  };
  const std::int32_t column = cells.column(at.x);
  const std::int32_t row = cells.row(at.y);
  for (std::int32_t ring = 0;; ++ring) {
    const std::int32_t left = column - ring;
    const std::int32_t right = column + ring;
    const std::int32_t top = row - ring;
    const std::int32_t bottom = row + ring;
    for (std::int32_t r = top > 0 ? top : 0; r <= bottom && r < cells.rows; ++r) {
      if (r == top || r == bottom) {
        look(r, left, right);
      } else {
        look(r, left, left);
        look(r, right, right);
      }
    }
    if (left <= 0 && top <= 0 && right >= cells.columns - 1 && bottom >= cells.rows - 1) return;
    if (found.count < wanted) continue;
    // Nothing that has not been seen is nearer than the nearest side of the rings that is not the plane's border.
    float seen = std::numeric_limits<float>::infinity();
    const auto see = [&](float distance) { seen = distance < seen ? distance : seen; };
    if (left > 0) see(at.x - static_cast<float>(left) * cells.width);
    if (top > 0) see(at.y - static_cast<float>(top) * cells.height);
    if (right < cells.columns - 1) see(static_cast<float>(right + 1) * cells.width - at.x);
    if (bottom < cells.rows - 1) see(static_cast<float>(bottom + 1) * cells.height - at.y);
    if (std::sqrt(found.squared(wanted - 1)) * (1 + 0x1p-20F) + cells.rounding <= seen) return;
  }
}

struct CountSampleCells {
  SampleCells cells;
  const Vec2f* position;
  std::uint32_t* cell;   // [n]
  std::uint32_t* place;  // [n], in the cell, in no particular order
  std::uint32_t* count;  // [cells + 1], 0 before
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t here = cells.cell(position[i]);
    cell[i] = here;
    place[i] = add_atomically(count + here, 1);
  }
};

struct ScatterSamples {
  const std::uint32_t* cell;
  const std::uint32_t* place;
  const std::uint32_t* start;
  std::uint32_t* scattered;  // [n], indices by cell, in no particular order within one
  ABN_HD void operator()(std::uint32_t i) const { scattered[start[cell[i]] + place[i]] = i; }
};

/// Every sample to its place in the order: after those of its cell that have a lower index.
struct OrderSamples {
  const Vec2f* position;
  const std::uint32_t* cell;
  const std::uint32_t* start;
  const std::uint32_t* scattered;
  Vec2f* sorted;         // [n]
  std::uint32_t* index;  // [n]
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t first = start[cell[i]];
    const std::uint32_t end = start[cell[i] + 1];
    std::uint32_t to = first;
    for (std::uint32_t k = first; k < end; ++k) to += scattered[k] < i ? 1 : 0;
    sorted[to] = position[i];
    index[to] = i;
  }
};

/// Pairs of samples in one cell, a sample with itself included: exact in double up to 2^53.
struct CrowdOfCell {
  const std::uint32_t* start;
  ABN_HD double operator()(std::uint32_t, std::uint32_t cell) const {
    const auto n = static_cast<double>(start[cell + 1] - start[cell]);
    return n * n;
  }
};

/// Puts samples into cells, and keeps the memory for the next time.
template <class Device>
class SampleSort {
 public:
  /// `position` [n] on the device, which is not needed any longer afterwards.
  void sort(Device& device, const Vec2f* position, std::uint32_t n, const SampleCells& cells) {
    n_ = n;
    const std::uint32_t count = cells.count();
    for (auto* buffer : {&cell_, &place_, &index_}) buffer->reset(n);
    for (auto* buffer : {&count_, &start_}) buffer->reset(std::size_t{count} + 1);
    sorted_.reset(n);
    device.prepare_sums(count + 1);
    device.launch(count + 1, Fill<std::uint32_t>{count_.data(), 0});
    device.launch(n, CountSampleCells{cells, position, cell_.data(), place_.data(), count_.data()});
    device.exclusive_sum(count_.data(), start_.data(), count + 1);
    scattered_.reset(n);
    device.launch(n, ScatterSamples{cell_.data(), place_.data(), start_.data(), scattered_.data()});
    device.launch(
        n, OrderSamples{position, cell_.data(), start_.data(), scattered_.data(), sorted_.data(), index_.data()});
    samples_ = {cells, start_.data(), sorted_.data(), index_.data()};
  }

  const SamplesInCells& samples() const { return samples_; }

  /// NearestSamples::crowd(). Waits for the device.
  double crowd(Device& device) {
    if (n_ == 0) return 0;
    sums_.find(device, 1, samples_.cells.count(), CrowdOfCell{start_.data()});
    return sums_.total(0) / n_;
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  std::uint32_t n_ = 0;
  SamplesInCells samples_;
  Buffer<Vec2f> sorted_;
  Buffer<std::uint32_t> cell_, place_, scattered_, index_, count_, start_;
  ChannelSums<Device> sums_;
};

}  // namespace abn::sph_cuda
