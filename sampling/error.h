// The three kinds of error a user can cause; each maps to one exit code of the program.
// Numerical trouble (not converged, empty pixels, ...) is never an exception: it is a Diagnostic in the result.
#pragma once

#include <stdexcept>

namespace abn {

/// A wrong word: flag, key, value, budget. The message names key, value and remedy. Exit code 2.
class ConfigError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A named file (image, spec, point set, output) that cannot be read or written. The message names file and reason.
/// Exit code 3.
class IoError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A device that is missing, too small, or not built in. Exit code 4.
class DeviceError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace abn
