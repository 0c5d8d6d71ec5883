// The variance map of sph_adaptive on the GPU. Free of CUDA headers.
#pragma once

#include "sampling/adaptive/local_variance.h"

namespace abn::sph_cuda {

/// local_variance() on the current CUDA device: the same nearest samples and, where the device divides as IEEE 754
/// says, the same bits. Memory is kept from one call to the next; the result must not be called by two threads at once.
/// A call throws DeviceError without a device or memory on it.
VarianceMap make_cuda_variance_map();

}  // namespace abn::sph_cuda
