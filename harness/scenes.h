// The table of scenes: the pictures that come with the program, one row each. Program, tests and `abn list` read it.
// Any image file may be sampled besides them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/image.h"

namespace abn::harness {

/// The size at which every scene is meant to be seen; image scenes exist at this size only.
constexpr Extent native_scene_size{3000, 3000};

/// A row of the table. A scene is either an image file or a formula.
struct Scene {
  std::string name;                 // as typed: letters, digits, underscores
  std::string kind;                 // image | procedural | hard case
  std::string summary;              // what it shows and what it is hard for
  std::string cite;                 // where it comes from
  bool high_dynamic_range = false;  // has values above 1
  std::uint32_t channels = 1;
  std::string file = {};                                   // image scenes: the file, below a data folder
  Image (*render)(Extent size) = nullptr;                  // the others; a pure function of the size, texel for texel
  Image (*texel_truth)(Extent size, Extent to) = nullptr;  // means of the texels, where a closed form exists
  Image (*continuous_truth)(Extent size, Extent to) = nullptr;  // means of the picture before it became texels
};

/// The table, in the order of `abn list scenes`.
const std::vector<Scene>& scenes();

/// The scene of that name. Throws ConfigError that lists what is known.
const Scene& find_scene(std::string_view name);

/// The scene in linear light. Throws ConfigError for a size that is empty or has more than 2^24 texels on a side, and
/// for an image scene at another size than native_scene_size (a picture cannot be rendered anew, and resampling it
/// would put a filter into the reference); IoError if the file of an image scene is missing or damaged.
Image render_scene(const Scene& scene, Extent size = native_scene_size);

/// The exact mean of the scene's texels over every pixel, for `size` texels reduced to `to` pixels, computed in double
/// without rendering; nothing where no closed form exists. Throws ConfigError for empty sizes.
std::optional<Image> closed_form_truth(const Scene& scene, Extent size, Extent to);

/// The exact mean over every pixel of the continuous picture that the texels sample. It differs from closed_form_truth
/// where the texels alias (zone plate at 3000 -> 200: by up to 0.011), so never judge an estimate of the texels by it.
std::optional<Image> continuous_truth(const Scene& scene, Extent size, Extent to);

/// A part of the picture worth a close look; corners in fractions of the picture's width and height, y down.
struct Region {
  std::string name;
  double left = 0, top = 0, right = 1, bottom = 1;
};

/// The named regions of a scene, from reference_images/regions.toml, in the file's order; empty if it has none.
/// Throws IoError if the file is missing or damaged.
std::vector<Region> regions(const Scene& scene);

}  // namespace abn::harness
