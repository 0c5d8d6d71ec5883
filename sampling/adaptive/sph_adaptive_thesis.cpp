#include "sampling/adaptive/sph_adaptive_thesis.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sampling/adaptive/allocation.h"
#include "sampling/adaptive/local_variance.h"
#include "sampling/adaptive/pixel_variance.h"
#include "sampling/choice_field.h"
#include "sampling/error.h"
#include "sampling/relaxation_start.h"
#include "sampling/rng.h"

namespace abn {
namespace {

constexpr float largest_variance = 0.25F;        // of data in [0,1]
constexpr double share_of_mean = 0.02;           // added to V before an exponent: samples where no variance was seen
constexpr double density_range = 64;             // of an exponent, as wide as c = [1/8, 1]
constexpr double high_target = 1.5;              // a pixel whose target is so many times the mean counts as high
constexpr int surplus_blur = 2;                  // passes of 1-2-1
constexpr float surplus_noise = 0.1F;            // particles per pixel by which blue noise differs from even after that
constexpr double dither_x = 0.7548776662466927;  // R2: 1/p and 1/p^2, p^3 = p + 1
constexpr double dither_y = 0.5698402909980532;
constexpr std::uint32_t few_samples = 3;  // numerics: pixels with so few are starved

std::size_t pixel_of(Vec2f p, Extent plane) {
  return static_cast<std::size_t>(p.y) * plane.width + static_cast<std::size_t>(p.x);
}

/// Eq. 4.1: the density s^-2 = (a V + c)^2 of a particle where the variance is V.
float density_of(float variance, double c_min, double c_max) {
  const double inverse_size = (c_max - c_min) * double{std::min(1.0F, variance / largest_variance)} + c_min;
  return static_cast<float>(inverse_size * inverse_size);
}

/// n ~ (V + .02 mean V)^exponent, at most 64 times its smallest; uniform where there is no variance at all.
Grid<float> density_by_exponent(const Grid<float>& variance, double exponent) {
  double mean = 0;
  for (const float v : variance.cells()) mean += double{v};
  mean /= static_cast<double>(variance.cells().size());
  Grid<float> density(variance.size(), 1.0F);
  if (!(mean > 0)) return density;
  for (std::size_t i = 0; i < density.cells().size(); ++i) {
    const double ratio = double{variance[i]} / (share_of_mean * mean) + 1;  // from 1, so that no power underflows
    density[i] = static_cast<float>(std::min(std::pow(ratio, exponent), density_range));
  }
  return density;
}

/// The sum of a map's cells in every pixel, scaled to `total`.
Grid<double> by_pixel(const Grid<float>& map, Extent plane, double total) {
  Grid<double> result(plane);
  const std::uint32_t cells = map.size().width / plane.width;
  double sum = 0;
  for (std::uint32_t y = 0; y < map.size().height; ++y) {
    for (std::uint32_t x = 0; x < map.size().width; ++x) {
      result.at(x / cells, y / cells) += double{map.at(x, y)};
      sum += double{map.at(x, y)};
    }
  }
  for (double& value : result.cells()) value *= total / sum;
  return result;
}

sph::Kernel kernel_of(const std::string& word) {
  return word == "poly6_spiky" ? sph::Kernel::poly6_spiky
         : word == "cubic"     ? sph::Kernel::cubic
                               : sph::Kernel::wendland;
}

}  // namespace

const StrategyInfo SphAdaptiveThesis::info = {
    .name = "sph_adaptive_thesis",
    .family = "adaptive",
    .summary =
        "One particle per pixel and pass is frozen and evaluated; the others relax in a size field of the "
        "pixels' variance.",
    .cite = "Russell 2018 (thesis), 4.1",
    .advice = "To reproduce the thesis and why its adaptive blue noise lost; use sph_adaptive for pictures.",
    .adaptive = true,
    .solver = true,
};

std::vector<Field<SphAdaptiveThesis::Params>> SphAdaptiveThesis::fields() {
  using P = Params;
  return {
      {"c_min", &P::c_min, "eq. 4.1: 1/s where nothing varies", 0.01, 100},
      {"c_max", &P::c_max, "eq. 4.1: 1/s where the variance is 0.25 or more", 0.01, 100},
      {"exponent", &P::exponent, "density ~ (V + .02 mean V)^exponent instead of eq. 4.1; 0 = eq. 4.1", 0, 4},
      choice_field<P>("variance", &P::variance,
                      "of the samples, or the true one of every pixel (needs --guide true_variance)",
                      {"estimated", "true"}),
      {"blur", &P::blur, "passes of the filter 1-2-1 over the variance map", 0, 100},
      {"map_cells", &P::map_cells, "map cells per pixel side; above 1: variance of the 8 nearest samples", 1, 8},
      {"freezing", &P::freezing, "evaluated particles stay; without it they move on, and their samples stay behind"},
      choice_field<P>("redraw", &P::redraw,
                      "free particles drawn anew in every pass, where density is missing: none, those too "
                      "many where they are, all",
                      {"never", "surplus", "all"}),
      {"iterations", &P::iterations, "iterations between two passes", 0, 100000},
      {"first_iterations", &P::first_iterations, "iterations before the first pass", 0, 100000},
      start_field<P>(),
      choice_field<P>("boundary", &P::boundary,
                      "walls with fixed ghost particles behind them, or opposite sides joined", {"ghost", "periodic"}),
      choice_field<P>("kernel", &P::kernel, "smoothing kernel; poly6_spiky is the thesis'",
                      {"wendland", "poly6_spiky", "cubic"}),
      {"delta", &P::delta, "density difference relative to the mean density: smaller is stiffer", 0.01, 1e6},
      {"background", &P::background, "subtract the mean-field force; without it the density misses its target"},
      {"most_passes", &P::most_passes, "passes at most; the last one emits what is left", 1, 1000000},
  };
}

SphAdaptiveThesis::SphAdaptiveThesis(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  require_budget(info.name, task.budget, 4294967295U);
  if (params.variance == "true" && !task.guide) {
    throw ConfigError(
        "sph_adaptive_thesis: variance = true needs the variance of every pixel; give --guide true_variance");
  }
}

void SphAdaptiveThesis::keep_values(const Feedback& seen) {
  if (params_.map_cells == 1 || batch_.empty()) return;
  const std::size_t channels = seen.channels;
  if (seen.last_values.size() != batch_.size() * channels) return;
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    const float* value = &seen.last_values[i * channels];
    const float luminance = channels >= 3 ? 0.2126F * value[0] + 0.7152F * value[1] + 0.0722F * value[2] : value[0];
    if (!std::isfinite(luminance)) continue;
    sample_.push_back(batch_[i]);
    value_.push_back(luminance);
  }
}

