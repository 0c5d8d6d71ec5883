#include "sampling/density_warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

/// Densities over four decades, a tenth of them 0, and an empty row.
Grid<float> rough_density(Extent size) {
  Grid<float> density(size);
  for (std::size_t i = 0; i < size.area(); ++i) {
    Rng rng(3, stream_id("density"), i);
    density[i] = rng.uniform() < 0.1F ? 0.0F : std::pow(10.0F, 4.0F * rng.uniform() - 2.0F);
  }
  for (std::uint32_t x = 0; x < size.width && size.height > 3; ++x) density.at(x, 2) = 0;
  return density;
}

std::size_t cell_of(const Grid<float>& density, Vec2f point) {
  const auto x = static_cast<std::uint32_t>(point.x * static_cast<float>(density.size().width));
  const auto y = static_cast<std::uint32_t>(point.y * static_cast<float>(density.size().height));
  return density.index(x, y);
}

std::string refusal(const Grid<float>& density) {
  try {
    DensityWarp warp(density);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(DensityWarp, CountsFollowTheDensity) {
  const Grid<float> density = rough_density({23, 17});
  const DensityWarp warp(density);
  double total = 0;
  for (const float value : density.cells()) total += static_cast<double>(value);
  constexpr std::size_t count = 2'000'000;
  std::vector<double> found(density.cells().size());
  for (std::size_t i = 0; i < count; ++i) found[cell_of(density, warp(Rng(1, 0, i).uniform2()))] += 1;

  double chi_squared = 0;
  double freedom = -1;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double expected = count * static_cast<double>(density[i]) / total;
    if (density[i] == 0) {
      EXPECT_EQ(found[i], 0) << "cell " << i << " of density 0";
    } else if (expected >= 5) {
      chi_squared += (found[i] - expected) * (found[i] - expected) / expected;
      freedom += 1;
    }
  }
  ASSERT_GT(freedom, 200);
  EXPECT_LT(std::abs(chi_squared - freedom), 4 * std::sqrt(2 * freedom));
}

TEST(DensityWarp, UniformDensityIsTheIdentity) {
  for (const Extent size : {Extent{1, 1}, {7, 3}, {640, 480}}) {
    const DensityWarp warp(Grid<float>(size, 0.3F));
    for (std::size_t i = 0; i < 10'000; ++i) {
      const Vec2f unit = Rng(2, 0, i).uniform2();
      const Vec2f image = warp(unit);
      EXPECT_NEAR(image.x, unit.x, 1e-6);
      EXPECT_NEAR(image.y, unit.y, 1e-6);
    }
  }
}

TEST(DensityWarp, ExtremePointsStayInsideAndOffEmptyCells) {
  const float edges[] = {0.0F,     std::numeric_limits<float>::denorm_min(),
                         0x1p-24F, 1.0F / 3,
                         0.5F,     just_below(0.5F),
                         0.75F,    just_below(1.0F)};
  for (const Extent size : {Extent{1, 1}, {2, 2}, {3, 7}, {1, 1000}, {1000, 1}, {49, 51}}) {
    Grid<float> density = rough_density(size);
    if (size.area() > 4) density[0] = density[size.area() - 1] = 0;
    if (size.area() <= 4) density[0] = 1;
    const DensityWarp warp(density);
    for (const float x : edges) {
      for (const float y : edges) {
        const Vec2f image = warp({x, y});
        ASSERT_TRUE(image.x >= 0 && image.x < 1 && image.y >= 0 && image.y < 1);
        EXPECT_GT(density[cell_of(density, image)], 0) << size.width << "x" << size.height << " " << x << " " << y;
      }
    }
  }
}

// One cell of many: every point must end in it, in float and in double, whatever its width in floats.
TEST(DensityWarp, RoundingKeepsPointsInTheirCell) {
  for (const std::uint32_t width : {3U, 10U, 49U, 200U, 3000U, 1U << 20}) {
    for (const std::uint32_t cell : {0U, 1U, width / 3, width / 2, width - 2, width - 1}) {
      Grid<float> density({width, 1});
      density.at(cell, 0) = 1e-30F;
      const DensityWarp warp(density);
      for (const float x : {0.0F, 0.5F, 0.999999F, just_below(1.0F)}) {
        const float image = warp({x, 0}).x;
        EXPECT_EQ(std::floor(image * static_cast<float>(width)), static_cast<float>(cell)) << width;
        EXPECT_EQ(std::floor(static_cast<double>(image) * width), cell) << width;
      }
    }
  }
}

TEST(DensityWarp, HugeRangesDoNotOverflow) {
  Grid<float> density({64, 64}, std::numeric_limits<float>::max());
  density.at(5, 5) = std::numeric_limits<float>::denorm_min();
  const DensityWarp warp(density);
  for (std::size_t i = 0; i < 1000; ++i) {
    const Vec2f image = warp(Rng(4, 0, i).uniform2());
    EXPECT_TRUE(image.x >= 0 && image.x < 1 && image.y >= 0 && image.y < 1);
  }
}

TEST(DensityWarp, BadDensitiesAreRefused) {
  EXPECT_NE(refusal(Grid<float>({4, 4}, 0.0F)).find("0 everywhere"), std::string::npos);
  EXPECT_NE(refusal(Grid<float>()).find("no cells"), std::string::npos);
  EXPECT_NE(refusal(Grid<float>({(1U << 20) + 1, 1}, 1.0F)).find("at most 1048576"), std::string::npos);
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), -1.0F}) {
    Grid<float> density({4, 3}, 1.0F);
    density.at(3, 2) = bad;
    density.at(1, 2) = bad;
    const std::string message = refusal(density);
    EXPECT_NE(message.find("2 negative or non-finite cells, the first at (1, 2)"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace abn
