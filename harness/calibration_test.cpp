#include "harness/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "harness/reconstruction.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

constexpr Extent plane{64, 64};

// A picture that is `off` in its right half, which alone is uncertain; two uniform samples per pixel scatter by
// `scatter` around 0.5 there, and one later sample per pixel follows.
struct Case {
  Developed developed;
  Film film{plane, 1, true};
};

Case case_of(float off, float scatter) {
  Case made;
  made.developed.image = Image(plane, 1);
  made.developed.standard_error = Grid<float>(plane, 0.0F);
  std::vector<Vec2f> position;
  std::vector<float> value;
  for (std::uint32_t round = 0; round < 3; ++round) {
    for (std::uint32_t y = 0; y < plane.height; ++y) {
      for (std::uint32_t x = 0; x < plane.width; ++x) {
        Rng rng(3, round, y * plane.width + x);
        position.push_back({static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F});
        value.push_back(0.5F + (x >= 32 ? scatter * (2 * rng.uniform() - 1) : 0));
        made.developed.image.texels[y * plane.width + x] = 0.5F + (x >= 32 ? off : 0);
        made.developed.standard_error.at(x, y) = x >= 32 ? 0.1F : 0.0F;
      }
    }
  }
  made.film.add({.position = position}, value);
  return made;
}

double mean_of(const Image& image) {
  double sum = 0;
  for (const float v : image.texels) sum += double{v};
  return sum / static_cast<double>(image.texels.size());
}

constexpr std::uint64_t uniform = 2 * 64 * 64;

TEST(Calibration, MovesTheMeanToThatOfTheUniformSamples) {
  Case c = case_of(-0.1F, 0.2F);
  double samples = 0;
  for (std::uint64_t i = 0; i < uniform; ++i) samples += double{c.film.kept().value[i]} / uniform;
  const double moved = calibrate(c.developed, c.film, uniform);
  EXPECT_NEAR(moved, 0.05, 0.003);
  EXPECT_NEAR(mean_of(c.developed.image), samples, 1e-6);
}

TEST(Calibration, LeavesWhatIsCertainAndFarAway) {
  Case c = case_of(-0.1F, 0.2F);
  calibrate(c.developed, c.film, uniform);
  const Image& image = c.developed.image;
  EXPECT_NEAR(image.texels[30 * 64 + 4], 0.5F, 2e-4F);  // 28 px from the nearest uncertain pixel
  EXPECT_GT(image.texels[30 * 64 + 50], 0.49F);         // was .4
  EXPECT_LT(std::abs(image.texels[30 * 64 + 50] - 0.5F), 0.02F);
}

TEST(Calibration, IgnoresWhatIsWithinNoise) {
  Case c = case_of(0.0F, 0.4F);
  const Image before = c.developed.image;
  EXPECT_EQ(calibrate(c.developed, c.film, uniform), 0);
  EXPECT_EQ(c.developed.image.texels, before.texels);
}

TEST(Calibration, DoesNothingWhereNothingIsKnown) {
  Case c = case_of(-0.1F, 0.2F);
  const Image before = c.developed.image;
  EXPECT_EQ(calibrate(c.developed, c.film, 0), 0);
  EXPECT_EQ(calibrate(c.developed, c.film, 3 * 64 * 64), 0);  // all are uniform: they are the picture
  c.developed.standard_error = {};
  EXPECT_EQ(calibrate(c.developed, c.film, uniform), 0);
  EXPECT_EQ(c.developed.image.texels, before.texels);
}

TEST(Calibration, KeepsChannelsApart) {
  Developed developed;
  developed.image = Image({8, 8}, 3);
  developed.standard_error = Grid<float>({8, 8}, 1.0F);
  Film film({8, 8}, 3, true);
  std::vector<Vec2f> position;
  std::vector<float> value;
  for (std::uint32_t i = 0; i < 128; ++i) {
    position.push_back({static_cast<float>(i % 8) + 0.5F, static_cast<float>(i / 8 % 8) + 0.5F});
    value.insert(value.end(), {0.1F, 0.2F, i % 2 == 0 ? 0.3F : 0.5F});
  }
  film.add({.position = position}, value);
  calibrate(developed, film, 64);
  for (std::size_t p = 0; p < 64; ++p) {
    EXPECT_NEAR(developed.image.texels[3 * p], 0.1F, 1e-5F);
    EXPECT_NEAR(developed.image.texels[3 * p + 1], 0.2F, 1e-5F);
    EXPECT_NEAR(developed.image.texels[3 * p + 2], 0.4F, 1e-5F);
  }
}

}  // namespace
}  // namespace abn::harness
