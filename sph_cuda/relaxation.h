// A relaxation on a device: which kernels make up a step, and the memory they work on. The device is a parameter: CUDA
// (cuda_device.h), or a loop over blocks and threads on the host (host_device.h), by which a machine without a GPU
// tests all of this bit for bit against the CPU engine.
//
// A device has
//   Buffer<T>            memory for values: reset(count), upload(span), upload_at(first, span), download(count),
//                        download_at(first, count), data(), size()
//   launch(n, body)      body(i) for i < n, in any order
//   launch_blocks(blocks, body)
//                        body(phase, block, thread, shared) for all blocks and their Body::threads, phase by phase:
//                        body.phases(block) of them, with body.shared_bytes() of memory that the threads share
//   prepare_sums(n), exclusive_sum(in, out, n)
//   prepare_sort(n), sort_pairs(key, sorted_key, value, sorted_value, n)
//                        by rising 64-bit keys; equal ones keep their order
//   replay(owner, key, enqueue)
//                        enqueue(), or what it enqueued when last called with that key since forget(owner)
//   name                 what Solver::backend() says
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/sph/bodies.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/problem.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/sum_kernels.h"
#include "sph_cuda/sums.h"

namespace abn::sph_cuda {

template <class Device>
class Relaxation {
 public:
  explicit Relaxation(Device& device) : device_(device) {}

  /// Makes room for `count` particles at rest, none of them fixed; those with an id of problem.particles or more are
  /// ghosts. Of the problem neither positions and labels nor the field's raster are looked at, which is `field`, on the
  /// device, null = uniform; it must stay there until the next reset(). Throws DeviceError for too many particles or
  /// too little memory.
  void reset(const sph::Setup& setup, const sph::Problem& problem, std::size_t count, const sph::FieldCell* field) {
    device_.forget(this);
    if (count > std::numeric_limits<std::uint32_t>::max()) {
      throw DeviceError(
          "SPH on a device: " + std::to_string(count) +
          " particles, ghosts included, are more than 2^32-1; ask for fewer samples or use --backend cpu");
    }
    setup_ = setup;
    problem_ = without_host_data(problem);
    field_ = field;
    n_ = static_cast<std::uint32_t>(count);
    cells_ = sph::cells_for<float>(problem);
    tiles_.reset(cells_.tiles().size());
    tiles_.upload(cells_.tiles());
    cell_count_.reset(cells_.size() + 1);
    cell_start_.reset(cells_.size() + 1);
    device_.prepare_sums(static_cast<std::uint32_t>(cells_.size() + 1));
    control_.reset(1);
    loose_.reset(n_);
    sorted_.reset(n_);
    for (auto* buffer : {&cell_, &place_, &order_}) buffer->reset(n_);
    for (auto* buffer : {&density_, &pressure_, &moved_}) buffer->reset(n_);
    const bool sized = problem.terms.sized;
    const bool classed = problem.terms.classed;
    for (auto* buffer : {&size_, &reach_, &pull_x_, &pull_y_}) buffer->reset(sized ? n_ : 0);
    for (auto* buffer : {&class_density_, &class_pressure_, &label_}) buffer->reset(classed ? n_ : 0);
    if (sized) {  // classes need sizes, which without a field are 1
      for (auto* buffer : {&size_, &reach_}) device_.launch(n_, Fill<float>{buffer->data(), 1});
      for (auto* buffer : {&pull_x_, &pull_y_}) device_.launch(n_, Fill<float>{buffer->data(), 0});
    }
    label_of_.reset(0);
    fixed_.reset(n_);
    any_fixed_ = false;
    device_.launch(n_, StartAtRest{loose_.arrays(), fixed_.data()});
    density_sums_.reset(n_);
    class_density_sums_.reset(n_);
    motion_sums_.reset(n_);
  }

  /// Positions by id [count], [d], on the torus: to be written before the first run().
  float* x() { return loose_.x.data(); }
  float* y() { return loose_.y.data(); }
  void upload(const std::vector<float>& x, const std::vector<float>& y) {
    loose_.x.upload(x);
    loose_.y.upload(y);
  }
  /// By id [count]: 1 = moves no more. Whoever asks for it may write there.
  std::uint8_t* fixed() {
    if (!any_fixed_) device_.forget(this);
    any_fixed_ = true;
    return fixed_.data();
  }
  void upload_fixed(const std::vector<std::uint8_t>& fixed_by_id) {
    fixed();
    fixed_.upload(fixed_by_id);
  }
  /// Classes by id [count]; none = one class.
  void upload_labels(const std::vector<std::uint8_t>& labels) {
    label_of_.reset(labels.size());
    if (!labels.empty()) label_of_.upload(labels);
  }

