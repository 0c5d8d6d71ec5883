#include "sampling/random.h"

#include <gtest/gtest.h>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

TEST(Random, UniformByChiSquare) {
  constexpr std::size_t bins = 32;
  std::vector<double> count(bins * bins);
  constexpr std::uint64_t n = 200000;
  for (const Vec2f p : draw<Random>({64, 16}, n, 1)) {
    ++count[static_cast<std::size_t>(p.y * 2) * bins + static_cast<std::size_t>(p.x / 2)];
  }
  double chi2 = 0;
  for (const double c : count) chi2 += (c - n / 1024.0) * (c - n / 1024.0) / (n / 1024.0);
  EXPECT_GT(chi2, 873.0);   // 1023 degrees of freedom, p = 0.9995: not stratified either
  EXPECT_LT(chi2, 1179.0);  // p = 0.0005
}

TEST(Random, CountsOfPixelsHaveThePoissonVariance) {
  const Extent plane{100, 100};
  const auto pixels = by_pixel(draw<Random>(plane, 60000, 2), plane);
  double variance = 0;
  for (const auto& pixel : pixels) {
    const double delta = static_cast<double>(pixel.size()) - 6;
    variance += delta * delta / 10000;
  }
  EXPECT_NEAR(variance, 6.0, 4 * 6.0 * std::sqrt(2.0 / 10000));
}

TEST(RandomPixel, SameCountInEveryPixelUniformInside) {
  const Extent plane{50, 40};
  std::vector<double> count(100);
  for (const auto& pixel : by_pixel(draw<RandomPixel>(plane, plane.area() * 6, 1), plane)) {
    ASSERT_EQ(pixel.size(), 6U);
    for (const Vec2f p : pixel) ++count[static_cast<std::size_t>(p.y * 10) * 10 + static_cast<std::size_t>(p.x * 10)];
  }
  double chi2 = 0;
  for (const double c : count) chi2 += (c - 120) * (c - 120) / 120;
  EXPECT_GT(chi2, 57.0);   // 99 degrees of freedom, p = 0.9998
  EXPECT_LT(chi2, 157.0);  // p = 0.0002
}

}  // namespace
}  // namespace abn