Grid<float> SphAdaptiveThesis::variance(const Feedback& seen) const {
  const auto cells = static_cast<std::uint32_t>(params_.map_cells);
  const Extent map{task_.plane.width * cells, task_.plane.height * cells};
  Grid<float> variance = params_.variance == "true" ? resampled(*task_.guide, map)
                         : cells == 1               ? pixel_variance(seen.pixels, map)
                                                    : local_variance(sample_, value_, 1, task_.plane, map);
  blur(variance, params_.blur);
  return variance;
}

void SphAdaptiveThesis::set_density(const Grid<float>& variance) {
  if (params_.exponent > 0) {
    density_ = density_by_exponent(variance, params_.exponent);
    return;
  }
  density_ = Grid<float>(variance.size());
  for (std::size_t i = 0; i < density_.cells().size(); ++i) {
    density_[i] = density_of(variance[i], params_.c_min, params_.c_max);
  }
}

std::unique_ptr<sph::Solver> SphAdaptiveThesis::make_solver() const {
  sph::Setup setup;
  setup.plane = task_.plane;
  setup.positions = position_;
  setup.kernel = kernel_of(params_.kernel);
  setup.boundary = params_.boundary == "ghost" ? sph::Boundary::ghost : sph::Boundary::periodic;
  setup.stiffness_ratio = static_cast<float>(params_.delta);
  setup.background = params_.background;
  setup.seed = task_.seed;
  return task_.solver ? task_.solver(setup) : sph::make_cpu_solver(setup);
}

SphAdaptiveThesis::FreeParticles SphAdaptiveThesis::free_by_pixel() const {
  FreeParticles free;
  free.begin.assign(task_.plane.area() + 1, 0);
  for (std::size_t i = 0; i < position_.size(); ++i) {
    if (evaluated_[i] == 0) ++free.begin[pixel_of(position_[i], task_.plane) + 1];
  }
  for (std::size_t p = 0; p + 1 < free.begin.size(); ++p) free.begin[p + 1] += free.begin[p];
  free.id.resize(free.begin.back());
  std::vector<std::uint64_t> end(free.begin.begin(), free.begin.end() - 1);
  for (std::size_t i = 0; i < position_.size(); ++i) {
    if (evaluated_[i] == 0) free.id[end[pixel_of(position_[i], task_.plane)]++] = static_cast<std::uint32_t>(i);
  }
  return free;
}

