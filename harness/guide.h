// Guide images: where the user says that samples matter.
#pragma once

#include <memory>
#include <string>

#include "harness/image.h"
#include "sampling/grid.h"

namespace abn::harness {

/// The guide of `word`: the luminance of an image file stretched over the plane, negative values as 0; or, for
/// "true_variance", the variance of luminance inside every pixel of `to`, from `source` itself: no fair driver, but
/// what an ablation needs. Throws IoError for a file that cannot be read, ConfigError for one with values that are not
/// finite.
std::shared_ptr<const Grid<float>> load_guide(const std::string& word, const Image& source, Extent to);

}  // namespace abn::harness
