#include "harness/density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/run.h"
#include "sampling/error.h"
#include "sampling/sph/size_field_cases.h"

namespace abn::harness {

LoadedDensity load_density(const std::string& word, const DensityOptions& options) {
  if (!(options.floor >= 0 && options.floor <= 1))
    throw ConfigError(fmt::format("the floor of the density is {}; give a number from 0 to 1", options.floor));
  LoadedDensity loaded;
  Grid<float> density;
  if (word.starts_with("size:")) {
    density = sph::make_size_field(word.substr(5), {512, 512});
    for (float& value : density.cells()) value = 1 / (value * value);
  } else {
    SubjectSpec spec;
    spec.scene = word;
    spec.channels = options.channels;
    spec.on_nonfinite = options.on_nonfinite;
    const auto subject = load_subject(spec, false);
    loaded.notices = subject->notices;
    const Image& source = subject->source;
    density = Grid<float>(source.size);
    for (std::size_t i = 0; i < density.cells().size(); ++i)
      density[i] = luminance(&source.texels[i * source.channels], source.channels);
  }
  const float largest = *std::max_element(density.cells().begin(), density.cells().end());
  const float least = *std::min_element(density.cells().begin(), density.cells().end());
  if (!(largest > 0 && std::isfinite(largest)))
    throw ConfigError(
        fmt::format("density '{}': the luminance is 0 everywhere; give an image that is not black", word));
  if (!(least >= 0))
    throw ConfigError(fmt::format("density '{}': its luminance falls to {}; no density can be negative", word, least));
  const float floor = static_cast<float>(options.floor) * largest;
  for (float& value : density.cells()) value = std::max(value, floor);
  loaded.density = std::make_shared<const Grid<float>>(std::move(density));
  return loaded;
}

}  // namespace abn::harness
