#include "harness/backend.h"

#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <memory>

#include "sampling/error.h"

#ifdef ABN_HAVE_CUDA
#include "harness/fallback_plane.h"
#include "sph_cuda/adaptive_plane.h"
#include "sph_cuda/device.h"
#include "sph_cuda/solver.h"
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

/// One for all runs: it keeps the device's memory.
const AdaptivePlaneFactory& adaptive_planes() {
  static const AdaptivePlaneFactory factory = sph_cuda::make_cuda_adaptive_plane_factory();
  return factory;
}

Backend with_cuda(bool must) {
  if (!sph_cuda::list_devices().empty()) {
    const AdaptivePlaneFactory planes = adaptive_planes();
    if (must) return {"cuda", sph_cuda::make_cuda_solver, planes};
    const auto tell = [](const std::string& error) { say_once(error + "; the CPU takes over"); };
    return {"cuda", cuda_if_possible, with_fallback(planes, tell)};
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
