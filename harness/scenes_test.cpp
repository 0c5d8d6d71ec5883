#include "harness/scenes.h"

#include <gtest/gtest.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "harness/data_path.h"
#include "harness/image_io.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

toml::table manifest() { return toml::parse_file(find_data("reference_images/MANIFEST.toml").string()); }

/// The manifest's entry of a scene: its kind of table and the table.
const toml::table* entry_of(const toml::table& file, const char* kind, const std::string& scene) {
  for (const toml::node& node : *file[kind].as_array()) {
    if (node.as_table()->at("scene").value<std::string>() == scene) return node.as_table();
  }
  return nullptr;
}

TEST(Scenes, NamesAreUniqueWordsAndEveryRowIsComplete) {
  std::set<std::string> names;
  for (const Scene& scene : scenes()) {
    EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
    EXPECT_EQ(scene.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos) << scene.name;
    EXPECT_FALSE(scene.summary.empty()) << scene.name;
    EXPECT_FALSE(scene.cite.empty()) << scene.name;
    EXPECT_TRUE(scene.kind == "image" || scene.kind == "procedural" || scene.kind == "hard case") << scene.name;
    EXPECT_EQ(scene.render == nullptr, scene.kind == "image") << scene.name;
    EXPECT_EQ(scene.file.empty(), scene.kind != "image") << scene.name;
    EXPECT_TRUE(scene.channels == 1 || scene.channels == 3) << scene.name;
    EXPECT_EQ(&find_scene(scene.name), &scene);
  }
}

TEST(Scenes, ImageFilesAreThePixelsOfTheManifest) {
  const toml::table file = manifest();
  std::size_t images = 0;
  for (const Scene& scene : scenes()) {
    if (scene.kind != "image") continue;
    ++images;
    const toml::table* entry = entry_of(file, "image", scene.name);
    ASSERT_NE(entry, nullptr) << scene.name;
    const Image image = render_scene(scene);
    EXPECT_EQ(pixel_hash(image), entry->at("pixel_hash").value<std::string>()) << scene.name;
    EXPECT_EQ(image.size.width, entry->at("width").value<std::int64_t>());
    EXPECT_EQ(image.channels, entry->at("channels").value<std::int64_t>());
    EXPECT_EQ("reference_images/" + *entry->at("file").value<std::string>(), scene.file);
    const std::filesystem::path path = find_data(scene.file);
    EXPECT_EQ(std::filesystem::file_size(path), entry->at("bytes").value<std::uintmax_t>()) << scene.name;
    EXPECT_TRUE(std::filesystem::exists(path.parent_path() / "sources" / (scene.name + ".pov")));
    const float brightest = *std::max_element(image.texels.begin(), image.texels.end());
    EXPECT_EQ(brightest > 1.0F, scene.high_dynamic_range) << scene.name << ' ' << brightest;
  }
  EXPECT_EQ(images, file["image"].as_array()->size());
}

TEST(Scenes, ComputedScenesAreThePixelsOfTheManifest) {
  const toml::table file = manifest();
  std::size_t computed = 0;
  for (const Scene& scene : scenes()) {
    if (scene.kind == "image") continue;
    ++computed;
    const toml::table* entry = entry_of(file, "computed", scene.name);
    ASSERT_NE(entry, nullptr) << scene.name;
    const auto side = entry->at("hash_size").value<std::uint32_t>().value();
    const Image image = render_scene(scene, {side, side});
    EXPECT_EQ(pixel_hash(image), entry->at("pixel_hash").value<std::string>()) << scene.name;
  }
  EXPECT_EQ(computed, file["computed"].as_array()->size());
}

TEST(Scenes, ComputedScenesRenderAtAnySize) {
  for (const Scene& scene : scenes()) {
    if (scene.kind == "image") continue;
    for (const Extent size : {Extent{1, 1}, Extent{1, 40}, Extent{61, 37}}) {
      const Image image = render_scene(scene, size);
      ASSERT_EQ(image.size, size) << scene.name;
      ASSERT_EQ(image.channels, scene.channels) << scene.name;
      ASSERT_EQ(image.texels.size(), size.area() * scene.channels) << scene.name;
      for (const float value : image.texels) {
        ASSERT_TRUE(std::isfinite(value)) << scene.name;
        ASSERT_GE(value, 0.0F) << scene.name;
        if (!scene.high_dynamic_range) {
          ASSERT_LE(value, 1.0F) << scene.name;
        }
      }
    }
  }
}

TEST(Scenes, PicturesAreTheSameAtAnySize) {
  // Test pictures are defined on a sheet: every texel of a third of the size is the centre texel of its 3 x 3 block.
  for (const char* name : {"zone", "lines", "smooth", "text", "disks", "fbm"}) {
    const Image small = render_scene(find_scene(name), {100, 100}), large = render_scene(find_scene(name), {300, 300});
    int different = 0;
    for (std::uint32_t y = 0; y < 100; ++y) {
      for (std::uint32_t x = 0; x < 100; ++x) {
        if (std::abs(*small.texel(x, y) - *large.texel(3 * x + 1, 3 * y + 1)) > 1e-5F) ++different;
      }
    }
    EXPECT_LE(different, 3) << name;  // a centre on an edge may fall to either side
  }
}

TEST(Scenes, UnknownNameListsTheKnownOnes) {
  try {
    find_scene("aple");
    FAIL() << "expected a ConfigError";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("'aple'"), std::string::npos) << message;
    for (const Scene& scene : scenes()) EXPECT_NE(message.find(scene.name), std::string::npos) << scene.name;
  }
}

TEST(Scenes, ImpossibleSizesAreRefused) {
  EXPECT_THROW(render_scene(find_scene("apple"), {200, 200}), ConfigError);
  EXPECT_THROW(render_scene(find_scene("ramp"), {0, 10}), ConfigError);
  EXPECT_THROW(render_scene(find_scene("ramp"), {10, 1U << 25}), ConfigError);
  EXPECT_THROW(closed_form_truth(find_scene("ramp"), {10, 10}, {0, 1}), ConfigError);
}

TEST(Scenes, TruthsExistWhereAClosedFormDoes) {
  const Extent size{30, 30}, to{2, 2};
  EXPECT_TRUE(closed_form_truth(find_scene("constant"), size, to).has_value());
  EXPECT_FALSE(closed_form_truth(find_scene("apple"), size, to).has_value());
  EXPECT_FALSE(closed_form_truth(find_scene("siemens_star"), size, to).has_value());
  EXPECT_TRUE(continuous_truth(find_scene("siemens_star"), size, to).has_value());
}

TEST(Regions, LieInThePictureAndBelongToKnownScenes) {
  std::size_t count = 0;
  for (const Scene& scene : scenes()) {
    std::set<std::string> names;
    for (const Region& region : regions(scene)) {
      EXPECT_TRUE(names.insert(region.name).second) << scene.name << '.' << region.name;
      EXPECT_GE((region.right - region.left) * 200, 4) << "a region of less than 4 pixels at 200: " << region.name;
      ++count;
    }
    if (scene.kind == "image") {
      EXPECT_GE(names.size(), 3U) << scene.name;
    }
  }
  const toml::table file = toml::parse_file(find_data("reference_images/regions.toml").string());
  EXPECT_EQ(count, file["region"].as_array()->size()) << "a region names an unknown scene";
  std::set<std::string> apple;
  for (const Region& region : regions(find_scene("apple"))) apple.insert(region.name);
  EXPECT_TRUE(apple.contains("stalk") && apple.contains("far_checkers") && apple.contains("speckles"));
}

}  // namespace
}  // namespace abn::harness
