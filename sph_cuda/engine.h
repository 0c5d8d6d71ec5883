// The engine on a device: which kernels make up a step, and the memory they work on. The device is a parameter: CUDA
// (solver.cu), or a loop over blocks and threads on the host (host_device.h), by which a machine without a GPU tests
// all of this bit for bit against the CPU engine.
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
#include <vector>

#include "sampling/error.h"
#include "sampling/sph/bodies.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/stepping_solver.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/sum_kernels.h"

namespace abn::sph_cuda {

template <class Device>
class DeviceSolver final : public sph::SteppingSolver {
 public:
  explicit DeviceSolver(const sph::Setup& setup, Device device = {})
      : SteppingSolver(setup), device_(std::move(device)) {
    load(problem());
  }

  sph::Evaluation evaluate() override {
    control_.upload(std::vector<sph::RelaxControl>(1));
    enqueue_sort();
    enqueue_pressures();
    const auto particles = static_cast<std::uint32_t>(problem().particles);
    Buffer<float> density;
    Buffer<float> force_x;
    Buffer<float> force_y;
    for (auto* buffer : {&density, &force_x, &force_y}) buffer->reset(particles);
    sph::with_terms(problem().terms, [&]<sph::Terms terms>() {
      device_.launch(n_, ReportForces<terms>{sorted_view(), pull_x_.data(), pull_y_.data(), density_.data(), particles,
                                             density.data(), force_x.data(), force_y.data()});
    });
    return {as_doubles(density), as_doubles(force_x), as_doubles(force_y)};
  }

  const char* backend() const override { return Device::name; }

 protected:
  void load(const sph::Problem& problem) override {
    device_.forget(this);
    if (problem.count() > std::numeric_limits<std::uint32_t>::max()) {
      throw DeviceError(
          "SPH on a device: " + std::to_string(problem.count()) +
          " particles, ghosts included, are more than 2^32-1; ask for fewer samples or use --backend cpu");
    }
    n_ = static_cast<std::uint32_t>(problem.count());
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
      size_.upload(std::vector<float>(n_, 1.0F));
      reach_.upload(std::vector<float>(n_, 1.0F));
      pull_x_.upload(std::vector<float>(n_, 0.0F));
      pull_y_.upload(std::vector<float>(n_, 0.0F));
    }
    label_of_.reset(problem.labels.size());
    label_of_.upload(problem.labels);
    field_.reset(problem.field.uniform ? 0 : problem.field.cells.size());
    if (!problem.field.uniform) field_.upload(problem.field.cells);
    density_sums_.reset(n_);
    class_density_sums_.reset(n_);
    motion_sums_.reset(n_);

    std::vector<float> x(n_);
    std::vector<float> y(n_);
    std::vector<std::uint32_t> id(n_);
    for (std::uint32_t i = 0; i < n_; ++i) {
      x[i] = sph::wrap(static_cast<float>(problem.x[i]), static_cast<float>(problem.field.length_x));
      y[i] = sph::wrap(static_cast<float>(problem.y[i]), static_cast<float>(problem.field.length_y));
      id[i] = i;
    }
    loose_.x.upload(x);
    loose_.y.upload(y);
    loose_.vx.upload(std::vector<float>(n_, 0.0F));
    loose_.vy.upload(std::vector<float>(n_, 0.0F));
    loose_.id.upload(id);
  }

  void run(sph::RelaxControl& control) override {
    if (control.done) return;
    if (fixed_.size() != fixed().size()) {
      device_.forget(this);
      fixed_.reset(fixed().size());
    }
    fixed_.upload(fixed());
    control_.upload(std::vector<sph::RelaxControl>{control});
    // The flag that ends the relaxation is read once per batch; steps after the last one do nothing.
    const int batch = std::min(control.max_steps, steps_per_batch);
    while (!control.done) {
      device_.replay(this, batch, [&] {
        for (int s = 0; s < batch; ++s) enqueue_step();
      });
      control = control_.download(1)[0];
    }
  }

