// Every CUDA call goes through check().
#pragma once

#include <cuda_runtime.h>

#include <string>

#include "sampling/error.h"

namespace abn::sph_cuda {

/// Throws DeviceError "what: reason" unless `status` is cudaSuccess. After a launch: check(cudaGetLastError(), "...").
inline void check(cudaError_t status, const char* what) {
  if (status != cudaSuccess) {
    throw DeviceError(std::string(what) + ": " + cudaGetErrorName(status) + ", " + cudaGetErrorString(status));
  }
}

}  // namespace abn::sph_cuda
