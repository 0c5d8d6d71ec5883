#include "sampling/sobol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

struct Quality {
  unsigned t;
  std::size_t empty;
};

// Smallest t for which every elementary interval of area 2^(t-m) holds 2^t of the 2^m points, and the empty cells of
// the sqrt(n) by sqrt(n) grid (m even).
Quality quality(const std::vector<Vec2f>& points) {
  unsigned m = 0;
  while (std::size_t{1} << m < points.size()) ++m;
  Quality result{m, 0};
  for (unsigned t = m + 1; t-- > 0;) {
    bool net = true;
    for (unsigned a = 0; a <= m - t; ++a) {
      net = net && cells_equally_filled(points, std::size_t{1} << a, std::size_t{1} << (m - t - a));
    }
    if (net) result.t = t;
  }
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(points.size())));
  std::vector<bool> filled(side * side);
  for (const Vec2f p : points) {
    filled[static_cast<std::size_t>(p.y * static_cast<float>(side)) * side +
           static_cast<std::size_t>(p.x * static_cast<float>(side))] = true;
  }
  result.empty = static_cast<std::size_t>(std::count(filled.begin(), filled.end(), false));
  return result;
}

TEST(Sobol, IsBoostWithTheOriginPrepended) {
  constexpr std::size_t n = 3000;
  boost::random::sobol_engine<std::uint32_t, 32> engine(40);
  std::vector<std::array<std::uint32_t, 40>> expected(n);
  for (std::size_t i = 1; i < n; ++i) engine.generate(expected[i].begin(), expected[i].end());
  for (const auto& [x, y] : {std::pair{0, 1}, {1, 0}, {10, 11}, {2, 39}}) {
    const auto points = draw<Sobol>({1, 1}, n, 1, {.dim_x = x, .dim_y = y});
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(points[i].x, expected[i][static_cast<std::size_t>(x)] * 0x1p-32);
      ASSERT_EQ(points[i].y, expected[i][static_cast<std::size_t>(y)] * 0x1p-32);
    }
  }
}

TEST(Sobol, FirstTwoDimensionsHaveTZero) {
  for (unsigned m = 0; m <= 14; ++m) EXPECT_TRUE(is_zero_net(draw<Sobol>({1, 1}, std::uint64_t{1} << m, 1), m)) << m;
}

// Design notes, literature section 7: Joe-Kuo directions, dimensions from 0, origin included.
TEST(Sobol, BadPairsAreAsPublished) {
  struct Case {
    int x, y;
    std::uint64_t n;
    unsigned t;
    std::size_t empty;
  };
  for (const auto& c :
       {Case{0, 1, 256, 0, 0}, Case{10, 11, 64, 3, 32}, Case{10, 11, 256, 2, 0}, Case{10, 11, 1024, 1, 0},
        Case{18, 19, 256, 1, 128}, Case{18, 19, 1024, 3, 512}, Case{11, 12, 256, 4, 128}, Case{19, 20, 1024, 1, 0}}) {
    const Quality q = quality(draw<Sobol>({1, 1}, c.n, 1, {.dim_x = c.x, .dim_y = c.y}));
    EXPECT_EQ(q.t, c.t) << c.x << "," << c.y << " n=" << c.n;
    EXPECT_EQ(q.empty, c.empty) << c.x << "," << c.y << " n=" << c.n;
  }
}

TEST(Sobol, SamePointsForEverySeedAndPixel) {
  EXPECT_FALSE(Sobol::info.random);
  EXPECT_EQ(draw<Sobol>({1, 1}, 100, 1), draw<Sobol>({1, 1}, 100, 2));
  const auto pixels = by_pixel(draw<Sobol>({3, 2}, 6 * 16, 1, {.domain = "pixel"}), {3, 2});
  for (const auto& pixel : pixels) EXPECT_EQ(pixel, pixels[0]);
}

TEST(Sobol, RefusesBadDimensions) {
  EXPECT_THROW(draw<Sobol>({1, 1}, 16, 1, {.dim_x = 3, .dim_y = 3}), ConfigError);
  EXPECT_THROW(parse_parameters("sobol", Sobol::fields(), {{"dim_x", "3667"}}), ConfigError);
  EXPECT_NO_THROW(draw<Sobol>({1, 1}, 16, 1, {.dim_x = 3666}));
}

TEST(Sobol, LongRunsJoinAcrossBatches) {
  const auto points = draw<Sobol>({1, 1}, std::uint64_t{1} << 22, 1);
  EXPECT_TRUE(cells_equally_filled(points, 2048, 2048));
}

}  // namespace
}  // namespace abn