/// New places for all free particles: the density wanted less what has been evaluated, pixel by pixel.
void SphAdaptiveThesis::redraw_all() {
  const Extent plane = task_.plane;
  const Grid<double> target = by_pixel(density_, plane, static_cast<double>(task_.budget));
  // Targets are rounded before the counts are subtracted, up or down by an even dither that stays the same in every
  // pass (R2 sequence, Roberts 2018). Else the pixels that are a fraction of a sample short get a whole one now and
  // then, the others ask again in the next pass, and the flat ones take what the busy ones lack.
  const Vec2f shift = Rng(task_.seed, stream_id("dither of targets")).uniform2();
  const Extent map = density_.size();
  const std::uint32_t cells = map.width / plane.width;
  Grid<float> missing(map);
  double sum = 0;
  for (std::uint32_t y = 0; y < map.height; ++y) {
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const std::size_t pixel = target.index(x / cells, y / cells);
      const double phase = double{shift.x} + dither_x * (x / cells) + dither_y * (y / cells);
      const double wanted = std::floor(target[pixel] + phase - std::floor(phase));
      const double share = std::max(0.0, wanted - count_[pixel]) / target[pixel];
      missing.at(x, y) = static_cast<float>(double{density_.at(x, y)} * share);
      sum += double{missing.at(x, y)};
    }
  }
  if (!(sum > 0)) return;
  const auto pass = static_cast<std::uint64_t>(passes_);
  const std::uint64_t seed = Rng(task_.seed, stream_id("redrawn particles"), pass).next();
  std::vector<Vec2f> places = draw_deficit(missing, Grid<float>(map), task_.budget - emitted_, plane, seed,
                                           stream_id("places of redrawn particles"));
  separate_coincident(places, plane, seed);
  std::size_t at = 0;
  for (std::size_t i = 0; i < position_.size(); ++i) {
    if (evaluated_[i] == 0) position_[i] = places[at++];
  }
}

/// New places for the free particles that are more than what is missing where they are. The difference is smoothed, so
/// that the counts of an even set, which are whole, move no particle.
void SphAdaptiveThesis::redraw_surplus() {
  const Extent plane = task_.plane;
  const Grid<double> target = by_pixel(density_, plane, static_cast<double>(task_.budget));
  const FreeParticles free = free_by_pixel();
  Grid<float> surplus(plane);
  for (std::size_t p = 0; p < plane.area(); ++p) {
    const auto here = static_cast<double>(free.begin[p + 1] - free.begin[p]);
    surplus[p] = static_cast<float>(here + count_[p] - target[p]);
  }
  blur(surplus, surplus_blur);
  Grid<float> lacking(plane);
  std::vector<std::uint32_t> drawn;
  double due = 0;
  for (std::size_t p = 0; p < plane.area(); ++p) {
    lacking[p] = std::max(0.0F, -surplus[p] - surplus_noise);
    due += std::max(0.0, double{surplus[p]} - double{surplus_noise});
    // In the order of their pixels: which particle of a pixel comes first is no function of its place in it.
    for (std::uint64_t k = free.begin[p]; k < free.begin[p + 1] && due >= 1; ++k, due -= 1) drawn.push_back(free.id[k]);
    due = std::min(due, 2.0);  // what a pixel cannot give is not taken from its neighbours
  }
  const auto pass = static_cast<std::uint64_t>(passes_);
  const std::uint64_t seed = Rng(task_.seed, stream_id("surplus particles"), pass).next();
  std::vector<Vec2f> places =
      draw_deficit(lacking, Grid<float>(plane), drawn.size(), plane, seed, stream_id("places of surplus particles"));
  if (places.empty()) return;
  separate_coincident(places, plane, seed);
  for (std::size_t k = 0; k < drawn.size(); ++k) position_[drawn[k]] = places[k];
}

