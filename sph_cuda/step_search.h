// The kernel that finds the steps of pixels, a block per pixel, by the rules of harness/edge_reconstruction.cpp.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/kriging/pixel_estimates.h"
#include "sampling/kriging/sample_windows.h"
#include "sampling/kriging/step_rules.h"
#include "sph_cuda/bins_engine.h"
#include "sph_cuda/step_candidates.h"

namespace abn::sph_cuda {

/// Sorting n values in place by phases, in each of which every pair is looked at by one thread: Batcher's network with
/// all comparisons rising, so that what lies beyond n counts as larger than everything.
struct SortingNetwork {
  /// Phases that sort up to `most` values.
  ABN_HD static int phases(std::uint32_t most) {
    const int merges = most > 1 ? static_cast<int>(std::bit_width(most - 1)) : 0;
    return merges * (merges + 1) / 2;
  }
  ABN_HD static void run(int phase, float* value, std::uint32_t n, std::uint32_t thread, std::uint32_t threads) {
    int merge = 1;  // of runs of 2^(merge - 1) values
    for (; phase >= merge; ++merge) phase -= merge;
    const std::uint32_t half = std::uint32_t{1} << static_cast<unsigned>(merge - 1 - phase);  // a pair's distance
    for (std::uint32_t pair = thread;; pair += threads) {
      const std::uint32_t inside = pair & (half - 1);
      const std::uint32_t begin = 2 * (pair - inside);
      if (begin + inside >= n) return;
      // The first phase of a merge mirrors the second run, which makes of two rising runs one that rises and falls.
      const std::uint32_t other = begin + (phase == 0 ? 2 * half - 1 - inside : half + inside);
      if (other >= n) continue;
      float& low = value[begin + inside];
      float& high = value[other];
      if (!(high < low)) continue;
      const float kept = low;
      low = high;
      high = kept;
    }
  }
};

struct FindSteps {
  static constexpr std::uint32_t threads = step_rules::angles;
  static constexpr std::uint32_t means = 4;  // of three channels, then of the luminance

  BinnedSamples samples;
  StepLimits limits;
  std::uint32_t first_pixel;
  const std::uint32_t* number;  // [blocks]: of the pixels
  const std::uint32_t* start;   // [pixels + 1]: of their samples in the two arrays below
  std::uint32_t* member;        // the samples in a window
  float* sorted;                // their luminances
  const float *cosine, *sine;   // [angles] of the first look
  PixelStep* step;              // [all pixels]; written where one is found

  // A window after the other: its members (2 phases), sorted, divided, looked at along 64 angles, then at finer ones (2
  // phases each), the step (2).
  ABN_HD int phases(std::uint32_t block) const { return step_rules::windows * window_phases(block); }
  std::size_t shared_bytes() const { return sizeof(Shared); }

  ABN_HD void operator()(int phase, std::uint32_t block, std::uint32_t thread, void* memory) const {
    Shared& shared = *static_cast<Shared*>(memory);
    const int all = window_phases(block);
    const int window = phase / all;
    phase -= window * all;
    const int sorting = all - other_phases;
    // The state is read by one thread where one thread writes it, and not before it is written for the first time.
    const bool alone = phase == 2 + sorting || (phase > 2 + sorting && (phase - sorting) % 2 == 0);
    if (alone && thread != 0) return;
    if ((window > 0 || phase > 2 + sorting) && shared.state == State::ended) return;
    const Place at = place_of(block, window);
    if (phase == 0) {
      shared.count[thread] = count_members(at, thread);
    } else if (phase == 1) {
      write_members(at, thread, shared);
    } else if (phase < 2 + sorting) {
      SortingNetwork::run(phase - 2, at.sorted, shared.members, thread, threads);
    } else if (phase == 2 + sorting) {
      divide(at, shared);
    } else if (phase < 3 + 2 * looks + sorting) {
      const int level = (phase - 3 - sorting) / 2;  // 0 = all angles
      if (shared.state != (level == 0 ? State::separating : State::refining)) return;
      if (alone) {
        decide(level, shared);
      } else {
        look(at, level, thread, shared);
      }
    } else if (shared.state == State::separated) {
      if (alone) {
        store(at, shared);
      } else {
        find_means(at, thread, shared);
      }
    }
  }

