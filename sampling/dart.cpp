#include "sampling/dart.h"

#include <algorithm>
#include <span>
#include <string>

#include "sampling/disk_grid.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

constexpr std::size_t max_batch = 1U << 20;
// Below this share of the reference radius only the resolution of float positions can be what keeps points apart.
constexpr double lowest_radius = 0.25;

}  // namespace

const StrategyInfo Dart::info = {
    .name = "dart",
    .family = "blue noise",
    .summary =
        "random darts on the torus; one too close to an earlier one is thrown away, the radius lowered as needed",
    .cite =
        "Cook 1986, Stochastic sampling in computer graphics; McCool & Fiume 1992, Hierarchical Poisson disk "
        "sampling distributions",
    .advice = "the classical Poisson-disk reference; poisson_disk is faster",
};

std::vector<Field<Dart::Params>> Dart::fields() {
  return {
      {"radius", &Params::radius, "distance aimed at [densest packing's]; lowered by 1 % when too many darts miss", 0.3,
       0.9},
      {"throws", &Params::throws, "darts per sample before the radius is lowered", 1, 1e6},
  };
}

Dart::Dart(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  if (task.budget > max_disk_points) {
    throw ConfigError("dart holds all its points in memory: " + std::to_string(task.budget) +
                      " samples are too many; give at most " + std::to_string(max_disk_points) + " with --samples");
  }
}

void Dart::generate() {
  const double reference = reference_radius(task_.plane, task_.budget);
  DiskGrid grid(task_.plane, params_.radius * reference);
  Rng rng(task_.seed, stream_id("dart"));
  const std::uint64_t darts_per_radius = static_cast<std::uint64_t>(params_.throws) * task_.budget;
  std::uint64_t left = darts_per_radius;
  while (grid.points().size() < task_.budget) {
    if (left == 0) {
      const double lower = 0.99 * grid.radius();
      grid.lower_radius(lower < lowest_radius * reference ? 0.0 : lower);
      left = darts_per_radius;
    }
    const float x = uniform_position(rng, task_.plane.width);
    grid.try_add({x, uniform_position(rng, task_.plane.height)});
    ++darts_;
    --left;
  }
  radius_ = grid.radius();
  points_ = grid.take_points();
}

SampleBatch Dart::next(const Feedback&) {
  if (points_.empty() && task_.budget > 0) generate();
  const auto rest = std::span<const Vec2f>(points_).subspan(emitted_);
  const auto batch = rest.first(std::min(rest.size(), max_batch));
  emitted_ += batch.size();
  return {.position = batch};
}

std::vector<Diagnostic> Dart::diagnostics() const {
  if (points_.empty()) return {};
  std::vector<Diagnostic> list = {
      {"relative_radius", radius_ / reference_radius(task_.plane, task_.budget)},
      {"min_distance", radius_},
      {"darts", static_cast<double>(darts_)},
  };
  if (radius_ == 0) {
    list.push_back(
        {"distance_lost", 1, "the plane's float positions are too coarse to keep so many points apart", true});
  }
  return list;
}

}  // namespace abn
