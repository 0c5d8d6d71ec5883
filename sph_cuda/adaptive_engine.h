// AdaptivePlane on a device of relaxation.h: everything that a pass computes stays there from pass to pass. The samples
// to be evaluated come to the host, their values go to the device.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sampling/adaptive/adaptive_plane.h"
#include "sampling/adaptive/gabriel.h"
#include "sampling/rng.h"
#include "sampling/sph/problem.h"
#include "sampling/sph/stepping_solver.h"
#include "sph_cuda/gabriel_engine.h"
#include "sph_cuda/map_engine.h"
#include "sph_cuda/sized_relaxation.h"
#include "sph_cuda/straight_edge_engine.h"
#include "sph_cuda/variance_engine.h"

namespace abn::sph_cuda {

/// What the passes of a plane need on a device; planes may use it one after the other, so that memory once taken serves
/// the next one.
template <class Device>
struct AdaptiveWorkspace {
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  explicit AdaptiveWorkspace(Device d = {}) : device(std::move(d)) {}
  AdaptiveWorkspace(const AdaptiveWorkspace&) = delete;
  AdaptiveWorkspace& operator=(const AdaptiveWorkspace&) = delete;

  Device device;
  MapEngine<Device> maps{device};
  VarianceEngine<Device> variance;
  GabrielEngine<Device> gabriel;
  StraightEdgeEngine<Device> edges;
  Relaxation<Device> relaxation{device};
  SizedRelaxation<Device> sized{device, relaxation};
  Buffer<Vec2f> position;                                          // [most samples], those evaluated first
  Buffer<float> value, light;                                      // [most samples * channels]
  Buffer<float> driver, other_driver, density, wanted, map, size;  // [map]
  Buffer<float> x, y;
};

template <class Device>
class DeviceAdaptivePlane final : public AdaptivePlane {
 public:
  DeviceAdaptivePlane(const AdaptivePlaneOptions& options, std::shared_ptr<AdaptiveWorkspace<Device>> workspace)
      : options_(options), cells_(static_cast<std::uint32_t>(options.map.area())), on_(std::move(workspace)) {
    on_->maps.reset(options.plane, options.map);
    for (auto* buffer : {&on_->driver, &on_->density, &on_->wanted, &on_->map, &on_->size}) buffer->reset(cells_);
    on_->position.reset(static_cast<std::size_t>(options.most_samples));
  }

  void add(std::span<const Vec2f> position, std::span<const float> value, std::span<const float> light,
           std::uint32_t channels) override {
    assert(value.size() == position.size() * channels);
    if (samples_ == 0) begin(position.size(), channels);
    on_->position.upload_at(samples_, position);
    on_->value.upload_at(std::size_t{samples_} * channels, value);
    if (options_.both_lights) on_->light.upload_at(std::size_t{samples_} * channels, light);
    if (options_.driver != Driver::variance) {  // found on the host
      position_.insert(position_.end(), position.begin(), position.end());
      value_.insert(value_.end(), value.begin(), value.end());
      light_.insert(light_.end(), light.begin(), light.end());
    }
    samples_ += static_cast<std::uint32_t>(position.size());
    driver_known_ = false;
  }

  Grid<float> driver() override {
    find_driver();
    Grid<float> map(options_.map);
    const std::vector<float> cells = on_->driver.download(cells_);
    std::copy(cells.begin(), cells.end(), map.cells().begin());
    return map;
  }
  double uniform_share() override {
    find_driver();
    return on_->maps.uniform_share(on_->driver.data());
  }

  std::vector<Vec2f> add_by_density(const DensityPass& pass) override {
    assert(pass.target > samples_ && pass.target <= options_.most_samples);
    float* weight = on_->map.data();
    if (pass.even) {
      on_->maps.fill(weight, 1);
    } else {
      find_driver();
      on_->maps.weigh(on_->driver.data(), options_.floor, options_.exponent, weight);
    }
    on_->maps.allocate(weight, on_->density.data(), static_cast<double>(pass.target),
                       options_.most_ratio * pass.mean_density, on_->wanted.data());
    const auto fresh = static_cast<std::uint32_t>(pass.target - samples_);
    on_->maps.draw(on_->wanted.data(), on_->density.data(), fresh, pass.seed, stream_id("sph_adaptive"),
                   on_->position.data() + samples_);
    std::swap(on_->density, on_->wanted);
    float* smoothed = on_->map.data();
    on_->device.launch(cells_, Copy<float>{on_->density.data(), smoothed});
    on_->maps.blur(smoothed, 1);
    on_->maps.find_spacing(smoothed, pass.mean_density, on_->size.data());
    relax(fresh);
    return on_->position.download_at(samples_, fresh);
  }