 private:
  static constexpr int looks = 1 + step_rules::refinements;
  static constexpr int other_phases = 2 + 1 + 2 * looks + 2;  // other than sorting

  enum class State : std::uint32_t {
    separating,   // two classes by lines
    refining,     // the angles of these
    separated,    // only the step is missing
    unseparated,  // a smaller window may do
    ended,        // with a step or without
  };
  struct Shared {
    State state;
    std::uint32_t members;
    float threshold;
    step_rules::SharePosterior posterior;
    step_rules::FineAngles fine;
    double mean[2][means];
    std::uint32_t count[threads];
    float gap[threads];
    step_rules::NodeShares shares[threads];
    bool low_first[threads];
  };
  /// A window of a pixel.
  struct Place {
    std::uint32_t pixel;
    float left, top, margin;
    PixelWindow window;
    std::uint32_t* member;
    float* sorted;
  };

  ABN_HD int window_phases(std::uint32_t block) const {
    const std::uint32_t k = number[block];
    return other_phases + SortingNetwork::phases(start[k + 1] - start[k]);
  }

  ABN_HD Place place_of(std::uint32_t block, int window) const {
    const std::uint32_t k = number[block];
    const std::uint32_t p = first_pixel + k;
    const std::uint32_t y = p / samples.plane.width;
    const std::uint32_t x = p - y * samples.plane.width;
    const float margin = step_rules::window_margin(window, limits.options.margin);
    return {p,
            static_cast<float>(x),
            static_cast<float>(y),
            margin,
            window_around(x, y, margin, samples.plane),
            member + start[k],
            sorted + start[k]};
  }

  // A thread's part of the samples in the window's rows, in their order: f of those within the margin.
  template <class F>
  ABN_HD void for_part(const Place& at, std::uint32_t thread, const F& f) const {
    std::uint32_t all = 0;
    for (std::uint32_t row = at.window.first_y; row <= at.window.last_y; ++row) {
      all += samples.row_end(at.window, row) - samples.row_begin(at.window, row);
    }
    const std::uint32_t part = (all + threads - 1) / threads;
    const std::uint32_t first = thread * part;
    const std::uint32_t behind = first + part;
    std::uint32_t before = 0;  // samples of the rows before
    for (std::uint32_t row = at.window.first_y; row <= at.window.last_y && before < behind; ++row) {
      const std::uint32_t begin = samples.row_begin(at.window, row);
      const std::uint32_t count = samples.row_end(at.window, row) - begin;
      const std::uint32_t from = first > before ? first - before : 0;
      const std::uint32_t to = behind - before < count ? behind - before : count;
      for (std::uint32_t i = begin + from; i < begin + to; ++i) {
        const float dx = distance_outside(at.left, samples.x[i]);
        const float dy = distance_outside(at.top, samples.y[i]);
        if ((dx < dy ? dy : dx) <= at.margin) f(i);
      }
      before += count;
    }
  }

  ABN_HD std::uint32_t count_members(const Place& at, std::uint32_t thread) const {
    std::uint32_t count = 0;
    for_part(at, thread, [&](std::uint32_t) { ++count; });
    return count;
  }

  ABN_HD void write_members(const Place& at, std::uint32_t thread, Shared& shared) const {
    std::uint32_t to = 0;
    for (std::uint32_t k = 0; k < thread; ++k) to += shared.count[k];
    for_part(at, thread, [&](std::uint32_t i) {
      at.member[to] = i;
      at.sorted[to] = samples.luminance[i];
      ++to;
    });
    if (thread + 1 == threads) shared.members = to;
  }

  ABN_HD void divide(const Place& at, Shared& shared) const {
    shared.state = State::ended;  // too few samples, or flat luminances: smaller windows have no more
    const std::uint32_t n = shared.members;
    if (n < limits.options.samples || !(at.sorted[n - 1] - at.sorted[0] > limits.least_range())) return;
    const step_rules::Split split = step_rules::split_classes(at.sorted, n, limits.options);
    shared.threshold = split.threshold;
    shared.state = split.good ? State::separating : State::unseparated;
  }

