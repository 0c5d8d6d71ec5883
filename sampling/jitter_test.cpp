#include "sampling/jitter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

// Number of the stratum a point of the unit square lies in, from the definition: rows as high as their counts.
std::size_t stratum(Vec2f p, std::size_t n, std::size_t rows) {
  std::size_t row = 0;
  while (static_cast<double>((row + 1) * n / rows) / static_cast<double>(n) <= p.y) ++row;
  const std::size_t begin = row * n / rows;
  const std::size_t columns = (row + 1) * n / rows - begin;
  return begin + static_cast<std::size_t>(static_cast<double>(p.x) * static_cast<double>(columns));
}

TEST(Jitter, EveryStratumOfEveryPixelOnceForAllCounts) {
  const Extent plane{6, 5};
  for (std::size_t n = 1; n <= 64; ++n) {
    for (const auto& pixel : with_axes_restored(by_pixel(draw<Jitter>(plane, plane.area() * n, n), plane), plane)) {
      ASSERT_EQ(pixel.size(), n);
      std::vector<int> hit(n);
      for (const Vec2f p : pixel) ++hit.at(stratum(p, n, jitter_rows(n, {1, 1})));
      ASSERT_EQ(std::count(hit.begin(), hit.end(), 1), static_cast<std::ptrdiff_t>(n)) << n;
    }
  }
}

TEST(Jitter, MixedCountsEachHaveTheirStrata) {
  const Extent plane{20, 20};
  for (const auto& pixel : with_axes_restored(by_pixel(draw<Jitter>(plane, 400 * 6 + 123, 1), plane), plane)) {
    const std::size_t n = pixel.size();
    std::vector<int> hit(n);
    for (const Vec2f p : pixel) ++hit.at(stratum(p, n, jitter_rows(n, {1, 1})));
    ASSERT_EQ(std::count(hit.begin(), hit.end(), 1), static_cast<std::ptrdiff_t>(n));
  }
}

TEST(JitterRows, NearSquareWherePossibleElseAboutTheRoot) {
  EXPECT_EQ(jitter_rows(6, {1, 1}), 3U);
  EXPECT_EQ(jitter_rows(8, {1, 1}), 4U);
  EXPECT_EQ(jitter_rows(7, {1, 1}), 3U);
  EXPECT_EQ(jitter_rows(13, {1, 1}), 4U);
  EXPECT_EQ(jitter_rows(1, {1, 1}), 1U);
  EXPECT_EQ(jitter_rows(200, {200, 100}), 10U);
  EXPECT_EQ(jitter_rows(7, {1, 1000}), 7U);
}

// A point is uniform in its stratum: so is the union over strata in the pixel, for a prime count too.
TEST(Jitter, UniformOverThePixelForPrimeCounts) {
  const Extent plane{100, 100};
  std::vector<double> count(64);
  for (const Vec2f p : draw<Jitter>(plane, plane.area() * 7, 1)) {
    const auto bin = [](float v) {
      return static_cast<std::size_t>((v - static_cast<float>(static_cast<int>(v))) * 8);
    };
    ++count[bin(p.y) * 8 + bin(p.x)];
  }
  double chi2 = 0;
  for (const double c : count) chi2 += (c - 70000 / 64.0) * (c - 70000 / 64.0) / (70000 / 64.0);
  EXPECT_LT(chi2, 113.0);  // 63 degrees of freedom, p = 1e-4; stratification only lowers it
}

TEST(JitterPlane, EveryStratumOnce) {
  for (const auto& [plane, n] :
       {std::pair{Extent{64, 64}, std::size_t{4096}}, std::pair{Extent{128, 64}, std::size_t{8192}},
        std::pair{Extent{64, 32}, std::size_t{1009}}}) {
    std::vector<int> hit(n);
    for (const Vec2f p : draw<JitterPlane>(plane, n, 1)) {
      const Vec2f unit{p.x / static_cast<float>(plane.width), p.y / static_cast<float>(plane.height)};
      ++hit.at(stratum(unit, n, jitter_rows(n, plane)));
    }
    EXPECT_EQ(std::count(hit.begin(), hit.end(), 1), static_cast<std::ptrdiff_t>(n)) << n;
  }
}

TEST(Jitter, NeighbouringPixelsHaveTheirCellsTurned) {
  const Extent plane{4, 4};
  const auto pixels = by_pixel(draw<Jitter>(plane, plane.area() * 6, 3), plane);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const bool turned = (i % 4 + i / 4) % 2 == 1;
    EXPECT_TRUE(cells_equally_filled(pixels[i], turned ? 3 : 2, turned ? 2 : 3)) << i;
  }
}

}  // namespace
}  // namespace abn
