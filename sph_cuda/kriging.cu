#include "sph_cuda/kriging.h"

#include <memory>

#include "sampling/error.h"
#include "sph_cuda/cuda_device.h"
#include "sph_cuda/device.h"
#include "sph_cuda/kriging_engine.h"

namespace abn::sph_cuda {

SampleEstimator make_cuda_estimator() {
  // Made when first called: until then no device is touched.
  const auto engine = std::make_shared<std::unique_ptr<KrigingEngine<CudaDevice>>>();
  return [engine](std::span<const Vec2f> position, std::span<const float> value, std::span<const float> weight,
                  std::uint32_t channels, Extent plane, bool steps) {
    if (!*engine) {
      if (list_devices().empty()) throw DeviceError("there is no CUDA device (or no driver for it); use --backend cpu");
      *engine = std::make_unique<KrigingEngine<CudaDevice>>();
    }
    return (**engine)(position, value, weight, channels, plane, steps);
  };
}

}  // namespace abn::sph_cuda
