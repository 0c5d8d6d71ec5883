// The passes of an adaptive plane on the GPU. Free of CUDA headers.
#pragma once

#include "sampling/adaptive/adaptive_plane.h"

namespace abn::sph_cuda {

/// Makes what make_adaptive_plane() makes, on the current CUDA device: samples, maps and particles stay there from pass
/// to pass, and the device's memory is kept for the next plane. One plane at a time, or each has memory of its own.
/// Drivers other than the variance are found on the host. Throws DeviceError without a
/// device, without memory on it, or where a CUDA call fails.
AdaptivePlaneFactory make_cuda_adaptive_plane_factory();

}  // namespace abn::sph_cuda
