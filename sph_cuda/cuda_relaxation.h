// The relaxation on CUDA is compiled once, in solver.cu.
#pragma once

#include "sph_cuda/cuda_device.h"
#include "sph_cuda/relaxation.h"

namespace abn::sph_cuda {

extern template class Relaxation<CudaDevice>;

}  // namespace abn::sph_cuda
