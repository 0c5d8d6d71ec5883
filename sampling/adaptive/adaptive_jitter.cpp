#include "sampling/adaptive/adaptive_jitter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

#include "sampling/adaptive/pixel_variance.h"
#include "sampling/error.h"
#include "sampling/hash.h"
#include "sampling/permutation.h"
#include "sampling/rng.h"
#include "sampling/sobol_owen.h"

namespace abn {
namespace {

constexpr std::uint64_t most_in_batch = std::uint64_t{1} << 20;
constexpr std::uint64_t most = (std::uint64_t{1} << 31) - 1;  // pixels, samples of a pixel
constexpr std::uint64_t default_cap = 16;                     // times the mean
constexpr int bisections = 100;                               // of the logarithm of a ratio of floats: to the last bit

/// Unbiased variance of one sample, [width*height]; 0 where unknown, the largest float where it overflowed.
Grid<float> sample_variance(const Grid<PixelStats>& pixels, Extent plane) {
  Grid<float> variance(plane);
  if (pixels.size() != plane) return variance;
  for (std::size_t i = 0; i < variance.cells().size(); ++i) {
    if (!pixels[i].known()) continue;
    const float v = pixels[i].variance();
    variance[i] = std::isfinite(v) ? std::max(0.0F, v) : std::numeric_limits<float>::max();
  }
  return variance;
}

}  // namespace

const StrategyInfo AdaptiveJitter::info = {
    .name = "adaptive_jitter",
    .family = "adaptive",
    .summary = "Stratified samples per pixel, then more for the pixels with the largest estimated standard error.",
    .cite = "Mitchell 1987, Generating antialiased images at low sampling densities; Dammertz et al. 2010",
    .advice = "What renderers do: to judge sph_adaptive by.",
    .adaptive = true,
};

std::vector<Field<AdaptiveJitter::Params>> AdaptiveJitter::fields() {
  using P = Params;
  return {
      {"base_share", &P::base_share, "share of the budget for the equal start; at least 2 samples per pixel", 0.0, 1.0},
      {"rounds", &P::rounds, "rounds that share out the rest", 1, 1000},
      {"most_samples_per_pixel", &P::most_samples_per_pixel, "0 = 16 times the mean", 0, 2147483647},
      {"neighbourhood", &P::neighbourhood, "largest variance within so many pixels counts; 0 = its own [px]", 0, 16},
  };
}

AdaptiveJitter::AdaptiveJitter(const SamplingTask& task, const Params& params)
    : task_(task), params_(params), wanted_(task.plane), count_(task.plane) {
  const std::uint64_t area = task.plane.area();
  const std::uint64_t mean = (task.budget + area - 1) / area;
  if (area > most || mean > most) {
    throw ConfigError("adaptive_jitter: budget " + std::to_string(task.budget) + " on " + std::to_string(area) +
                      " pixels is not possible; at most " + std::to_string(most) + " of either");
  }
  const auto asked = static_cast<std::uint64_t>(params.most_samples_per_pixel);
  if (asked > 0 && asked < mean) {
    throw ConfigError("adaptive_jitter: most_samples_per_pixel = " + std::to_string(asked) +
                      " does not hold the budget; give at least " + std::to_string(mean) + ", or 0");
  }
  cap_ = static_cast<std::uint32_t>(asked > 0 ? asked : std::min(most, default_cap * mean));
}

/// As the classical strategies share out a budget: the same number everywhere, and one more for random pixels.
void AdaptiveJitter::plan_base() {
  const std::uint64_t area = task_.plane.area();
  const auto share = static_cast<std::uint64_t>(std::llround(params_.base_share * static_cast<double>(task_.budget)));
  base_ = std::min(task_.budget, std::max(task_.small_steps ? 0 : share, 2 * area));
  const Permutation order(static_cast<std::uint32_t>(area), mix64(task_.seed ^ stream_id("one sample more")));
  for (std::size_t i = 0; i < area; ++i) {
    const bool more = order(static_cast<std::uint32_t>(i)) < base_ % area;
    wanted_[i] = static_cast<std::uint32_t>(base_ / area) + (more ? 1 : 0);
  }
}

/// Gives the eligible pixels, in their order, equally many of the samples, below the cap.
void AdaptiveJitter::spread(std::vector<std::uint32_t>& eligible, std::uint64_t samples) {
  while (samples > 0) {
    std::erase_if(eligible, [&](std::uint32_t i) { return wanted_[i] >= cap_; });
    assert(!eligible.empty());  // the cap holds the budget
    const std::uint64_t each = samples / eligible.size();
    std::uint64_t more = samples % eligible.size();
    for (const std::uint32_t i : eligible) {
      std::uint64_t give = each;
      if (more > 0) {
        ++give;
        --more;
      }
      give = std::min<std::uint64_t>(give, cap_ - wanted_[i]);
      wanted_[i] += static_cast<std::uint32_t>(give);
      samples -= give;
    }
  }
}

void AdaptiveJitter::plan_round(const Feedback& seen, std::uint64_t samples) {
  const Grid<float> variance = dilated(sample_variance(seen.pixels, task_.plane), params_.neighbourhood);
  float largest = 0;
  float smallest = std::numeric_limits<float>::max();
  for (const float v : variance.cells()) {
    largest = std::max(largest, v);
    if (v > 0) smallest = std::min(smallest, v);
  }
  const auto needed = [&](std::size_t i, double threshold) {  // samples for V / n <= threshold
    const double n = std::min(std::ceil(double{variance[i]} / threshold), static_cast<double>(cap_));
    return std::max(wanted_[i], static_cast<std::uint32_t>(n));
  };
  const std::uint64_t pixels = variance.cells().size();
  if (largest > 0) {
    // Between a threshold that all meet and one that nobody meets below the cap: the lowest that can be paid for.
    double high = std::log(double{largest});
    double low = std::log(double{smallest} / static_cast<double>(cap_)) - 1;
    for (int k = 0; k < bisections; ++k) {
      const double middle = 0.5 * (low + high);
      const double threshold = std::exp(middle);
      std::uint64_t sum = 0;
      for (std::size_t i = 0; i < pixels; ++i) sum += needed(i, threshold) - wanted_[i];
      (sum <= samples ? high : low) = middle;
    }
    threshold_ = std::exp(high);
    for (std::size_t i = 0; i < pixels; ++i) {
      const std::uint32_t n = needed(i, threshold_);
      samples -= n - wanted_[i];
      wanted_[i] = n;
    }
  }
  if (samples == 0) return;
  // What is left is less than one sample for every pixel that varies and is below its cap: to the largest errors among
  // them. If it is more, those are all full, and the others share it. Ties go by a random order.
  const Permutation order(static_cast<std::uint32_t>(pixels),
                          mix64(task_.seed ^ stream_id("order of equal errors") ^ static_cast<std::uint64_t>(round_)));
  std::vector<std::uint32_t> shuffled(pixels);
  for (std::uint32_t i = 0; i < pixels; ++i) shuffled[order(i)] = i;
  std::vector<std::uint32_t> eligible;
  for (const std::uint32_t i : shuffled) {
    if (variance[i] > 0 && wanted_[i] < cap_) eligible.push_back(i);
  }
  std::stable_sort(eligible.begin(), eligible.end(), [&](std::uint32_t a, std::uint32_t b) {
    return double{variance[a]} * wanted_[b] > double{variance[b]} * wanted_[a];
  });
  if (!eligible.empty() && samples <= eligible.size()) {
    for (std::uint64_t k = 0; k < samples; ++k) ++wanted_[eligible[k]];
    return;
  }
  for (const std::uint32_t i : eligible) ++wanted_[i];
  samples -= eligible.size();
  std::stable_sort(shuffled.begin(), shuffled.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return wanted_[a] < wanted_[b]; });
  spread(shuffled, samples);
}

