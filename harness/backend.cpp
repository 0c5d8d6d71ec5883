#include "harness/backend.h"

#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <memory>
#include <span>

#include "sampling/error.h"

#ifdef ABN_HAVE_CUDA
#include "sph_cuda/device.h"
#include "sph_cuda/solver.h"
#include "sph_cuda/variance_map.h"
#endif

namespace abn::harness {
namespace {

void say_once(const std::string& line) {
  static std::atomic_flag said;
  if (!said.test_and_set()) fmt::print(stderr, "abn: --backend auto: {}\n", line);
}

#ifdef ABN_HAVE_CUDA
std::unique_ptr<sph::Solver> cuda_if_possible(const sph::Setup& setup) {
  try {
    return sph_cuda::make_cuda_solver(setup);
  } catch (const DeviceError& error) {
    say_once(fmt::format("{}; the CPU engine takes over", error.what()));
    return sph::make_cpu_solver(setup);
  }
}

/// The device's variance map, or where that fails the CPU's.
class VarianceMapIfPossible {
 public:
  Grid<float> operator()(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                         Extent plane, Extent map, int neighbours) const {
    try {
      return on_device_(position, value, channels, plane, map, neighbours);
    } catch (const DeviceError& error) {
      say_once(fmt::format("{}; the CPU takes over", error.what()));
      return local_variance(position, value, channels, plane, map, neighbours);
    }
  }

 private:
  VarianceMap on_device_ = sph_cuda::make_cuda_variance_map();
};

Backend with_cuda(bool must) {
  if (!sph_cuda::list_devices().empty()) {
    if (must) return {"cuda", sph_cuda::make_cuda_solver, sph_cuda::make_cuda_variance_map()};
    return {"cuda", cuda_if_possible, VarianceMapIfPossible()};
  }
  if (!must) return {"cpu", nullptr, nullptr, "no CUDA device; SPH relaxes on the CPU"};
  throw DeviceError("--backend cuda: there is no CUDA device here, or no driver for it; use --backend cpu");
}
#else
Backend with_cuda(bool must) {
  if (!must) return {"cpu", nullptr, nullptr};
  throw DeviceError(
      "--backend cuda: this program was built without CUDA; use --backend cpu, or build it where nvcc is on the PATH");
}
#endif

}  // namespace

std::string describe_gpu() {
#ifdef ABN_HAVE_CUDA
  return sph_cuda::describe_devices();
#else
  return "none (built without CUDA)";
#endif
}

Backend resolve_backend(const std::string& word) {
  if (word == "cpu") return {"cpu", nullptr, nullptr};
  if (word == "auto" || word == "cuda") return with_cuda(word == "cuda");
  throw ConfigError(fmt::format("--backend is '{}'; known: auto cpu cuda", word));
}

void tell_fallback(const std::string& word, const StrategyInfo& info) {
  if (!info.solver) return;
  if (const std::string note = resolve_backend(word).note; !note.empty()) say_once(note);
}

}  // namespace abn::harness
