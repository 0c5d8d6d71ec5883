// The engine of sph::Solver on a device of relaxation.h: CUDA (solver.cu), or a loop on the host (host_device.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "sampling/sph/stepping_solver.h"
#include "sph_cuda/relaxation.h"
#include "sph_cuda/sized_relaxation.h"

namespace abn::sph_cuda {

template <class Device>
class DeviceSolver final : public sph::SteppingSolver {
 public:
  explicit DeviceSolver(const sph::Setup& setup, Device device = {})
      : SteppingSolver(setup), device_(std::move(device)) {
    load(problem());
  }

  sph::Evaluation evaluate() override {
    Buffer<float> density;
    Buffer<float> force_x;
    Buffer<float> force_y;
    for (auto* buffer : {&density, &force_x, &force_y}) buffer->reset(problem().particles);
    relaxation_.evaluate(density.data(), force_x.data(), force_y.data());
    return {as_doubles(density), as_doubles(force_x), as_doubles(force_y)};
  }

  const char* backend() const override { return Device::name; }

 protected:
  void load(const sph::Problem& problem) override {
    const std::size_t n = problem.count();
    const bool uniform = problem.field.uniform;
    field_.reset(uniform ? 0 : problem.field.cells.size());
    if (!uniform) field_.upload(problem.field.cells);
    relaxation_.reset(setup(), problem, n, uniform ? nullptr : field_.data());
    relaxation_.upload_labels(problem.labels);
    std::vector<float> x(n);
    std::vector<float> y(n);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = sph::wrap(static_cast<float>(problem.x[i]), static_cast<float>(problem.field.length_x));
      y[i] = sph::wrap(static_cast<float>(problem.y[i]), static_cast<float>(problem.field.length_y));
    }
    relaxation_.upload(x, y);
  }

  /// Not with the background force or classes, which only the host prepares, nor for a field that is an error.
  bool reload(const Grid<float>& s, sph::Problem& problem) override {
    const auto good = [](float value) { return value > 0 && value <= std::numeric_limits<float>::max(); };
    if (setup().background || !problem.labels.empty() || s.size().area() == 0 ||
        !std::all_of(s.cells().begin(), s.cells().end(), good)) {
      return false;
    }
    find_by_id(problem.count());
    const auto particles = static_cast<std::uint32_t>(problem.particles);
    position_.reset(particles);
    device_.launch(particles, place_on_plane(x_.data(), y_.data(), problem.spacing, setup().plane, position_.data()));
    size_.reset(s.cells().size());
    size_.upload(s.cells());
    problem = sized_.place(setup(), size_.data(), s.size(), position_.data(), particles);
    problem.x.resize(std::size_t{particles} + sized_.ghosts());
    problem.y.resize(problem.x.size());
    return true;
  }

  void run(sph::RelaxControl& control) override {
    if (control.done) return;
    if (!fixed().empty()) relaxation_.upload_fixed(fixed());
    relaxation_.run(control);
  }

  void store(std::vector<double>& x, std::vector<double>& y) override {
    find_by_id(problem().count());
    x = as_doubles(x_);
    y = as_doubles(y_);
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  static std::vector<double> as_doubles(const Buffer<float>& buffer) {
    const std::vector<float> values = buffer.download(buffer.size());
    return {values.begin(), values.end()};
  }

  /// The positions by id, ghosts included, in x_ and y_.
  void find_by_id(std::size_t count) {
    for (auto* buffer : {&x_, &y_}) buffer->reset(count);
    relaxation_.store(x_.data(), y_.data());
  }

  Device device_;
  Relaxation<Device> relaxation_{device_};
  SizedRelaxation<Device> sized_{device_, relaxation_};
  Buffer<sph::FieldCell> field_;
  Buffer<float> x_, y_, size_;
  Buffer<Vec2f> position_;
};

}  // namespace abn::sph_cuda