void AdaptiveJitter::emit() {
  batch_.clear();
  for (; at_ < wanted_.cells().size(); ++at_) {
    const std::uint64_t room = most_in_batch - batch_.size();
    const auto here = static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted_[at_] - count_[at_], room));
    if (here > 0) {
      Rng rng(task_.seed, stream_id("adaptive_jitter"), at_);
      const std::uint32_t seed_x = rng.next();
      const std::uint32_t seed_y = rng.next();
      points_.resize(here);
      sobol_owen_points(count_[at_], seed_x, seed_y, points_);
      const auto x = static_cast<std::uint32_t>(at_ % task_.plane.width);
      const auto y = static_cast<std::uint32_t>(at_ / task_.plane.width);
      for (const UnitPoint p : points_) batch_.push_back(to_pixel({unit_float(p.x), unit_float(p.y)}, x, y));
      count_[at_] += here;
    }
    if (count_[at_] < wanted_[at_]) break;  // the batch is full
  }
  emitted_ += batch_.size();
}

SampleBatch AdaptiveJitter::next(const Feedback& seen) {
  if (emitted_ == task_.budget) return {};
  if (round_ == 0) {
    plan_base();
    ++round_;
  }
  emit();
  while (batch_.empty()) {  // a round may have no sample at all
    const std::uint64_t rest = task_.budget - base_;
    const auto rounds = static_cast<std::uint64_t>(params_.rounds);
    const auto round = static_cast<std::uint64_t>(round_);  // 1 is the first one after the base
    // Whoever watches the error may stop after any round: each adds a third of what is there.
    const std::uint64_t third = std::min(task_.budget - emitted_, std::max(emitted_ / 3, std::uint64_t{64}));
    plan_round(seen, task_.small_steps ? third : rest / rounds + (round <= rest % rounds ? 1 : 0));
    ++round_;
    at_ = 0;
    emit();
  }
  return {.position = batch_};
}

std::vector<Diagnostic> AdaptiveJitter::diagnostics() const {
  std::uint32_t largest = 0;
  for (const std::uint32_t n : count_.cells()) largest = std::max(largest, n);
  return {
      {"base_samples", static_cast<double>(base_)},
      {"rounds", static_cast<double>(std::max(0, round_ - 1))},
      {"threshold", std::sqrt(threshold_)},
      {"largest_count", static_cast<double>(largest)},
  };
}

}  // namespace abn
