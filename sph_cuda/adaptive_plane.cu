#include "sph_cuda/adaptive_plane.h"

#include <memory>

#include "sampling/error.h"
#include "sph_cuda/adaptive_engine.h"
#include "sph_cuda/cuda_relaxation.h"
#include "sph_cuda/device.h"

namespace abn::sph_cuda {

AdaptivePlaneFactory make_cuda_adaptive_plane_factory() {
  using Workspace = AdaptiveWorkspace<CudaDevice>;
  // Made when first called: until then no device is touched.
  const auto kept = std::make_shared<std::shared_ptr<Workspace>>();
  return [kept](const AdaptivePlaneOptions& options) -> std::unique_ptr<AdaptivePlane> {
    if (!*kept || kept->use_count() > 1) {
      if (list_devices().empty()) throw DeviceError("there is no CUDA device (or no driver for it); use --backend cpu");
      *kept = std::make_shared<Workspace>();
    }
    return std::make_unique<DeviceAdaptivePlane<CudaDevice>>(options, *kept);
  };
}

}  // namespace abn::sph_cuda