/// Relaxes in the size field of density_, or without one while that is empty.
void SphAdaptiveThesis::simulate(int steps) {
  const bool redraw = params_.redraw != "never" && !density_.cells().empty();
  if (redraw && params_.redraw == "all") redraw_all();
  if (redraw && params_.redraw == "surplus") redraw_surplus();
  if (redraw || !solver_) {
    solver_ = make_solver();
    std::vector<std::uint32_t> frozen;
    for (std::uint32_t i = 0; params_.freezing && i < evaluated_.size(); ++i) {
      if (evaluated_[i] != 0) frozen.push_back(i);
    }
    if (!frozen.empty()) solver_->freeze(frozen);
  }
  if (!density_.cells().empty()) {
    Grid<float> size(density_.size());
    for (std::size_t i = 0; i < size.cells().size(); ++i) size[i] = 1 / std::sqrt(density_[i]);
    solver_->set_size_field(size);
  }
  const sph::RelaxReport report = solver_->relax(steps, false);
  non_finite_ += report.non_finite;
  backend_ = solver_->backend();
  const auto now = solver_->positions();
  for (std::size_t i = 0; i < position_.size(); ++i) {
    // What is frozen keeps the place it was evaluated at to the last bit.
    if (!params_.freezing || evaluated_[i] == 0) position_[i] = now[i];
  }
  const auto ring = solver_->ghosts();
  ghosts_.assign(ring.begin(), ring.end());
}

/// Evaluates one random particle that is not yet evaluated in every pixel that has one; in the last pass, all.
void SphAdaptiveThesis::freeze_pass() {
  const Extent plane = task_.plane;
  const FreeParticles free = free_by_pixel();
  const bool last = passes_ + 1 >= params_.most_passes;
  batch_.clear();
  std::vector<std::uint32_t> chosen;
  for (std::size_t p = 0; p < plane.area(); ++p) {
    const auto here = static_cast<std::uint32_t>(free.begin[p + 1] - free.begin[p]);
    if (here == 0) continue;
    const std::uint64_t draw = static_cast<std::uint64_t>(passes_) * plane.area() + p;
    const std::uint32_t pick = Rng(task_.seed, stream_id("frozen particle"), draw).below(here);
    for (std::uint32_t k = 0; k < here; ++k) {
      if (k != pick && !last) continue;
      chosen.push_back(free.id[free.begin[p] + k]);
      ++count_[p];
      if (k != pick) ++at_once_;
    }
  }
  for (const std::uint32_t i : chosen) {
    evaluated_[i] = 1;
    batch_.push_back(position_[i]);
  }
  if (params_.freezing) solver_->freeze(chosen);
  emitted_ += batch_.size();
  ++passes_;
}

SampleBatch SphAdaptiveThesis::next(const Feedback& seen) {
  if (emitted_ == task_.budget) {
    solver_.reset();
    return {};
  }
  const bool first = passes_ == 0;
  if (first) {
    position_ = relaxation_start(params_.start, task_.plane, task_.budget, task_.seed);
    evaluated_.assign(position_.size(), 0);
    count_ = Grid<std::uint32_t>(task_.plane);
  }
  keep_values(seen);
  if (!first || params_.variance == "true") set_density(variance(seen));
  simulate(first ? params_.first_iterations : params_.iterations);
  freeze_pass();
  return {.position = batch_};
}

std::vector<Diagnostic> SphAdaptiveThesis::diagnostics() const {
  if (passes_ == 0) return {};
  std::uint64_t few = 0;
  std::uint32_t largest = 0;
  for (const std::uint32_t n : count_.cells()) {
    few += n <= few_samples ? 1 : 0;
    largest = std::max(largest, n);
  }
  std::vector<Diagnostic> result = {
      {"passes", static_cast<double>(passes_)},
      {"pixels_of_3_or_fewer", static_cast<double>(few) / static_cast<double>(count_.cells().size())},
      {"largest_count", static_cast<double>(largest)},
      {"ghosts", static_cast<double>(ghosts_.size())},
      {"backend", 0, backend_},
  };
  if (!density_.cells().empty()) {
    const Grid<double> target = by_pixel(density_, task_.plane, static_cast<double>(task_.budget));
    const double mean = static_cast<double>(task_.budget) / static_cast<double>(task_.plane.area());
    double wanted = 0;
    double there = 0;
    for (std::size_t i = 0; i < target.cells().size(); ++i) {
      if (target[i] < high_target * mean) continue;
      wanted += target[i];
      there += count_[i];
    }
    if (wanted > 0) {
      result.push_back({"high_target_reached", there / wanted});
    }
  }
  Diagnostic left{"emitted_at_once", static_cast<double>(at_once_)};
  if (at_once_ > 0)
    left.text = "samples were emitted together after most_passes passes; a larger most_passes adapts them too";
  result.push_back(left);
  Diagnostic dropped{"non_finite", static_cast<double>(non_finite_)};
  if (non_finite_ > 0) {
    dropped.text = "steps of particles were not finite and were dropped; a larger delta is stable";
    dropped.warning = true;
  }
  result.push_back(dropped);
  return result;
}

}  // namespace abn
