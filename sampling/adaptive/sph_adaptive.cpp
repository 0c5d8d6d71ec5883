#include "sampling/adaptive/sph_adaptive.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "sampling/adaptive/allocation.h"
#include "sampling/adaptive/drivers.h"
#include "sampling/adaptive/ranked_plane.h"
#include "sampling/choice_field.h"
#include "sampling/emit_by_pixel.h"
#include "sampling/error.h"

namespace abn {
namespace {

constexpr double forces_alone = 1e6;           // from this delta on pressures are equal and no density is summed
constexpr double gate_less_per_sample = 0.12;  // few samples measure the variance badly: adapting must promise more
constexpr std::uint64_t fewest_samples = 64;   // with fewer there is no map to speak of

Extent map_size(Extent plane, double cells_per_pixel) {
  const auto cells = [&](std::uint32_t side) {
    return static_cast<std::uint32_t>(std::clamp(std::round(side * cells_per_pixel), 1.0, 16384.0));
  };
  return {cells(plane.width), cells(plane.height)};
}

}  // namespace

const StrategyInfo SphAdaptive::info = {
    .name = "sph_adaptive",
    .family = "adaptive",
    .summary = "Blue noise that adds its samples in passes where the image varies; what is evaluated stays in place.",
    .cite = "Russell 2018 (thesis), 4.1, with the changes its header names; Neyman 1934; Schechter and Bridson 2012",
    .advice =
        "The default choice where an evaluation costs more than a microsecond and the image is not noise all over.",
    .adaptive = true,
    .reconstruction = "edge",
    .solver = true,
};

std::vector<Field<SphAdaptive::Params>> SphAdaptive::fields() {
  using P = Params;
  return {
      choice_field<P>("driver", &P::driver,
                      "what density follows: variance of the samples, their gradient, their luminance (s = "
                      "1/sqrt(I), eq. 2.22), or the guide image",
                      {"variance", "gradient", "luminance", "guide"}),
      {"exponent", &P::exponent, "density grows with driver^exponent; 0.5 is best for independent samples", 0.05, 2.0},
      {"base_share", &P::base_share, "share of the budget that is spent uniformly first", 0.05, 0.95},
      {"least_base_spp", &P::least_base_spp, "the same as samples per pixel, at least", 0.0, 16.0},
      {"passes", &P::passes, "passes that add samples by density", 1, 64},
      {"most_ratio", &P::most_ratio, "largest density, relative to the mean", 1.0, 1000.0},
      {"floor", &P::floor, "added to the driver, relative to its mean: what is spent where nothing was seen", 1e-6,
       10.0},
      {"gate", &P::gate,
       "above this (mean sqrt V)^2 / mean V, less 0.12 / (samples per pixel), the rest is spent uniformly; 1 = never",
       0.0, 1.0},
      {"neighbours", &P::neighbours, "samples that a local variance is taken of", 3, 32},
      {"map_cells", &P::map_cells, "cells of the maps per pixel side", 0.1, 8.0},
      {"blur", &P::blur, "1-2-1 passes over the driver", 0, 16},
      {"iterations", &P::iterations, "relaxation steps of a pass", 0, 1000},
      {"delta", &P::delta, "density difference of the relaxation, as in sph_blue_noise; 1e6 = forces alone", 0.01, 1e6},
      {"refine_share", &P::refine_share, "share of the budget for midpoints of neighbours that differ", 0.0, 0.9},
      {"refine_passes", &P::refine_passes, "passes of refinement", 1, 16},
      {"refine_edge_share", &P::refine_edge_share, "refine = auto: share of the error at straight edges from which on",
       0.0, 1.0},
      {"refine_activity", &P::refine_activity,
       "refinement: how much a neighbourhood that differs counts for all its pairs", 0.0, 1.0},
      choice_field<P>("refine", &P::refine, "whether to refine: where straight edges dominate, always, never",
                      {"auto", "always", "never"}),
      choice_field<P>("boundary", &P::boundary, "of the passes: a ring of ghost particles, or opposite sides joined",
                      {"ghost", "periodic"}),
      choice_field<P>("tone", &P::tone,
                      "allocate by the variance of x / (1 + x) (what is displayed), of x (linear light), both, or "
                      "auto: both for HDR, else linear",
                      {"auto", "displayed", "linear", "both"}),
      {"light_share", &P::light_share, "tone = both: share of the density that follows linear light", 0.0, 1.0},
      {"calibrate", &P::calibrate,
       "the picture's mean is corrected by the samples that were placed uniformly; not for HDR"},
      {"unbiased", &P::unbiased, "the samples that decided where to look are discarded"},
  };
}

SphAdaptive::SphAdaptive(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  if (task.budget < 1 || task.budget > std::numeric_limits<std::uint32_t>::max()) {
    throw ConfigError("sph_adaptive: budget " + std::to_string(task.budget) +
                      " is not possible; ask for 1 to 4294967295 samples");
  }
  if (params.driver == "guide" && !task.guide) {
    throw ConfigError("sph_adaptive: driver = guide, and there is no guide; give --guide IMAGE");
  }
  if (params.unbiased && task.budget < 2 * task.plane.area()) {
    throw ConfigError(
        "sph_adaptive: unbiased = true needs a discarded sample and one to keep in every pixel; ask for at "
        "least " +
        std::to_string(2 * task.plane.area()) + " samples, not " + std::to_string(task.budget));
  }
  both_lights_ = params.tone == "both" || (params.tone == "auto" && task.high_dynamic_range);
  tone_mapped_ = params.tone == "displayed" || both_lights_;
}

void SphAdaptive::remember(const Feedback& seen) {
  assert(seen.last_values.size() == batch_.size() * seen.channels);
  std::vector<float> value;  // tone-mapped if so
  std::vector<float> light;  // the same untransformed, if density follows both
  value.reserve(seen.last_values.size());
  for (const float given : seen.last_values) {
    const float finite = std::isfinite(given) ? given : 0.0F;
    const float x = std::clamp(finite, -1e15F, 1e15F);
    // x / (1 + x) for light; what is negative has no display value.
    value.push_back(tone_mapped_ ? std::max(x, 0.0F) / (1 + std::max(x, 0.0F)) : x);
    if (both_lights_) light.push_back(x);
  }
  if (!plane_) plane_ = make_plane();
  plane_->add(batch_, value, light, seen.channels);
}

std::unique_ptr<AdaptivePlane> SphAdaptive::make_plane() const {
  AdaptivePlaneOptions options;
  options.plane = task_.plane;
  options.map = map_size(task_.plane, params_.map_cells);
  options.most_samples = task_.budget;
  options.driver = params_.driver == "variance"   ? Driver::variance
                   : params_.driver == "gradient" ? Driver::gradient
                   : params_.driver == "guide"    ? Driver::guide
                                                  : Driver::luminance;
  options.guide = task_.guide;
  options.both_lights = both_lights_ && options.driver != Driver::guide;
  options.light_share = params_.light_share;
  options.exponent = params_.exponent;
  options.floor = params_.floor;
  options.most_ratio = params_.most_ratio;
  options.neighbours = params_.neighbours;
  options.blur = params_.blur;
  options.boundary = params_.boundary == "ghost" ? sph::Boundary::ghost : sph::Boundary::periodic;
  options.delta =
      params_.delta < forces_alone ? static_cast<float>(params_.delta) : std::numeric_limits<float>::infinity();
  options.iterations = params_.iterations;
  options.refine_activity = params_.refine_activity;
  options.seed = task_.seed;
  return task_.adaptive_plane ? task_.adaptive_plane(options) : make_adaptive_plane(options, task_.solver);
}

SampleBatch SphAdaptive::next(const Feedback& seen) {
  if (stage_ == Stage::done) return {};
  if (emitted_ > 0) remember(seen);
  const bool pilot = emitted_ == 0;
  batch_ = sorted_by_pixel(pilot ? first_samples() : next_samples(), task_.plane);
  emitted_ += batch_.size();
  if (emitted_ >= task_.budget) stage_ = Stage::done;
  if (!params_.unbiased) return {.position = batch_};
  // The pilot decided where to look and counts for nothing else.
  weight_.assign(batch_.size(), pilot && stage_ != Stage::done ? 0.0F : 1.0F);
  return {.position = batch_, .weight = weight_};
}

std::vector<Vec2f> SphAdaptive::first_samples() {
  const std::uint64_t budget = task_.budget;
  if (task_.small_steps) {
    // Whoever watches the error may stop after any pass: a plane of two samples per pixel, then passes that add a third
    // of what is there.
    const std::uint64_t first = std::min(budget, 2 * task_.plane.area());
    RankedPlane plane = ranked_plane(task_.plane, first, task_.seed, {}, task_.cache);
    cached_ = plane.cached;
    for (std::uint64_t there = first; there < budget;) {
      there = std::min(budget, there + std::max(there / 3, fewest_samples));
      targets_.push_back(there);
    }
    refined_from_ = budget;
    uniform_samples_ = first;
    stage_ = Stage::adapt;
    return std::move(plane.position);
  }
  RankedPlane plane = ranked_plane(task_.plane, budget, task_.seed, {}, task_.cache);
  cached_ = plane.cached;
  const double spp = static_cast<double>(budget) / static_cast<double>(task_.plane.area());
  const double share = std::max(params_.base_share, params_.least_base_spp / spp);
  const auto base = static_cast<std::uint64_t>(share * static_cast<double>(budget));
  if (!params_.unbiased && (share >= 0.75 || budget < fewest_samples)) {
    gated_ = true;
    return std::move(plane.position);
  }
  const double refined = params_.refine == "never" ? 0 : params_.refine_share;
  refined_from_ = budget - static_cast<std::uint64_t>(refined * static_cast<double>(budget));
  for (int pass = 1; pass <= params_.passes; ++pass) {
    targets_.push_back(base +
                       static_cast<std::uint64_t>(static_cast<double>(refined_from_ - base) * pass / params_.passes));
  }
  rest_.assign(plane.position.begin() + static_cast<std::ptrdiff_t>(base), plane.position.end());
  plane.position.resize(base);
  uniform_samples_ = base;
  stage_ = Stage::adapt;
  return std::move(plane.position);
}

std::vector<Vec2f> SphAdaptive::next_samples() {
  if (params_.unbiased) return samples_by_pixel();
  if (stage_ == Stage::adapt) {
    if (pass_ + 1 == targets_.size() && params_.refine == "auto" && !task_.small_steps) {
      // The last pass: what would be refined goes to it unless straight edges dominate.
      if (!straight_edges_dominate()) targets_.back() = task_.budget;
    }
    if (pass_ == 0) {
      uniform_share_ = plane_->uniform_share();
      gated_ = params_.gate < 1 && uniform_share_ > params_.gate - gate_less_per_sample / samples_per_pixel();
      if (gated_ && !task_.small_steps) {
        uniform_samples_ = 0;
        return std::move(rest_);
      }
    }
    std::vector<Vec2f> samples = add_by_density(targets_[pass_]);
    if (++pass_ == targets_.size()) stage_ = Stage::refine;
    return samples;
  }
  const std::uint64_t left = task_.budget - emitted_;
  const auto done = static_cast<double>(emitted_ - refined_from_);
  const double step = static_cast<double>(task_.budget - refined_from_) / params_.refine_passes;
  const auto passes_left = std::max(1.0, params_.refine_passes - std::round(done / step));
  return refine(static_cast<std::uint64_t>(std::ceil(static_cast<double>(left) / passes_left)));
}

double SphAdaptive::samples_per_pixel() const {
  const std::uint64_t samples = task_.small_steps ? emitted_ : task_.budget;
  return static_cast<double>(samples) / static_cast<double>(task_.plane.area());
}

std::vector<Vec2f> SphAdaptive::samples_by_pixel() {
  const Grid<float> driver = plane_->driver();
  const double spp = static_cast<double>(task_.budget) / static_cast<double>(task_.plane.area());
  const std::uint64_t count = task_.budget - emitted_;
  const Grid<float> nothing(driver.size(), 0.0F);
  const Grid<float> weight = density_weights(driver, params_.floor, params_.exponent);
  const Grid<float> wanted =
      allocate(weight, nothing, static_cast<double>(count), params_.most_ratio * spp, task_.plane);
  return draw_per_pixel(wanted, count, task_.plane, task_.seed);
}

std::vector<Vec2f> SphAdaptive::add_by_density(std::uint64_t target) {
  DensityPass pass;
  pass.target = target;
  pass.mean_density =
      static_cast<double>(task_.small_steps ? target : task_.budget) / static_cast<double>(task_.plane.area());
  pass.even = gated_;
  pass.seed = task_.seed + pass_;
  std::vector<Vec2f> placed = plane_->add_by_density(pass);
  ++relaxed_passes_;
  return placed;
}

std::uint64_t SphAdaptive::uniform_samples() const {
  // One lamp makes the mean of uniform samples noisier than any bias there is, and its dark surroundings would pay.
  return params_.calibrate && !params_.unbiased && !task_.high_dynamic_range ? uniform_samples_ : 0;
}

bool SphAdaptive::straight_edges_dominate() {
  edge_share_ = plane_->straight_edge_share();
  return edge_share_ >= params_.refine_edge_share;
}

std::vector<Vec2f> SphAdaptive::refine(std::uint64_t count) {
  ++refined_passes_;
  return plane_->refine(count, task_.seed + emitted_);
}

std::span<const Vec2f> SphAdaptive::ghosts() const { return plane_ ? plane_->ghosts() : std::span<const Vec2f>(); }

std::vector<Diagnostic> SphAdaptive::diagnostics() const {
  std::vector<Diagnostic> list = {{.name = "uniform_share", .value = uniform_share_},
                                  {.name = "gated", .value = gated_ ? 1.0 : 0.0},
                                  {.name = "relaxed_passes", .value = static_cast<double>(relaxed_passes_)},
                                  {.name = "refined_passes", .value = static_cast<double>(refined_passes_)},
                                  {.name = "straight_edge_share", .value = edge_share_}};
  const std::string backend = plane_ ? plane_->backend() : "";
  if (!backend.empty()) list.push_back({.name = "backend", .value = 0, .text = backend});
  return list;
}

}  // namespace abn
