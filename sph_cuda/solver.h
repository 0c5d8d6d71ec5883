// The SPH engine on the GPU. Free of CUDA headers.
#pragma once

#include <memory>

#include "sampling/sph/solver.h"

namespace abn::sph_cuda {

/// The engine of sph::make_cpu_solver() on the current CUDA device, from the same functions. Particles stay on the
/// device from one call to the next; about 90 B each. Two runs give the same bits; so does the CPU where the device
/// rounds square roots and divisions as IEEE 754 says (the library is compiled so).
///
/// Throws ConfigError as make_cpu_solver() does, and DeviceError without a device, without memory on it, or where a
/// CUDA call fails.
std::unique_ptr<sph::Solver> make_cuda_solver(const sph::Setup& setup);

}  // namespace abn::sph_cuda
