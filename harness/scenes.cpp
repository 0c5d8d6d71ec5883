#include "harness/scenes.h"

#include <toml++/toml.h>
#include <cmath>

#include "harness/apple_analytic.h"
#include "harness/data_path.h"
#include "harness/hard_cases.h"
#include "harness/image_io.h"
#include "harness/test_pictures.h"
#include "sampling/error.h"

namespace abn::harness {

namespace {

constexpr std::uint32_t largest_side = 1U << 24;  // floats hold every texel position up to here

std::vector<Scene> make_table() {
  const std::string image = "image", procedural = "procedural", hard_case = "hard case";
  const std::string own = "own work, CC0", rendered = "rendered with POV-Ray 3.7 for this project, CC0";
  return {
      {.name = "apple",
       .kind = image,
       .summary = "apple with stalk and speckles on a far-running checkerboard: edges, fine texture, soft shading",
       .cite = rendered,
       .channels = 3,
       .file = "reference_images/apple.png"},
      {.name = "cornell",
       .kind = image,
       .summary = "Cornell box with measured dimensions, interreflection and a visible lamp: soft shading, high range",
       .cite = rendered + "; box after Goral et al. 1984, dimensions as measured at Cornell University",
       .high_dynamic_range = true,
       .channels = 3,
       .file = "reference_images/cornell.exr"},
      {.name = "bathroom",
       .kind = image,
       .summary = "tiled bathroom with mirror, chrome and a wire basket: regular fine detail and reflections",
       .cite = rendered,
       .channels = 3,
       .file = "reference_images/bathroom.png"},
      {.name = "bedroom",
       .kind = image,
       .summary = "bedroom with blinds, plaid, wallpaper and planks: many kinds of stripes",
       .cite = rendered,
       .channels = 3,
       .file = "reference_images/bedroom.png"},
      {.name = "apple_analytic",
       .kind = procedural,
       .summary = "an apple ray traced at any position, checkerboard to the horizon: no texel lattice",
       .cite = own,
       .channels = 3,
       .render = render_apple_analytic},
      {.name = "zone",
       .kind = procedural,
       .summary = "rings round a corner, up to 1.5 cycles per pixel at 200 pixels",
       .cite = own,
       .render = render_zone},
      {.name = "lines",
       .kind = procedural,
       .summary = "260 straight lines thinner than a pixel, in any direction",
       .cite = own,
       .render = render_lines},
      {.name = "smooth",
       .kind = procedural,
       .summary = "a room of gradients, a soft shadow and few edges",
       .cite = own,
       .render = render_smooth},
      {.name = "text",
       .kind = procedural,
       .summary = "black letters of many sizes on white, off the pixel grid",
       .cite = own,
       .render = render_text},
      {.name = "disks",
       .kind = procedural,
       .summary = "1400 overlapping disks: edges of every direction and contrast",
       .cite = own,
       .render = render_disks},
      {.name = "fbm",
       .kind = procedural,
       .summary = "nine octaves of value noise: energy at every frequency, no edge",
       .cite = own,
       .render = render_fbm},
      {.name = "stipple",
       .kind = procedural,
       .summary = "a linear gradient with a bright and a dark disc, .01 to 1: a density for stippling",
       .cite = own + "; after the test of thesis fig. 2.2",
       .render = render_stipple},
      {.name = "constant",
       .kind = hard_case,
       .summary = "1/2 everywhere: any error is the estimator's own",
       .cite = own,
       .render = render_constant,
       .texel_truth = constant_truth,
       .continuous_truth = constant_truth},
      {.name = "black",
       .kind = hard_case,
       .summary = "0 everywhere: relative errors divide by it",
       .cite = own,
       .render = render_black,
       .texel_truth = black_truth,
       .continuous_truth = black_truth},
      {.name = "zone_plate",
       .kind = hard_case,
       .summary = "1/2 + 1/2 cos(pi r^2 / N) round the centre: moire wherever samples are regular",
       .cite = own,
       .render = render_zone_plate,
       .texel_truth = zone_plate_texel_truth,
       .continuous_truth = zone_plate_continuous_truth},
      {.name = "siemens_star",
       .kind = hard_case,
       .summary = "36 bright sectors: every edge direction, all meet in one point",
       .cite = own,
       .render = render_siemens_star,
       .continuous_truth = siemens_star_continuous_truth},
      {.name = "slanted_edge",
       .kind = hard_case,
       .summary = "one edge 5 degrees from the vertical: all variance on a line",
       .cite = own,
       .render = render_slanted_edge,
       .continuous_truth = slanted_edge_continuous_truth},
      {.name = "step_1500",
       .kind = hard_case,
       .summary = "0 | 1 at the middle column: an edge on a pixel border",
       .cite = own,
       .render = render_step_1500,
       .texel_truth = step_1500_truth,
       .continuous_truth = step_1500_truth},
      {.name = "step_1507",
       .kind = hard_case,
       .summary = "0 | 1 seven texels behind the middle: one column of 8/15",
       .cite = own,
       .render = render_step_1507,
       .texel_truth = step_1507_truth,
       .continuous_truth = step_1507_truth},
      {.name = "checkerboard_1texel",
       .kind = hard_case,
       .summary = "black and white texels in turn: means are 113/225 and 112/225, a stride of 15 aliases fully",
       .cite = own,
       .render = render_checkerboard_1texel,
       .texel_truth = checkerboard_1texel_truth,
       .continuous_truth = checkerboard_1texel_truth},
      {.name = "lines_47",
       .kind = hard_case,
       .summary = "one bright column every 47: few samples see no variance",
       .cite = own,
       .render = render_lines_47,
       .texel_truth = lines_47_truth,
       .continuous_truth = lines_47_truth},
      {.name = "firefly",
       .kind = hard_case,
       .summary = "one texel of 10^4 in a field of 1/2: most sample sets miss it",
       .cite = own,
       .high_dynamic_range = true,
       .render = render_firefly,
       .texel_truth = firefly_truth,
       .continuous_truth = firefly_truth},
      {.name = "dynamic_range",
       .kind = hard_case,
       .summary = "10^(12 x / N - 6): twelve decades from left to right",
       .cite = own,
       .high_dynamic_range = true,
       .render = render_dynamic_range,
       .texel_truth = dynamic_range_truth},
      {.name = "ramp",
       .kind = hard_case,
       .summary = "x / N: stratified strategies must win clearly",
       .cite = own,
       .render = render_ramp,
       .texel_truth = ramp_truth},
  };
}

std::string to_text(Extent size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

void check_size(const Scene& scene, const char* what, Extent size) {
  if (size.width >= 1 && size.height >= 1 && size.width <= largest_side && size.height <= largest_side) return;
  throw ConfigError("scene " + scene.name + ": " + what + " " + to_text(size) + " must be from 1 to " +
                    std::to_string(largest_side) + " on each side, such as " + to_text(native_scene_size));
}

std::optional<Image> truth_by(Image (*truth)(Extent, Extent), const Scene& scene, Extent size, Extent to) {
  check_size(scene, "size in texels", size);
  check_size(scene, "size in pixels", to);
  if (truth == nullptr) return std::nullopt;
  return truth(size, to);
}

}  // namespace

const std::vector<Scene>& scenes() {
  static const std::vector<Scene> table = make_table();
  return table;
}

const Scene& find_scene(std::string_view name) {
  std::string known;
  for (const Scene& scene : scenes()) {
    if (scene.name == name) return scene;
    known += (known.empty() ? "" : ", ") + scene.name;
  }
  throw ConfigError("scene '" + std::string(name) + "' is unknown; known scenes: " + known +
                    ". An image file is named by its path");
}

Image render_scene(const Scene& scene, Extent size) {
  check_size(scene, "size", size);
  if (scene.render != nullptr) return scene.render(size);
  if (size != native_scene_size) {
    throw ConfigError("scene " + scene.name + ": a picture of " + to_text(native_scene_size) +
                      " texels cannot be rendered at " + to_text(size) + "; leave the size out, or use " +
                      "apple_analytic, which can be rendered at any size");
  }
  const std::string path = find_data(scene.file).string();
  Image image = load_image(path).image;
  if (image.size != native_scene_size || image.channels != scene.channels) {
    throw IoError(path + ": is " + to_text(image.size) + " with " + std::to_string(image.channels) +
                  " channels, but scene " + scene.name + " is " + to_text(native_scene_size) + " with " +
                  std::to_string(scene.channels) + "; restore the file from the source tree");
  }
  return image;
}

std::optional<Image> closed_form_truth(const Scene& scene, Extent size, Extent to) {
  return truth_by(scene.texel_truth, scene, size, to);
}

std::optional<Image> continuous_truth(const Scene& scene, Extent size, Extent to) {
  return truth_by(scene.continuous_truth, scene, size, to);
}

std::vector<Region> regions(const Scene& scene) {
  const std::string path = find_data("reference_images/regions.toml").string();
  toml::table file;
  try {
    file = toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    throw IoError(path + ": line " + std::to_string(error.source().begin.line) + ": " +
                  std::string(error.description()) + "; restore the file from the source tree");
  }
  std::vector<Region> result;
  const toml::array* rows = file["region"].as_array();
  if (rows == nullptr) throw IoError(path + ": has no [[region]] tables; restore the file from the source tree");
  for (const toml::node& node : *rows) {
    const toml::table* row = node.as_table();
    const auto name = row ? (*row)["name"].value<std::string>() : std::nullopt;
    const auto of = row ? (*row)["scene"].value<std::string>() : std::nullopt;
    if (!name || !of) throw IoError(path + ": a region lacks `scene` or `name`; restore the file from the source tree");
    if (*of != scene.name) continue;
    const auto corner = [&](const char* key) { return (*row)[key].value<double>().value_or(std::nan("")); };
    const Region region{*name, corner("left"), corner("top"), corner("right"), corner("bottom")};
    // Written so that a missing corner, which is NaN, fails too.
    if (!(0 <= region.left && region.left < region.right && region.right <= 1 && 0 <= region.top &&
          region.top < region.bottom && region.bottom <= 1)) {
      throw IoError(path + ": region " + *of + "." + *name +
                    " needs 0 <= left < right <= 1 and 0 <= top < bottom <= 1 as fractions of the picture");
    }
    result.push_back(region);
  }
  return result;
}

}  // namespace abn::harness
