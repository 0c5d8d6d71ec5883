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
#include "sph_cuda/kriging.h"
#include "sph_cuda/solver.h"
#endif

namespace abn::harness {
namespace {

void say_once(const std::string& line) {
  static std::atomic_flag said;
  if (!said.test_and_set()) fmt::print(stderr, "abn: --backend auto: {}\n", line);
}

void tell_error(const std::string& error) { say_once(error + "; the CPU takes over"); }

#ifdef ABN_HAVE_CUDA
std::unique_ptr<sph::Solver> cuda_if_possible(const sph::Setup& setup) {
  try {
    return sph_cuda::make_cuda_solver(setup);
  } catch (const DeviceError& error) {
    tell_error(error.what());
    return sph::make_cpu_solver(setup);
  }
}

Backend with_cuda(bool must) {
  if (!sph_cuda::list_devices().empty()) {
    // The same for all runs: they keep the device's memory.
    static const AdaptivePlaneFactory planes = sph_cuda::make_cuda_adaptive_plane_factory();
    static const EstimatePixels estimate = estimate_kept(sph_cuda::make_cuda_estimator());
    Backend backend{"cuda", {}, sph_cuda::make_cuda_solver, planes, estimate};
    if (must) return backend;
    backend.factory = cuda_if_possible;
    backend.adaptive_plane = with_fallback(planes, tell_error);
    backend.falls_back = true;
    return backend;
  }
  if (!must) return {"cpu", "no CUDA device; the CPU does it all"};
  throw DeviceError("--backend cuda: there is no CUDA device here, or no driver for it; use --backend cpu");
}
#else
Backend with_cuda(bool must) {
  if (!must) return {};
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
  if (word == "cpu") return {};
  if (word == "auto" || word == "cuda") return with_cuda(word == "cuda");
  throw ConfigError(fmt::format("--backend is '{}'; known: auto cpu cuda", word));
}

Developed develop(const Film& film, const Reconstruction& row, const Backend& backend) {
  if (!backend.falls_back) return row.develop(film, backend.estimate);
  try {
    return row.develop(film, backend.estimate);
  } catch (const DeviceError& error) {
    tell_error(error.what());
    return row.develop(film);
  }
}

void tell_fallback(const std::string& word, const StrategyInfo& info, const std::string& reconstruction) {
  const std::string name = reconstruction == "auto" ? info.reconstruction : reconstruction;
  if (!info.solver && (name.empty() || !find_reconstruction(name).develop.runs_on_device())) return;
  if (const std::string note = resolve_backend(word).note; !note.empty()) say_once(note);
}

}  // namespace abn::harness
