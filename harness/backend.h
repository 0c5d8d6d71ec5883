// What runs on a GPU: the relaxation of SPH particles, the passes of sph_adaptive, kriging and edge reconstruction.
#pragma once

#include <string>

#include "harness/reconstruction.h"
#include "sampling/adaptive/adaptive_plane.h"
#include "sampling/sph/solver.h"
#include "sampling/strategy.h"

namespace abn::harness {

struct Backend {
  std::string name = "cpu";                       // cpu | cuda
  std::string note = {};                          // why `auto` is not the GPU that this program was built for; or empty
  sph::SolverFactory factory = nullptr;           // null = the CPU engine
  AdaptivePlaneFactory adaptive_plane = nullptr;  // null = the CPU's, but for the relaxation, which is the factory's
  EstimatePixels estimate = nullptr;              // null = the CPU's
  bool falls_back = false;                        // where estimate fails, the CPU takes over
};

/// auto | cpu | cuda. `cuda` never falls back: throws DeviceError if it cannot be had, now or when an engine is made.
/// `auto` is the GPU if there is one; where that fails for a task (no memory left, say), the CPU engine takes over and
/// a line on stderr says so. Throws ConfigError for another word.
Backend resolve_backend(const std::string& word);

/// The picture of a film by a row of the table, as the backend makes it. Throws as the device does, unless the backend
/// falls back.
Developed develop(const Film& film, const Reconstruction& row, const Backend& backend);

/// Says on stderr, once per process, that `auto` fell back to the CPU, if it did and the strategy or the reconstruction
/// would have used the GPU. The reconstruction may be "auto", or "" where no picture is made.
void tell_fallback(const std::string& word, const StrategyInfo& info, const std::string& reconstruction = "");

/// One line about the GPU for records and `abn info`: its name, or why there is none.
std::string describe_gpu();

}  // namespace abn::harness
