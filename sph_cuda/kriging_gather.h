// Kernels that find the points of every pixel's kriging system, by the rules of harness/kriging.cpp.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/kriging/kriging_rules.h"
#include "sampling/kriging/pixel_estimates.h"
#include "sph_cuda/bins_engine.h"
#include "sph_cuda/kernels.h"

namespace abn::sph_cuda {

inline constexpr std::uint32_t merged_points = kriging_rules::merge_cells * kriging_rules::merge_cells;  // at most
/// Of the keys by which systems are sorted: those of pixels whose own samples are merged.
inline constexpr std::uint32_t merged_key = kriging_rules::most_neighbours + 1;

/// The systems of a run of pixels. The points of pixel first_pixel + k are [start[k], start[k] + count[k]).
struct PixelSystems {
  std::uint32_t first_pixel;
  float* margin;         // [pixels]
  std::uint32_t* found;  // [pixels]: samples in the margin
  std::uint32_t* count;  // [pixels]: points, for merged pixels at most
  std::uint32_t* start;  // [pixels + 1]
};

/// The points of all systems, relative to their pixel's corner [px].
struct SystemPoints {
  float *x, *y, *nugget, *luminance;  // [points]
  float* value;                       // [points * channels]
};

/// What the pixels' estimates are written to.
struct EstimateArrays {
  float* value;           // [pixels * channels]
  PixelScale* scale;      // [pixels]
  const PixelStep* step;  // [pixels], or null
};

/// The margin of every pixel, how many points it takes, and the key by which its system is sorted.
struct CountPoints {
  BinnedSamples samples;
  float first_margin;
  std::uint32_t wanted;
  std::uint32_t pixels;
  PixelSystems systems;
  EstimateArrays out;           // of a pixel without any sample in reach: nothing is known
  std::uint64_t* key;           // [pixels]
  std::uint32_t* number;        // [pixels]: k
  std::uint32_t* empty_pixels;  // counts

  ABN_HD void operator()(std::uint32_t k) const {
    if (k == pixels) {  // what comes after the last sum
      systems.count[k] = 0;
      return;
    }
    const std::uint32_t p = systems.first_pixel + k;
    const std::uint32_t own = samples.begin[p + 1] - samples.begin[p];
    if (own == 0) add_atomically(empty_pixels, 1);
    float margin = first_margin;
    std::uint32_t found = count_within(p, margin);
    for (int growth = 0; growth < kriging_rules::growths && found < wanted; ++growth) {
      margin *= kriging_rules::growth;
      found = count_within(p, margin);
    }
    const std::uint32_t wide = own + kriging_rules::extra_neighbours;
    const std::uint32_t most = wide > kriging_rules::usual_neighbours ? wide : kriging_rules::usual_neighbours;
    const bool merged = found > 0 && wide > kriging_rules::most_neighbours;
    systems.margin[k] = margin;
    systems.found[k] = found;
    systems.count[k] = merged ? merged_points : (found < most ? found : most);
    key[k] = merged ? merged_key : systems.count[k];
    number[k] = k;
    if (found > 0) return;
    out.scale[p] = PixelScale();
    for (std::uint32_t c = 0; c < samples.channels; ++c) out.value[std::size_t{p} * samples.channels + c] = 0;
  }