  void run(sph::RelaxControl& control) {
    if (control.done) return;
    control_.upload(std::vector<sph::RelaxControl>{control});
    // The flag that ends the relaxation is read once per batch; steps after the last one do nothing.
    const int batch = std::min(control.max_steps, steps_per_batch);
    const auto enqueue = [&] {
      for (int s = 0; s < batch; ++s) enqueue_step();
    };
    // To record a batch takes longer than to launch it a few times.
    const bool record = control.max_steps > 4 * steps_per_batch;
    while (!control.done) {
      if (record) {
        device_.replay(this, batch, enqueue);
      } else {
        enqueue();
      }
      control = control_.download(1)[0];
    }
  }

  /// Writes positions by id [count each], [d], to the device's memory.
  void store(float* x_by_id, float* y_by_id) { device_.launch(n_, StoreById{loose_.arrays(), x_by_id, y_by_id}); }

  /// Density and force by id [particles each], to the device's memory, as at the present positions.
  void evaluate(float* density, float* force_x, float* force_y) {
    control_.upload(std::vector<sph::RelaxControl>(1));
    enqueue_sort();
    enqueue_pressures();
    const auto particles = static_cast<std::uint32_t>(problem_.particles);
    sph::with_terms(problem_.terms, [&]<sph::Terms terms>() {
      device_.launch(n_, ReportForces<terms>{sorted_view(), pull_x_.data(), pull_y_.data(), density_.data(), particles,
                                             density, force_x, force_y});
    });
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  static constexpr int steps_per_batch = 8;

  struct ParticleBuffers {
    Buffer<float> x, y, vx, vy;
    Buffer<std::uint32_t> id;
    void reset(std::size_t n) {
      for (auto* buffer : {&x, &y, &vx, &vy}) buffer->reset(n);
      id.reset(n);
    }
    ParticleArrays arrays() { return {x.data(), y.data(), vx.data(), vy.data(), id.data()}; }
  };

  static sph::Problem without_host_data(const sph::Problem& problem) {
    sph::Problem own;
    own.field = problem.field;
    own.field.cells.clear();
    own.terms = problem.terms;
    own.spacing = problem.spacing;
    own.plane_x = problem.plane_x;
    own.plane_y = problem.plane_y;
    own.walls = problem.walls;
    own.support = problem.support;
    own.class_support = problem.class_support;
    own.particles = problem.particles;
    return own;
  }

  void enqueue_step() {
    enqueue_sort();
    const bool densities = !std::isinf(setup_.stiffness_ratio);
    if (densities) {
      enqueue_pressures();
    } else {
      set_pressures_to_one();
    }
    sph::Motion<float> motion;
    motion.damping = setup_.damping;
    motion.cap = setup_.velocity_cap;
    motion.walls = problem_.walls;
    motion.length_x = static_cast<float>(motion.walls ? problem_.plane_x : problem_.field.length_x);
    motion.length_y = static_cast<float>(motion.walls ? problem_.plane_y : problem_.field.length_y);
    sph::with_terms(problem_.terms, [&]<sph::Terms terms>() {
      device_.launch(
          n_, MoveParticles<terms>{control_.data(), sorted_view(), sorted_.arrays(), loose_.arrays(), pull_x_.data(),
                                   pull_y_.data(), any_fixed_ ? fixed_.data() : nullptr, motion, moved_.data()});
    });
    motion_sums_.find(device_, control_.data(), n_, MotionOfParticle{moved_.data(), setup_.tolerance});
    device_.launch(1, FinishStep{control_.data(), motion_sums_.total(), densities ? density_sums_.total() : nullptr,
                                 static_cast<double>(problem_.particles)});
  }

  /// From loose_ to sorted_.
  void enqueue_sort() {
    const auto cells = static_cast<std::uint32_t>(cells_.size());
    device_.launch(cells + 1, Fill<std::uint32_t>{cell_count_.data(), 0});
    device_.launch(
        n_, CountCells{control_.data(), cell_view(), loose_.arrays(), cell_.data(), place_.data(), cell_count_.data()});
    device_.exclusive_sum(cell_count_.data(), cell_start_.data(), cells + 1);
    device_.launch(n_,
                   ScatterIntoCells{control_.data(), cell_.data(), place_.data(), cell_start_.data(), order_.data()});
    device_.launch(cells, SortCells{control_.data(), loose_.id.data(), cell_start_.data(), order_.data()});
    sph::FieldView<float> field = problem_.field.template view<float>();
    field.cells = field_;
    device_.launch(n_, GatherSorted{control_.data(), order_.data(), loose_.arrays(), sorted_.arrays(), field,
                                    label_of_.size() > 0 ? label_of_.data() : nullptr, size_.data(), reach_.data(),
                                    pull_x_.data(), pull_y_.data(), label_.data()});
  }

  void enqueue_pressures() {
    const auto particles = static_cast<std::uint32_t>(problem_.particles);
    const float inverse_delta = 1 / setup_.stiffness_ratio;
    const auto mean_over = static_cast<double>(problem_.particles);
    const auto constant = sph::density_constants<float>(problem_.terms, problem_.support, problem_.class_support);
    sph::with_terms(problem_.terms, [&]<sph::Terms terms>() {
      device_.launch(
          n_, FindDensity<terms>{control_.data(), sorted_view(), constant, density_.data(), class_density_.data()});
    });
    density_sums_.find(device_, control_.data(), n_, DensityOfParticle{density_.data(), sorted_.id.data(), particles});
    device_.launch(n_, FindPressure{control_.data(), density_.data(), density_sums_.total(), mean_over, inverse_delta,
                                    pressure_.data()});
    if (!problem_.terms.classed) return;
    class_density_sums_.find(device_, control_.data(), n_,
                             DensityOfParticle{class_density_.data(), sorted_.id.data(), particles});
    device_.launch(n_, FindPressure{control_.data(), class_density_.data(), class_density_sums_.total(), mean_over,
                                    inverse_delta, class_pressure_.data()});
  }

  /// What FindPressure gives for an infinite Delta whatever the densities are.
  void set_pressures_to_one() {
    device_.launch(n_, Fill<float>{pressure_.data(), 1});
    if (problem_.terms.classed) device_.launch(n_, Fill<float>{class_pressure_.data(), 1});
  }

  sph::CellView<float> cell_view() {
    sph::CellView<float> view = cells_.view();
    view.tiles = tiles_.data();
    return view;
  }

  sph::ParticleView<float> sorted_view() {
    sph::ParticleView<float> view;
    view.cells = cell_view();
    view.cell_start = cell_start_.data();
    view.x = sorted_.x.data();
    view.y = sorted_.y.data();
    view.size = size_.data();
    view.reach = reach_.data();
    view.label = label_.data();
    view.pressure = pressure_.data();
    view.class_pressure = class_pressure_.data();
    view.id = sorted_.id.data();
    view.support = static_cast<float>(problem_.support);
    view.class_support = static_cast<float>(problem_.class_support);
    return view;
  }

  Device& device_;
  sph::Setup setup_;
  sph::Problem problem_;  // without what lies on the device
  const sph::FieldCell* field_ = nullptr;
  std::uint32_t n_ = 0;
  bool any_fixed_ = false;
  sph::Cells<float> cells_{1, 1, 1};
  Buffer<sph::Tile<float>> tiles_;
  Buffer<std::uint32_t> cell_count_, cell_start_;  // [cells + 1]
  Buffer<sph::RelaxControl> control_;
  ParticleBuffers loose_;   // as the last step left them
  ParticleBuffers sorted_;  // as this step found them, by cell and id
  Buffer<std::uint32_t> cell_, place_, order_;
  Buffer<float> density_, pressure_, moved_, size_, reach_, pull_x_, pull_y_, class_density_, class_pressure_, label_;
  Buffer<std::uint8_t> label_of_, fixed_;  // by id; no labels = one class
  Sum<Device, SumOfChunk> density_sums_, class_density_sums_;
  Sum<Device, MotionOfChunk> motion_sums_;
};

}  // namespace abn::sph_cuda
