// Kernels that sum over all particles, in the order of sampling/sph/fixed_sum.h, so that a sum is the same on every
// device and on the host.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/fixed_sum.h"
#include "sampling/sph/relax_control.h"
#include "sph_cuda/kernels.h"

namespace abn::sph_cuda {

/// A density where it counts for the mean.
struct DensityOfParticle {
  const float* density;
  const std::uint32_t* id;
  std::uint32_t particles;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const { return id[i] < particles ? static_cast<double>(density[i]) : 0.0; }
};

/// The sums of a sum.
struct SumOfChunk {
  const double* total;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const { return total[i]; }
};

/// What a step did to one particle.
struct MotionOfParticle {
  const float* moved;
  float tolerance;
  using Value = sph::StepSums;
  ABN_HD Value operator()(std::uint32_t i) const {
    sph::StepSums sums;
    const float distance = moved[i];
    if (distance == not_moved) return sums;
    if (distance < 0) {
      sums.non_finite = 1;
      return sums;
    }
    sums.displacement = sums.max_displacement = static_cast<double>(distance);
    sums.moving = distance >= tolerance ? 1 : 0;
    return sums;
  }
};
struct MotionOfChunk {
  const sph::StepSums* total;
  using Value = sph::StepSums;
  ABN_HD Value operator()(std::uint32_t i) const { return total[i]; }
};

ABN_HD inline void accumulate(double& sum, double value) { sum += value; }
ABN_HD inline void accumulate(sph::StepSums& sum, const sph::StepSums& value) {
  sum.displacement += value.displacement;
  sum.max_displacement = value.max_displacement > sum.max_displacement ? value.max_displacement : sum.max_displacement;
  sum.moving += value.moving;
  sum.non_finite += value.non_finite;
}

/// The total of every chunk of values, in the order of fixed_sum.h: a block per chunk, a lane per thread.
template <class Load>
struct SumChunks {
  using Value = typename Load::Value;
  static constexpr std::uint32_t threads = sph::sum_lanes;
  static constexpr int last_phase = 9;  // the lanes, then half of 256, 128, …, 2, then the answer

  const sph::RelaxControl* control;  // null = always
  Load load;
  std::uint32_t n;
  Value* total;  // [blocks]

  ABN_HD int phases(std::uint32_t) const { return last_phase + 1; }
  std::size_t shared_bytes() const { return threads * sizeof(Value); }
  ABN_HD void operator()(int phase, std::uint32_t block, std::uint32_t thread, void* memory) const {
    if (control != nullptr && control->done) return;
    Value* shared = static_cast<Value*>(memory);
    if (phase == 0) {
      Value sum{};
      for (std::uint32_t k = thread; k < sph::sum_chunk; k += sph::sum_lanes) {
        const std::uint64_t i = std::uint64_t{block} * sph::sum_chunk + k;
        if (i < n) accumulate(sum, load(static_cast<std::uint32_t>(i)));
      }
      shared[thread] = sum;
    } else if (phase < last_phase) {
      const std::uint32_t half = sph::sum_lanes >> static_cast<unsigned>(phase);
      if (thread < half) accumulate(shared[thread], shared[thread + half]);
    } else if (thread == 0) {
      total[block] = shared[0];
    }
  }
};

/// Ends a step: one thread.
struct FinishStep {
  sph::RelaxControl* control;
  const sph::StepSums* sums;
  const double* density_sum;  // null = densities were not summed
  double particles;
  ABN_HD void operator()(std::uint32_t) const {
    if (control->done) return;
    sph::StepSums all = *sums;
    all.mean_density = density_sum != nullptr ? *density_sum / particles : 1.0;
    control->finish_step(all);
  }
};

}  // namespace abn::sph_cuda