 private:
  ABN_HD std::uint32_t count_within(std::uint32_t p, float margin) const {
    const std::uint32_t py = p / samples.plane.width;
    const std::uint32_t px = p - py * samples.plane.width;
    const PixelWindow window = window_around(px, py, margin, samples.plane);
    const float limit = margin * margin;
    std::uint32_t count = 0;
    for (std::uint32_t row = window.first_y; row <= window.last_y; ++row) {
      const std::uint32_t end = samples.row_end(window, row);
      for (std::uint32_t i = samples.row_begin(window, row); i < end; ++i) {
        if (samples.squared_distance(i, static_cast<float>(px), static_cast<float>(py)) <= limit) ++count;
      }
    }
    return count;
  }
};

/// What of a sample counts: its values less the step of its pixel, where there is one.
struct SteppedValue {
  const BinnedSamples& samples;
  const PixelStep* step;  // null = none
  std::uint32_t i;
  ABN_HD bool upper() const { return step != nullptr && samples.luminance[i] >= step->threshold; }
  ABN_HD float luminance() const {
    return upper() ? samples.luminance[i] - step->luminance_jump : samples.luminance[i];
  }
  ABN_HD float value(std::uint32_t c) const {
    const float own = samples.value[std::size_t{i} * samples.channels + c];
    return upper() ? own - step->jump[c] : own;
  }
};

ABN_HD inline const PixelStep* step_of(const EstimateArrays& out, std::uint32_t pixel) {
  return out.step != nullptr && out.step[pixel].found ? out.step + pixel : nullptr;
}

/// The points of the pixels that are not merged: all samples in the margin or, where these are too many, the nearest
/// ones, equal distances by number.
struct WritePoints {
  BinnedSamples samples;
  PixelSystems systems;
  const std::uint64_t* key;  // [pixels], as CountPoints wrote it
  EstimateArrays out;
  SystemPoints points;
  float nugget;

  ABN_HD void operator()(std::uint32_t k) const {
    if (key[k] == merged_key || key[k] == 0) return;
    const std::uint32_t p = systems.first_pixel + k;
    const std::uint32_t py = p / samples.plane.width;
    Place at{static_cast<float>(p - py * samples.plane.width), static_cast<float>(py), {}};
    at.window = window_around(p - py * samples.plane.width, py, systems.margin[k], samples.plane);
    const float limit = systems.margin[k] * systems.margin[k];
    const Nearest nearest = systems.found[k] > systems.count[k] ? nearest_of(at, limit, systems.count[k])
                                                                : Nearest{limit, systems.count[k]};
    const PixelStep* step = step_of(out, p);
    std::uint32_t to = systems.start[k];
    std::uint32_t equal = 0;
    for (std::uint32_t row = at.window.first_y; row <= at.window.last_y; ++row) {
      const std::uint32_t end = samples.row_end(at.window, row);
      for (std::uint32_t i = samples.row_begin(at.window, row); i < end; ++i) {
        const float distance = samples.squared_distance(i, at.left, at.top);
        if (!(distance <= nearest.distance)) continue;
        if (distance == nearest.distance && equal++ >= nearest.equal) continue;
        points.x[to] = samples.x[i] - at.left;
        points.y[to] = samples.y[i] - at.top;
        points.nugget[to] = nugget;
        const SteppedValue stepped{samples, step, i};
        points.luminance[to] = stepped.luminance();
        for (std::uint32_t c = 0; c < samples.channels; ++c) {
          points.value[std::size_t{to} * samples.channels + c] = stepped.value(c);
        }
        ++to;
      }
    }
  }

 private:
  struct Place {
    float left, top;
    PixelWindow window;
  };
  /// All samples nearer than `distance` (squared), and the first `equal` ones of those that are as far.
  struct Nearest {
    float distance;
    std::uint32_t equal;
  };

  ABN_HD std::uint32_t count_within(const Place& at, float distance) const {
    std::uint32_t count = 0;
    for (std::uint32_t row = at.window.first_y; row <= at.window.last_y; ++row) {
      const std::uint32_t end = samples.row_end(at.window, row);
      for (std::uint32_t i = samples.row_begin(at.window, row); i < end; ++i) {
        if (samples.squared_distance(i, at.left, at.top) <= distance) ++count;
      }
    }
    return count;
  }