  void store(std::vector<double>& x, std::vector<double>& y) override {
    const std::vector<float> loose_x = loose_.x.download(n_);
    const std::vector<float> loose_y = loose_.y.download(n_);
    const std::vector<std::uint32_t> id = loose_.id.download(n_);
    for (std::uint32_t i = 0; i < n_; ++i) {
      x[id[i]] = double{loose_x[i]};
      y[id[i]] = double{loose_y[i]};
    }
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

  /// Totals of chunks, level by level, up to one.
  template <class Value>
  class Totals {
   public:
    void reset(std::uint32_t n) {
      levels_.clear();
      do {
        n = (n + sph::sum_chunk - 1) / sph::sum_chunk;
        levels_.emplace_back();
        levels_.back().reset(n);
      } while (n > 1);
    }
    std::vector<Buffer<Value>>& levels() { return levels_; }
    const Value* total() const { return levels_.back().data(); }

   private:
    std::vector<Buffer<Value>> levels_;
  };

  static std::vector<double> as_doubles(const Buffer<float>& buffer) {
    const std::vector<float> values = buffer.download(buffer.size());
    return {values.begin(), values.end()};
  }

  void enqueue_step() {
    enqueue_sort();
    const bool densities = !std::isinf(setup().stiffness_ratio);
    if (densities) {
      enqueue_pressures();
    } else {
      set_pressures_to_one();
    }
    sph::Motion<float> motion;
    motion.damping = setup().damping;
    motion.cap = setup().velocity_cap;
    motion.walls = problem().walls;
    motion.length_x = static_cast<float>(motion.walls ? problem().plane_x : problem().field.length_x);
    motion.length_y = static_cast<float>(motion.walls ? problem().plane_y : problem().field.length_y);
    sph::with_terms(problem().terms, [&]<sph::Terms terms>() {
      device_.launch(
          n_, MoveParticles<terms>{control_.data(), sorted_view(), sorted_.arrays(), loose_.arrays(), pull_x_.data(),
                                   pull_y_.data(), fixed_.size() > 0 ? fixed_.data() : nullptr, motion, moved_.data()});
    });
    sum<MotionOfChunk>(motion_sums_, MotionOfParticle{moved_.data(), setup().tolerance});
    device_.launch(1, FinishStep{control_.data(), motion_sums_.total(), densities ? density_sums_.total() : nullptr,
                                 static_cast<double>(problem().particles)});
  }

  /// From loose_ to sorted_.
  void enqueue_sort() {
    const auto cells = static_cast<std::uint32_t>(cells_.size());
    device_.launch(cells + 1, SetZero{cell_count_.data()});
    device_.launch(
        n_, CountCells{control_.data(), cell_view(), loose_.arrays(), cell_.data(), place_.data(), cell_count_.data()});
    device_.exclusive_sum(cell_count_.data(), cell_start_.data(), cells + 1);
    device_.launch(n_,
                   ScatterIntoCells{control_.data(), cell_.data(), place_.data(), cell_start_.data(), order_.data()});
    device_.launch(cells, SortCells{control_.data(), loose_.id.data(), cell_start_.data(), order_.data()});
    sph::FieldView<float> field = problem().field.template view<float>();
    field.cells = field_.size() > 0 ? field_.data() : nullptr;
    device_.launch(n_, GatherSorted{control_.data(), order_.data(), loose_.arrays(), sorted_.arrays(), field,
                                    label_of_.size() > 0 ? label_of_.data() : nullptr, size_.data(), reach_.data(),
                                    pull_x_.data(), pull_y_.data(), label_.data()});
  }

  void enqueue_pressures() {
    const auto particles = static_cast<std::uint32_t>(problem().particles);
    const float inverse_delta = 1 / setup().stiffness_ratio;
    const auto mean_over = static_cast<double>(problem().particles);
    const auto constant = sph::density_constants<float>(problem().terms, problem().support, problem().class_support);
    sph::with_terms(problem().terms, [&]<sph::Terms terms>() {
      device_.launch(
          n_, FindDensity<terms>{control_.data(), sorted_view(), constant, density_.data(), class_density_.data()});
    });
    sum<SumOfChunk>(density_sums_, DensityOfParticle{density_.data(), sorted_.id.data(), particles});
    device_.launch(n_, FindPressure{control_.data(), density_.data(), density_sums_.total(), mean_over, inverse_delta,
                                    pressure_.data()});
    if (!problem().terms.classed) return;
    sum<SumOfChunk>(class_density_sums_, DensityOfParticle{class_density_.data(), sorted_.id.data(), particles});
    device_.launch(n_, FindPressure{control_.data(), class_density_.data(), class_density_sums_.total(), mean_over,
                                    inverse_delta, class_pressure_.data()});
  }

  /// What FindPressure gives for an infinite Delta whatever the densities are.
  void set_pressures_to_one() {
    device_.launch(n_, SetOne{pressure_.data()});
    if (problem().terms.classed) device_.launch(n_, SetOne{class_pressure_.data()});
  }

  /// Sums what `load` gives for all particles into totals.total(); LoadTotals reads the totals of a level.
  template <class LoadTotals, class Value, class Load>
  void sum(Totals<Value>& totals, const Load& load) {
    std::uint32_t n = n_;
    const Value* below = nullptr;
    for (Buffer<Value>& level : totals.levels()) {
      const auto blocks = static_cast<std::uint32_t>(level.size());
      if (below == nullptr) {
        device_.launch_blocks(blocks, SumChunks<Load>{control_.data(), load, n, level.data()});
      } else {
        device_.launch_blocks(blocks, SumChunks<LoadTotals>{control_.data(), {below}, n, level.data()});
      }
      n = blocks;
      below = level.data();
    }
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
    view.support = static_cast<float>(problem().support);
    view.class_support = static_cast<float>(problem().class_support);
    return view;
  }

  Device device_;
  std::uint32_t n_ = 0;
  sph::Cells<float> cells_{1, 1, 1};
  Buffer<sph::Tile<float>> tiles_;
  Buffer<std::uint32_t> cell_count_, cell_start_;  // [cells + 1]
  Buffer<sph::RelaxControl> control_;
  ParticleBuffers loose_;   // as the last step left them
  ParticleBuffers sorted_;  // as this step found them, by cell and id
  Buffer<std::uint32_t> cell_, place_, order_;
  Buffer<float> density_, pressure_, moved_, size_, reach_, pull_x_, pull_y_, class_density_, class_pressure_, label_;
  Buffer<std::uint8_t> label_of_, fixed_;  // by id; empty = one class, all free
  Buffer<sph::FieldCell> field_;
  Totals<double> density_sums_, class_density_sums_;
  Totals<sph::StepSums> motion_sums_;
};

}  // namespace abn::sph_cuda
