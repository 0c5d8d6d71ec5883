#include "harness/backend.h"

#include <fmt/format.h>

#include "sampling/error.h"

#ifdef ABN_HAVE_CUDA
#include "sph_cuda/device.h"
#endif

namespace abn::harness {

std::string describe_gpu() {
#ifdef ABN_HAVE_CUDA
  return sph_cuda::describe_devices();
#else
  return "none (built without CUDA)";
#endif
}

Backend resolve_backend(const std::string& word) {
  if (word == "auto" || word == "cpu") return {"cpu", nullptr};
  if (word == "cuda") {
    throw DeviceError(fmt::format(
        "--backend cuda: this version has no CUDA engine for sampling (GPU: {}); use --backend cpu", describe_gpu()));
  }
  throw ConfigError(fmt::format("--backend is '{}'; known: auto cpu cuda", word));
}

}  // namespace abn::harness
