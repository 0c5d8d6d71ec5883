#include "sph_cuda/variance_map.h"

#include <memory>

#include "sampling/error.h"
#include "sph_cuda/cuda_device.h"
#include "sph_cuda/device.h"
#include "sph_cuda/variance_engine.h"

namespace abn::sph_cuda {

VarianceMap make_cuda_variance_map() {
  struct OnDevice {
    CudaDevice device;
    VarianceEngine<CudaDevice> engine;
  };
  // Made when first called: until then no device is touched.
  const auto made = std::make_shared<std::unique_ptr<OnDevice>>();
  return [made](std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels, Extent plane,
                Extent map, int neighbours) {
    if (!*made) {
      if (list_devices().empty()) throw DeviceError("there is no CUDA device (or no driver for it); use --backend cpu");
      *made = std::make_unique<OnDevice>();
    }
    return (*made)->engine((*made)->device, position, value, channels, plane, map, neighbours);
  };
}

}  // namespace abn::sph_cuda