  ABN_HD void look(const Place& at, int level, std::uint32_t thread, Shared& shared) const {
    float c = 0;
    float s = 0;
    if (level == 0) {
      c = cosine[thread];
      s = sine[thread];
    } else {
      if (thread > step_rules::fine_angles) return;
      const double angle = shared.fine[thread];
      c = static_cast<float>(std::cos(angle));
      s = static_cast<float>(std::sin(angle));
    }
    float low_min = step_rules::far_away;
    float low_max = -step_rules::far_away;
    float high_min = step_rules::far_away;
    float high_max = -step_rules::far_away;
    for (std::uint32_t k = 0; k < shared.members; ++k) {
      const std::uint32_t i = at.member[k];
      const float along = c * (samples.x[i] - at.left) + s * (samples.y[i] - at.top);
      if (samples.luminance[i] < shared.threshold) {
        low_min = along < low_min ? along : low_min;
        low_max = along > low_max ? along : low_max;
      } else {
        high_min = along < high_min ? along : high_min;
        high_max = along > high_max ? along : high_max;
      }
    }
    const step_rules::Family lines = step_rules::family_between(low_min, low_max, high_min, high_max);
    shared.gap[thread] = lines.gap;
    shared.low_first[thread] = lines.low_first;
    if (lines.gap > 0) shared.shares[thread] = step_rules::shares_of(c, s, lines);
  }

  ABN_HD void decide(int level, Shared& shared) const {
    shared.posterior = {};
    step_rules::AngleCount seen;
    const std::uint32_t looked_at = level == 0 ? step_rules::angles : step_rules::fine_angles + 1;
    for (std::uint32_t a = 0; a < looked_at; ++a) {
      if (!seen.add(a, shared.gap[a])) continue;
      shared.posterior.add(shared.gap[a], shared.low_first[a], shared.shares[a]);
    }
    if (level == 0) {
      shared.state = State::separated;
      if (seen.separating >= step_rules::enough_angles) return;
      shared.state = seen.widest < step_rules::hopeless ? State::unseparated : State::refining;
      shared.fine = step_rules::around(step_rules::coarse_angle(seen.best), step_rules::first_spacing);
      return;
    }
    if (seen.separating >= step_rules::enough_angles - 1 || level == step_rules::refinements) {
      shared.state = shared.posterior.weight > step_rules::least_weight ? State::separated : State::unseparated;
      return;
    }
    shared.fine = step_rules::around(shared.fine[seen.best], shared.fine.spacing / 4);
  }

  // A thread for each: the lower class, then the upper one.
  ABN_HD void find_means(const Place& at, std::uint32_t thread, Shared& shared) const {
    const std::uint32_t side = thread / means;
    const std::uint32_t c = thread - side * means;
    if (side > 1 || (c + 1 < means && c >= samples.channels)) return;
    double sum = 0;
    std::uint32_t count = 0;
    for (std::uint32_t k = 0; k < shared.members; ++k) {
      const std::uint32_t i = at.member[k];
      if ((samples.luminance[i] < shared.threshold) != (side == 0)) continue;
      sum += static_cast<double>(c + 1 == means ? samples.luminance[i]
                                                : samples.value[std::size_t{i} * samples.channels + c]);
      ++count;
    }
    shared.mean[side][c] = sum / static_cast<double>(count);
  }

  ABN_HD void store(const Place& at, Shared& shared) const {
    PixelStep found;
    found.found = true;
    found.threshold = shared.threshold;
    shared.posterior.store(found);
    for (std::uint32_t c = 0; c < samples.channels; ++c) {
      found.jump[c] = static_cast<float>(shared.mean[1][c] - shared.mean[0][c]);
    }
    found.luminance_jump = static_cast<float>(shared.mean[1][means - 1] - shared.mean[0][means - 1]);
    step[at.pixel] = found;
    shared.state = State::ended;
  }
};

}  // namespace abn::sph_cuda
