#include "sph_cuda/solver.h"

#include "sampling/error.h"
#include "sph_cuda/cuda_relaxation.h"
#include "sph_cuda/device.h"
#include "sph_cuda/engine.h"

namespace abn::sph_cuda {

template class Relaxation<CudaDevice>;

std::unique_ptr<sph::Solver> make_cuda_solver(const sph::Setup& setup) {
  if (list_devices().empty()) throw DeviceError("there is no CUDA device (or no driver for it); use --backend cpu");
  return std::make_unique<DeviceSolver<CudaDevice>>(setup);
}

}  // namespace abn::sph_cuda
