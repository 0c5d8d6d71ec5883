// Kriging and edge reconstruction on the GPU. Free of CUDA headers.
#pragma once

#include "sampling/kriging/pixel_estimates.h"

namespace abn::sph_cuda {

/// Estimates of all pixels on the current CUDA device, by the default options of kriging and edge reconstruction: what
/// the CPU computes, and bit for bit so where the device's cosine rounds as the CPU's does (it is asked for only where
/// few coarse angles separate a step). Memory is kept from one call to the next; the result must not be called by two
/// threads at once. A call throws DeviceError without a device or memory on it.
SampleEstimator make_cuda_estimator();

}  // namespace abn::sph_cuda
