// Densities by word: an image, a scene, or a size field.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sampling/grid.h"

namespace abn::harness {

/// How a density is read; see load_density.
struct DensityOptions {
  std::string channels = {};            // of an image file, as in LoadOptions
  std::string on_nonfinite = "refuse";  // refuse | zero | clamp
  double floor = 0;                     // in [0,1]: smaller values are raised to this times the largest one
};

struct LoadedDensity {
  std::shared_ptr<const Grid<float>> density;  // relative, >= 0, not all 0
  std::vector<std::string> notices;
};

/// The density that `word` names: an image file or scene:NAME (linear luminance: bright = many points), or
/// size:NAME[:RATIO], the density s^-2 of a spacing s(x) among sph::size_field_cases(), on 512x512 cells. Throws
/// ConfigError (unknown name, bad floor, a negative luminance, all 0), IoError.
LoadedDensity load_density(const std::string& word, const DensityOptions& options = {});

}  // namespace abn::harness