  // Bisects the bits of the distance: those of floats that are not negative rise as they do.
  ABN_HD Nearest nearest_of(const Place& at, float limit, std::uint32_t wanted) const {
    std::uint32_t low = 0;  // the answer is at least this
    std::uint32_t high = std::bit_cast<std::uint32_t>(limit);
    std::uint32_t below_low = 0;  // samples nearer than that
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      const std::uint32_t count = count_within(at, std::bit_cast<float>(middle));
      if (count == wanted) return {std::bit_cast<float>(middle), wanted};
      if (count < wanted) {
        low = middle + 1;
        below_low = count;
      } else {
        high = middle;
      }
    }
    return {std::bit_cast<float>(low), wanted - below_low};
  }
};

/// The points of merged pixels: one for all of a pixel's own samples that share a cell, their means, with the nugget of
/// a mean. A block per pixel, a thread per cell; a sample is looked at by all threads at once.
struct MergePoints {
  static constexpr std::uint32_t threads = 96;
  static_assert(merged_points <= threads);

  struct Cell {
    float x, y, nugget, luminance, value[3];
    std::uint32_t used;
  };

  BinnedSamples samples;
  PixelSystems systems;
  const std::uint32_t* number;  // [blocks]: of the pixels
  EstimateArrays out;
  SystemPoints points;
  float nugget;

  ABN_HD int phases(std::uint32_t) const { return 2; }
  std::size_t shared_bytes() const { return merged_points * sizeof(Cell); }
  ABN_HD void operator()(int phase, std::uint32_t block, std::uint32_t thread, void* memory) const {
    if (thread >= merged_points) return;
    Cell* cells = static_cast<Cell*>(memory);
    if (phase == 0) {
      cells[thread] = merge(systems.first_pixel + number[block], thread);
    } else {
      write(number[block], thread, cells);
    }
  }

 private:
  ABN_HD Cell merge(std::uint32_t p, std::uint32_t cell) const {
    const std::uint32_t row = p / samples.plane.width;
    const auto left = static_cast<float>(p - row * samples.plane.width);
    const auto top = static_cast<float>(row);
    const PixelStep* step = step_of(out, p);
    double sum_x = 0;
    double sum_y = 0;
    double light = 0;
    double value[3] = {};
    double count = 0;
    for (std::uint32_t i = samples.begin[p]; i < samples.begin[p + 1]; ++i) {
      const float x = samples.x[i] - left;
      const float y = samples.y[i] - top;
      if (kriging_rules::merge_cell(x, y) != cell) continue;
      const SteppedValue stepped{samples, step, i};
      count += 1;
      sum_x += static_cast<double>(x);
      sum_y += static_cast<double>(y);
      light += static_cast<double>(stepped.luminance());
      for (std::uint32_t c = 0; c < 3; ++c) {
        if (c < samples.channels) value[c] += static_cast<double>(stepped.value(c));
      }
    }
    Cell merged{};
    if (count == 0) return merged;
    merged.used = 1;
    merged.x = static_cast<float>(sum_x / count);
    merged.y = static_cast<float>(sum_y / count);
    merged.nugget = kriging_rules::merged_nugget(nugget, count);
    merged.luminance = static_cast<float>(light / count);
    for (std::uint32_t c = 0; c < 3; ++c) merged.value[c] = static_cast<float>(value[c] / count);
    return merged;
  }

  ABN_HD void write(std::uint32_t k, std::uint32_t thread, const Cell* cells) const {
    std::uint32_t before = 0;
    for (std::uint32_t cell = 0; cell < thread; ++cell) before += cells[cell].used;
    if (thread + 1 == merged_points) systems.count[k] = before + cells[thread].used;
    const Cell& cell = cells[thread];
    if (cell.used == 0) return;
    const std::size_t to = systems.start[k] + before;
    points.x[to] = cell.x;
    points.y[to] = cell.y;
    points.nugget[to] = cell.nugget;
    points.luminance[to] = cell.luminance;
    for (std::uint32_t c = 0; c < samples.channels; ++c) points.value[to * samples.channels + c] = cell.value[c];
  }
};

}  // namespace abn::sph_cuda
