// Which engine relaxes the SPH particles.
#pragma once

#include <string>

#include "sampling/sph/solver.h"

namespace abn::harness {

struct Backend {
  std::string name;            // cpu | cuda
  sph::SolverFactory factory;  // null = the CPU engine
};

/// auto | cpu | cuda. Throws ConfigError for another word, DeviceError if cuda is asked for and cannot be had.
Backend resolve_backend(const std::string& word);

/// One line about the GPU for records and `abn info`: its name, or why there is none.
std::string describe_gpu();

}  // namespace abn::harness
