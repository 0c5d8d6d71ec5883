// Kernels that tell in which pixels a step may be found, and in how many samples it is to be looked for.
#pragma once

#include <cstdint>
#include <limits>

#include "sampling/hd.h"
#include "sampling/kriging/pixel_estimates.h"
#include "sampling/kriging/sample_windows.h"
#include "sampling/kriging/step_rules.h"
#include "sph_cuda/bins_engine.h"

namespace abn::sph_cuda {

/// Least and largest luminance.
struct LuminanceRange {
  float least = std::numeric_limits<float>::max();
  float most = std::numeric_limits<float>::lowest();
  ABN_HD void add(float low, float high) {
    least = low < least ? low : least;
    most = most < high ? high : most;
  }
};

struct FindRange {
  BinnedSamples samples;
  LuminanceRange* range;  // [pixels]
  ABN_HD void operator()(std::uint32_t p) const {
    LuminanceRange own;
    for (std::uint32_t i = samples.begin[p]; i < samples.begin[p + 1]; ++i) {
      own.add(samples.luminance[i], samples.luminance[i]);
    }
    range[p] = own;
  }
};

/// What limits a search for steps.
struct StepLimits {
  EdgeOptions options;
  const double* luminance_squares;
  double samples;
  ABN_HD float least_range() const { return step_rules::least_range(*luminance_squares, samples, options.contrast); }
};

/// Candidates of a run of pixels: where luminances around differ, and there are samples enough.
struct FindCandidates {
  BinnedSamples samples;
  StepLimits limits;
  const LuminanceRange* range;  // [all pixels]
  std::uint32_t first_pixel, pixels;
  PixelStep* step;        // [all pixels]: none yet
  std::uint32_t* room;    // [pixels + 1]: samples that the largest window may hold, 0 = no candidate
  std::uint32_t* is_one;  // [pixels + 1]

  ABN_HD void operator()(std::uint32_t k) const {
    room[k] = is_one[k] = 0;
    if (k == pixels) return;  // what comes after the last sum
    const std::uint32_t p = first_pixel + k;
    step[p] = PixelStep();
    const std::uint32_t y = p / samples.plane.width;
    const std::uint32_t x = p - y * samples.plane.width;
    if (!(range_around(x, y) > limits.least_range())) return;
    const PixelWindow window = window_around(x, y, step_rules::window_margin(0, limits.options.margin), samples.plane);
    std::uint32_t held = 0;
    for (std::uint32_t row = window.first_y; row <= window.last_y; ++row) {
      held += samples.row_end(window, row) - samples.row_begin(window, row);
    }
    if (held < limits.options.samples) return;
    room[k] = held;
    is_one[k] = 1;
  }

 private:
  // Of a pixel and its eight neighbours together: at least that of every window of the pixel.
  ABN_HD float range_around(std::uint32_t x, std::uint32_t y) const {
    LuminanceRange all;
    for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < samples.plane.height; ++v) {
      for (std::uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < samples.plane.width; ++u) {
        const LuminanceRange& one = range[v * samples.plane.width + u];
        all.add(one.least, one.most);
      }
    }
    return all.most > all.least ? all.most - all.least : 0;
  }
};

struct ListCandidates {
  const std::uint32_t* is_one;
  const std::uint32_t* place;
  const std::uint32_t* start;
  std::uint32_t pixels;
  std::uint32_t* number;  // [pixels], of the candidates one after the other
  std::uint32_t* totals;  // [2]: candidates, and the room for all of them
  ABN_HD void operator()(std::uint32_t k) const {
    if (k == pixels) {
      totals[0] = place[pixels];
      totals[1] = start[pixels];
    } else if (is_one[k] != 0) {
      number[place[k]] = k;
    }
  }
};

}  // namespace abn::sph_cuda