  std::vector<Vec2f> refine(std::size_t count, std::uint64_t seed) override {
    GabrielOptions options;
    options.activity = options_.refine_activity;
    return on_->gabriel
        .midpoints(on_->device, on_->position.data(), on_->value.data(), samples_, channels_, options_.plane, count,
                   seed, options)
        .position;
  }
  double straight_edge_share() override {
    return on_->edges.share(on_->device, on_->position.data(), on_->value.data(), samples_, channels_, options_.plane);
  }
  std::span<const Vec2f> ghosts() const override { return ghosts_; }
  const char* backend() const override { return backend_; }

 private:
  void begin(std::size_t first_samples, std::uint32_t channels) {
    channels_ = channels;
    const auto most = static_cast<std::size_t>(options_.most_samples);
    on_->value.reset(most * channels);
    on_->light.reset(options_.both_lights ? most * channels : 0);
    const double density = static_cast<double>(first_samples) / static_cast<double>(options_.plane.area());
    on_->maps.fill(on_->density.data(), static_cast<float>(density));
  }

  void find_driver() {
    if (driver_known_) return;
    find_driver_of(on_->value.data(), value_, on_->driver);
    if (options_.both_lights) {
      on_->other_driver.reset(cells_);
      find_driver_of(on_->light.data(), light_, on_->other_driver);
      on_->maps.mix(on_->driver.data(), on_->other_driver.data(), options_.exponent, options_.light_share);
    }
    driver_known_ = true;
  }
  template <class Map>
  void find_driver_of(const float* value, const std::vector<float>& host_value, Map& driver) {
    if (options_.driver == Driver::variance) {
      on_->variance.find(on_->device, on_->position.data(), value, samples_, channels_, options_.plane, options_.map,
                         options_.neighbours, driver.data());
    } else {
      driver.upload(driver_without_search(options_, position_, host_value, channels_).cells());
    }
    if (options_.driver != Driver::guide) on_->maps.blur(driver.data(), options_.blur);
  }

  /// Moves the `fresh` positions after the samples, which are held, by the size field.
  void relax(std::uint32_t fresh) {
    const std::uint32_t particles = samples_ + fresh;
    const sph::Setup setup = setup_of_pass(options_);
    const sph::Problem problem =
        on_->sized.place(setup, on_->size.data(), options_.map, on_->position.data(), particles);
    const std::uint32_t ghosts = on_->sized.ghosts();
    std::uint8_t* fixed = on_->relaxation.fixed();
    on_->device.launch(samples_, Fill<std::uint8_t>{fixed, 1});
    on_->device.launch(ghosts, Fill<std::uint8_t>{fixed + particles, 1});
    sph::RelaxControl control = sph::relax_control(setup, false, fresh, options_.iterations, false);
    on_->relaxation.run(control);
    for (auto* buffer : {&on_->x, &on_->y}) buffer->reset(std::size_t{particles} + ghosts);
    on_->relaxation.store(on_->x.data(), on_->y.data());
    on_->device.launch(fresh, place_on_plane(on_->x.data() + samples_, on_->y.data() + samples_, problem.spacing,
                                             options_.plane, on_->position.data() + samples_));
    keep_ghosts(problem, particles, ghosts);
    backend_ = Device::name;
  }
  void keep_ghosts(const sph::Problem& problem, std::uint32_t first, std::uint32_t count) {
    ghosts_.clear();
    const std::vector<float> x = on_->x.download_at(first, count);
    const std::vector<float> y = on_->y.download_at(first, count);
    for (std::size_t i = 0; i < count; ++i) ghosts_.push_back(sph::to_pixels(problem, double{x[i]}, double{y[i]}));
  }

  AdaptivePlaneOptions options_;
  std::uint32_t cells_;
  std::shared_ptr<AdaptiveWorkspace<Device>> on_;
  std::uint32_t samples_ = 0, channels_ = 1;
  bool driver_known_ = false;
  std::vector<Vec2f> position_, ghosts_;
  std::vector<float> value_, light_;  // only where the host finds the driver
  const char* backend_ = "";
};

}  // namespace abn::sph_cuda
