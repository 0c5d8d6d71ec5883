#include "sampling/adaptive/adaptive_plane.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "sampling/adaptive/allocation.h"
#include "sampling/adaptive/drivers.h"
#include "sampling/adaptive/gabriel.h"
#include "sampling/adaptive/local_variance.h"
#include "sampling/adaptive/map_rules.h"
#include "sampling/adaptive/pixel_variance.h"
#include "sampling/adaptive/straight_edges.h"
#include "sampling/rng.h"

namespace abn {
namespace {

class HostAdaptivePlane final : public AdaptivePlane {
 public:
  HostAdaptivePlane(const AdaptivePlaneOptions& options, const sph::SolverFactory& solver)
      : options_(options), solver_(solver) {}

  void add(std::span<const Vec2f> position, std::span<const float> value, std::span<const float> light,
           std::uint32_t channels) override {
    assert(value.size() == position.size() * channels);
    if (position_.empty()) {
      const auto n = static_cast<double>(position.size());
      density_ = Grid<float>(options_.map, static_cast<float>(n / static_cast<double>(options_.plane.area())));
    }
    channels_ = channels;
    position_.insert(position_.end(), position.begin(), position.end());
    value_.insert(value_.end(), value.begin(), value.end());
    if (options_.both_lights) light_.insert(light_.end(), light.begin(), light.end());
    driver_ = {};
  }

  Grid<float> driver() override {
    if (driver_.size() == options_.map) return driver_;
    driver_ = driver_of(value_);
    if (options_.both_lights) {
      driver_ = both_drivers(driver_, driver_of(light_), options_.exponent, options_.light_share);
    }
    return driver_;
  }

  double uniform_share() override { return abn::uniform_share(driver()); }

  std::vector<Vec2f> add_by_density(const DensityPass& pass) override {
    assert(pass.target > position_.size());
    Grid<float> wanted = allocate(weights(pass.even), density_, static_cast<double>(pass.target),
                                  options_.most_ratio * pass.mean_density, options_.plane);
    std::vector<Vec2f> all = position_;
    const std::vector<Vec2f> fresh = draw_deficit(wanted, density_, pass.target - position_.size(), options_.plane,
                                                  pass.seed, stream_id("sph_adaptive"));
    all.insert(all.end(), fresh.begin(), fresh.end());
    Grid<float> size = wanted;
    density_ = std::move(wanted);
    blur(size, 1);
    for (float& s : size.cells()) s = spacing_for(s, least_share_of_mean * static_cast<float>(pass.mean_density));
    sph::Setup setup = setup_of_pass(options_);
    setup.positions = all;
    setup.size_field = &size;
    const auto solver = solver_ ? solver_(setup) : sph::make_cpu_solver(setup);
    backend_ = solver->backend();
    std::vector<std::uint32_t> frozen(position_.size());
    std::iota(frozen.begin(), frozen.end(), 0U);
    solver->freeze(frozen);
    solver->relax(options_.iterations, false);
    const auto placed = solver->positions();
    const auto ring = solver->ghosts();
    ghosts_.assign(ring.begin(), ring.end());
    return {placed.begin() + static_cast<std::ptrdiff_t>(position_.size()), placed.end()};
  }

  std::vector<Vec2f> refine(std::size_t count, std::uint64_t seed) override {
    GabrielOptions options;
    options.activity = options_.refine_activity;
    return gabriel_midpoints(position_, value_, channels_, options_.plane, count, seed, options).position;
  }
  double straight_edge_share() override {
    return abn::straight_edge_share(position_, value_, channels_, options_.plane);
  }
  std::span<const Vec2f> ghosts() const override { return ghosts_; }
  const char* backend() const override { return backend_; }

 private:
  Grid<float> driver_of(const std::vector<float>& value) const {
    Grid<float> map =
        options_.driver == Driver::variance
            ? local_variance(position_, value, channels_, options_.plane, options_.map, options_.neighbours)
            : driver_without_search(options_, position_, value, channels_);
    if (options_.driver != Driver::guide) blur(map, options_.blur);
    return map;
  }

  Grid<float> weights(bool even) {
    if (even) return Grid<float>(options_.map, 1.0F);
    return density_weights(driver(), options_.floor, options_.exponent);
  }

  AdaptivePlaneOptions options_;
  sph::SolverFactory solver_;
  std::vector<Vec2f> position_;
  std::vector<float> value_, light_;
  std::uint32_t channels_ = 1;
  Grid<float> driver_;   // of all samples; empty = not yet known
  Grid<float> density_;  // of all samples [1/px^2]
  std::vector<Vec2f> ghosts_;
  const char* backend_ = "";
};

}  // namespace

std::unique_ptr<AdaptivePlane> make_adaptive_plane(const AdaptivePlaneOptions& options,
                                                   const sph::SolverFactory& solver) {
  return std::make_unique<HostAdaptivePlane>(options, solver);
}

Grid<float> driver_without_search(const AdaptivePlaneOptions& options, std::span<const Vec2f> position,
                                  std::span<const float> value, std::uint32_t channels) {
  assert(options.driver != Driver::variance);
  if (options.driver == Driver::guide) return resampled(*options.guide, options.map);
  // A bell of about the neighbours' number of samples.
  const double per_cell = static_cast<double>(position.size()) / static_cast<double>(options.map.area());
  const auto reach = static_cast<int>(std::clamp(std::sqrt(options.neighbours / (6.3 * per_cell)), 1.0, 16.0));
  Grid<float> map = local_mean(position, value, channels, options.plane, options.map, reach);
  for (float& mean : map.cells()) mean = std::max(mean, 0.0F);
  return options.driver == Driver::gradient ? squared_gradient(map) : map;
}

sph::Setup setup_of_pass(const AdaptivePlaneOptions& options) {
  sph::Setup setup;
  setup.plane = options.plane;
  setup.boundary = options.boundary;
  setup.stiffness_ratio = options.delta;
  setup.background = false;  // the new particles are drawn from the density and have no time to drift from it
  setup.ghost_steps = 15;
  setup.seed = options.seed;
  return setup;
}

}  // namespace abn
