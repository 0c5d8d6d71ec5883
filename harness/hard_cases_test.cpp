#include "harness/hard_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/scenes.h"

namespace abn::harness {
namespace {

/// The part of cell `index` of `texels` that pixel `pixel` of `pixels` covers, as weights of its mean.
double overlap(std::uint32_t index, std::uint32_t texels, std::uint32_t pixel, std::uint32_t pixels) {
  const double lo = std::max(double{1} * index, double{1} * pixel * texels / pixels);
  const double hi = std::min(index + 1.0, (pixel + 1.0) * texels / pixels);
  return std::max(0.0, hi - lo) * pixels / texels;
}

/// Area-weighted block means of the texels in double, by the definition.
std::vector<double> block_means(const Image& image, Extent to) {
  std::vector<double> rows(std::size_t{image.size.height} * to.width, 0.0), means(to.area(), 0.0);
  for (std::uint32_t x = 0; x < to.width; ++x) {
    for (std::uint32_t i = 0; i < image.size.width; ++i) {
      const double weight = overlap(i, image.size.width, x, to.width);
      if (weight == 0) continue;
      for (std::uint32_t j = 0; j < image.size.height; ++j) {
        rows[std::size_t{j} * to.width + x] += weight * double{*image.texel(i, j)};
      }
    }
  }
  for (std::uint32_t y = 0; y < to.height; ++y) {
    for (std::uint32_t j = 0; j < image.size.height; ++j) {
      const double weight = overlap(j, image.size.height, y, to.height);
      if (weight == 0) continue;
      for (std::uint32_t x = 0; x < to.width; ++x) {
        means[std::size_t{y} * to.width + x] += weight * rows[std::size_t{j} * to.width + x];
      }
    }
  }
  return means;
}

/// Compares relative to 1 or to the value, whichever is larger: dynamic_range reaches 10^6.
void expect_close(const Image& truth, const std::vector<double>& means, const std::string& what) {
  ASSERT_EQ(truth.texels.size(), means.size()) << what;
  for (std::size_t i = 0; i < means.size(); ++i) {
    ASSERT_NEAR(double{truth.texels[i]}, means[i], 2e-7 * std::max(1.0, std::abs(means[i]))) << what << ", pixel " << i;
  }
}

TEST(HardCases, TexelTruthIsTheBlockMeanForAnyRatio) {
  struct Sizes {
    Extent size, to;
  };
  const Sizes cases[] = {{{300, 300}, {20, 20}}, {{299, 301}, {20, 21}}, {{300, 300}, {199, 7}}, {{64, 48}, {100, 96}},
                         {{1, 50}, {1, 8}},      {{50, 1}, {8, 1}},      {{1, 1}, {1, 1}},       {{1, 1}, {3, 2}}};
  int checked = 0;
  for (const Scene& scene : scenes()) {
    if (scene.texel_truth == nullptr) continue;
    ++checked;
    for (const auto& [size, to] : cases) {
      const Image image = render_scene(scene, size);
      expect_close(*closed_form_truth(scene, size, to), block_means(image, to),
                   scene.name + " " + std::to_string(size.width) + "x" + std::to_string(size.height) + " to " +
                       std::to_string(to.width) + "x" + std::to_string(to.height));
    }
  }
  EXPECT_EQ(checked, 10);
}

TEST(HardCases, ContinuousTruthIsTheLimitOfFineTexels) {
  // The picture on 16 x 16 times the texels, reduced to few pixels, is close to the mean of the continuous picture.
  // An edge through a pixel errs by at most its length in texels of the fine picture.
  const Extent coarse{40, 40}, to{10, 10};
  constexpr std::uint32_t finer = 16;
  for (const char* name : {"siemens_star", "slanted_edge"}) {
    const Scene& scene = find_scene(name);
    // Both pictures do not depend on the number of texels, only on the frame.
    const Image fine = render_scene(scene, {coarse.width * finer, coarse.height * finer});
    const Image truth = *continuous_truth(scene, coarse, to);
    const std::vector<double> means = block_means(fine, to);
    for (std::size_t i = 0; i < means.size(); ++i) EXPECT_NEAR(double{truth.texels[i]}, means[i], 0.02) << name << i;
    double sum = 0, expected = 0;
    for (std::size_t i = 0; i < means.size(); ++i) {
      sum += double{truth.texels[i]};
      expected += means[i];
    }
    EXPECT_NEAR(sum, expected, 0.05) << name;
  }
}

TEST(HardCases, SiemensStarMeanIsOneHalfInOppositePixels) {
  // A half turn maps bright sectors to bright ones (36 is even), so opposite pixels are equal; the whole is half bright
  // up to the corners' excess.
  const Image truth = siemens_star_continuous_truth({3000, 3000}, {200, 200});
  double sum = 0;
  for (std::size_t i = 0; i < truth.texels.size(); ++i) {
    ASSERT_NEAR(truth.texels[i], truth.texels[truth.texels.size() - 1 - i], 1e-6F);
    sum += double{truth.texels[i]};
  }
  EXPECT_NEAR(sum / 40000, 0.5, 2e-3);
  EXPECT_NEAR(truth.texels[100 * 200 + 100], 0.5, 0.05);
}

TEST(HardCases, ZonePlateContinuousTruthIsTheQuadratureOfTheFormula) {
  const Extent size{240, 160}, to{16, 10};
  constexpr int per_side = 400;  // midpoints per pixel and axis
  const double longer = 240;
  const Image truth = zone_plate_continuous_truth(size, to);
  for (std::uint32_t y = 0; y < to.height; y += 3) {
    for (std::uint32_t x = 0; x < to.width; x += 5) {
      double sum = 0;
      for (int b = 0; b < per_side; ++b) {
        for (int a = 0; a < per_side; ++a) {
          const double dx = (x + (a + 0.5) / per_side) * 15 - 120, dy = (y + (b + 0.5) / per_side) * 16 - 80;
          sum += 0.5 + 0.5 * std::cos(std::numbers::pi * (dx * dx + dy * dy) / longer);
        }
      }
      EXPECT_NEAR(double{*truth.texel(x, y)}, sum / (per_side * per_side), 2e-5) << x << ' ' << y;
    }
  }
}

TEST(HardCases, ZonePlateTruthsDifferWhereTexelsAlias) {
  const Image texels = zone_plate_texel_truth({3000, 3000}, {200, 200});
  const Image continuous = zone_plate_continuous_truth({3000, 3000}, {200, 200});
  double worst = 0, squares = 0;
  for (std::size_t i = 0; i < texels.texels.size(); ++i) {
    const double difference = double{texels.texels[i]} - double{continuous.texels[i]};
    worst = std::max(worst, std::abs(difference));
    squares += difference * difference;
  }
  EXPECT_NEAR(worst, 0.01124, 1e-4);
  RecordProperty("rms_difference", std::to_string(std::sqrt(squares / 40000)));
}

TEST(HardCases, KnownMeansAt3000To200) {
  const Extent size{3000, 3000}, to{200, 200};
  const Image board = checkerboard_1texel_truth(size, to);
  EXPECT_FLOAT_EQ(*board.texel(0, 0), 113.0F / 225);
  EXPECT_FLOAT_EQ(*board.texel(1, 0), 112.0F / 225);
  EXPECT_FLOAT_EQ(*board.texel(1, 1), 113.0F / 225);

  const Image step = step_1507_truth(size, to);
  EXPECT_EQ(*step.texel(99, 5), 0.0F);
  EXPECT_FLOAT_EQ(*step.texel(100, 5), 8.0F / 15);
  EXPECT_EQ(*step.texel(101, 5), 1.0F);
  EXPECT_EQ(*step_1500_truth(size, to).texel(99, 199), 0.0F);
  EXPECT_EQ(*step_1500_truth(size, to).texel(100, 199), 1.0F);

  const Image firefly = firefly_truth(size, to);
  EXPECT_NEAR(*firefly.texel(100, 100), (1e4 + 224 * 0.5) / 225, 1e-5);
  EXPECT_EQ(*firefly.texel(99, 100), 0.5F);
  EXPECT_EQ(*firefly.texel(100, 99), 0.5F);

  const Image lines = lines_47_truth(size, to);
  for (std::uint32_t x = 0; x < 200; ++x) {
    int count = 0;
    for (std::uint32_t i = 15 * x; i < 15 * x + 15; ++i) count += i % 47 == 0 ? 1 : 0;
    ASSERT_NEAR(*lines.texel(x, 3), count / 15.0, 1e-7) << x;
  }

  const Image ramp = ramp_truth(size, to);
  for (std::uint32_t x = 0; x < 200; ++x) ASSERT_NEAR(*ramp.texel(x, 7), (x + 0.5) / 200, 1e-7) << x;

  // The mean of the last pixel, digit by digit: 15 terms of the geometric sequence.
  double sum = 0;
  for (int i = 2985; i < 3000; ++i) sum += std::pow(10.0, 12 * (i + 0.5) / 3000 - 6);
  EXPECT_NEAR(*dynamic_range_truth(size, to).texel(199, 0) / (sum / 15), 1.0, 1e-7);
  sum = 0;
  for (int i = 0; i < 15; ++i) sum += std::pow(10.0, 12 * (i + 0.5) / 3000 - 6);
  EXPECT_NEAR(*dynamic_range_truth(size, to).texel(0, 0) / (sum / 15), 1.0, 1e-6);
}

TEST(HardCases, FireflyIsOneTexelOnly) {
  const Image image = render_firefly({300, 300});
  EXPECT_EQ(std::count_if(image.texels.begin(), image.texels.end(), [](float v) { return v != 0.5F; }), 1);
  EXPECT_EQ(*image.texel(150, 150), 1e4F);
}

}  // namespace
}  // namespace abn::harness
