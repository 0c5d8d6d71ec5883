#include "sampling/unit_square_sampler.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "sampling/draw_for_tests.h"
#include "sampling/jitter.h"
#include "sampling/pmj02.h"
#include "sampling/random.h"
#include "sampling/sobol_owen.h"

namespace abn {
namespace {

std::vector<std::size_t> counts(const std::vector<Vec2f>& positions, Extent plane) {
  std::vector<std::size_t> result;
  for (const auto& pixel : by_pixel(positions, plane)) result.push_back(pixel.size());
  return result;
}

// Points at the very border of thirds, fifths, ...: where rounding down goes wrong.
class Borders final : public UnitSquareSampler {
 public:
  Borders(const SamplingTask& task, Domain domain) : UnitSquareSampler(task, "borders", domain) {}

 protected:
  void points(std::uint64_t, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override {
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k] = {stratum_place(first + k, 0, n), stratum_place(first + k, 0xFFFFFFFFU, n)};
    }
  }
  Strata strata(std::uint64_t n) const override { return {n, n}; }
};

// Point i of n of every set at (i / n, largest fraction): shows order, chunking and rounding.
class Ramp final : public UnitSquareSampler {
 public:
  Ramp(const SamplingTask& task, Domain domain) : UnitSquareSampler(task, "ramp", domain) {}

 protected:
  void points(std::uint64_t, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = {stratum_place(first + k, 0, n), 0xFFFFFFFFU};
  }
};

TEST(StratumPlace, StaysInItsStratum) {
  for (const std::uint64_t n : {1U, 3U, 10U, 64U, 1000000007U}) {
    for (const std::uint64_t k : {std::uint64_t{0}, n / 2, n - 1}) {
      for (const std::uint32_t u : {0U, 0x80000000U, 0xFFFFFFFFU}) {
        const std::uint64_t place = stratum_place(k, u, n);
        EXPECT_LT(place * n, (k + 1) << 32);
        EXPECT_GE(place * n, k << 32);
      }
    }
  }
}

TEST(RandomPoints, AreTheWordsOfPhiloxWhereverABlockStarts) {
  constexpr std::uint64_t key = 0x0123456789ABCDEFU;
  for (const std::uint64_t first :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{7}, (std::uint64_t{1} << 33) - 5}) {
    std::vector<UnitPoint> points(100);
    random_points(key, first, points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::uint64_t i = first + k;
      Rng rng(key, stream_id("offset"), i / 2);
      if (i % 2 == 1) {
        rng.next();
        rng.next();
      }
      ASSERT_EQ(points[k].x, rng.next()) << i;
      ASSERT_EQ(points[k].y, rng.next()) << i;
    }
  }
}

TEST(UnitSquareSampler, EveryPixelHasFloorOrCeilAndTheTotalIsExact) {
  const Extent plane{17, 11};
  for (const std::uint64_t budget : {1U, 5U, 186U, 187U, 188U, 1000U, 1122U, 100003U}) {
    const auto positions = draw<RandomPixel>(plane, budget, 3);
    ASSERT_EQ(positions.size(), budget);
    for (const std::size_t c : counts(positions, plane)) {
      EXPECT_GE(c, budget / 187);
      EXPECT_LE(c, (budget + 186) / 187);
    }
  }
}

TEST(UnitSquareSampler, ExtraSamplesGoToRandomPixelsTheSameForAllStrategies) {
  const Extent plane{40, 40};
  const std::uint64_t budget = 1600 * 3 + 800;
  const auto seed1 = counts(draw<RandomPixel>(plane, budget, 1), plane);
  EXPECT_EQ(counts(draw<SobolOwen>(plane, budget, 1), plane), seed1);
  EXPECT_NE(counts(draw<RandomPixel>(plane, budget, 2), plane), seed1);
  // Any 400 pixels in a row, an average of 200 extra, standard deviation 8.7.
  for (std::size_t quarter = 0; quarter < 4; ++quarter) {
    std::size_t extra = 0;
    for (std::size_t p = 0; p < 400; ++p) extra += seed1[400 * quarter + p] - 3;
    EXPECT_NEAR(static_cast<double>(extra), 200, 35);
  }
}

TEST(UnitSquareSampler, SameForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  const auto draw_with = [](int n, Extent plane, std::uint64_t budget) {
    omp_set_num_threads(n);
    auto positions = draw<Jitter>(plane, budget, 1);
    const auto more = draw<Random>(plane, budget, 1);
    positions.insert(positions.end(), more.begin(), more.end());
    return positions;
  };
  for (const auto& [plane, budget] :
       {std::pair{Extent{100, 50}, std::uint64_t{33333}}, std::pair{Extent{1, 1}, std::uint64_t{100000}}}) {
    const auto one = draw_with(1, plane, budget);
    EXPECT_EQ(draw_with(2, plane, budget), one);
    EXPECT_EQ(draw_with(5, plane, budget), one);
  }
  omp_set_num_threads(threads);
}

TEST(UnitSquareSampler, BatchesAreBoundedAndJoinWithoutSeams) {
  const Grid<PixelStats> none;
  const Feedback feedback{none};
  constexpr std::uint64_t budget = (std::uint64_t{5} << 19) + 12345;
  for (const Domain domain : {Domain::plane, Domain::pixel}) {
    for (const Extent plane : {Extent{1, 1}, Extent{64, 2}}) {
      Ramp sampler(SamplingTask{plane, budget, 1}, domain);
      const auto seed_batch = sampler.next(feedback);
      std::vector<Vec2f> all(seed_batch.position.begin(), seed_batch.position.end());
      for (auto batch = sampler.next(feedback); !batch.empty(); batch = sampler.next(feedback)) {
        EXPECT_LE(batch.position.size(), std::size_t{1} << 20);
        all.insert(all.end(), batch.position.begin(), batch.position.end());
      }
      EXPECT_TRUE(sampler.next(feedback).empty());
      ASSERT_EQ(all.size(), budget);
      if (domain == Domain::plane) {
        for (std::size_t i = 0; i < budget; i += 997) {
          ASSERT_NEAR(all[i].x, static_cast<double>(i * plane.width) / budget, 1e-5 * plane.width);
        }
      } else {
        for (const auto& pixel : by_pixel(all, plane)) {
          for (std::size_t i = 0; i < pixel.size(); i += 97) {
            ASSERT_NEAR(pixel[i].x, static_cast<double>(i) / static_cast<double>(pixel.size()), 1e-5);
          }
        }
      }
    }
  }
}

TEST(UnitSquareSampler, NeverLeavesPixelOrPlane) {
  const Extent plane{5000, 3};
  for (const auto& pixel : by_pixel(
           [&] {
             Ramp sampler(SamplingTask{plane, plane.area() * 4, 1}, Domain::pixel);
             return draw_all(sampler);
           }(),
           plane)) {
    ASSERT_EQ(pixel.size(), 4U);
    for (const Vec2f p : pixel) ASSERT_LT(p.y, 1.0F);
  }
  Ramp sampler(SamplingTask{plane, 1000, 1}, Domain::plane);
  for (const Vec2f p : draw_all(sampler)) {
    ASSERT_LT(p.y, 3.0F);
    ASSERT_LT(p.x, 5000.0F);
  }
}

TEST(UnitSquareSampler, RoundingKeepsNamedStrata) {
  const Extent plane{300, 200};
  for (const std::size_t n : {3U, 5U, 6U, 7U, 26U}) {
    Borders sampler(SamplingTask{plane, plane.area() * n, 1}, Domain::pixel);
    for (const auto& pixel : by_pixel(draw_all(sampler), plane)) {
      ASSERT_TRUE(cells_equally_filled(pixel, n, 1)) << n;
      ASSERT_TRUE(cells_equally_filled(pixel, 1, n)) << n;
    }
  }
  constexpr std::size_t n = 240000;
  Borders sampler(SamplingTask{plane, n, 1}, Domain::plane);
  std::vector<int> x(n), y(n);
  for (const Vec2f p : draw_all(sampler)) {
    ++x[static_cast<std::size_t>(static_cast<double>(p.x) * n / plane.width)];
    ++y[static_cast<std::size_t>(static_cast<double>(p.y) * n / plane.height)];
  }
  EXPECT_EQ(std::count(x.begin(), x.end(), 1), static_cast<std::ptrdiff_t>(n));
  EXPECT_EQ(std::count(y.begin(), y.end(), 1), static_cast<std::ptrdiff_t>(n));
}

TEST(UnitSquareSampler, PixelsAreIndependent) {
  const Extent plane{64, 64};
  const auto pixels = by_pixel(draw<SobolOwen>(plane, plane.area(), 1), plane);
  double covariance = 0;
  for (std::size_t p = 0; p + 1 < pixels.size(); ++p) covariance += (pixels[p][0].x - 0.5) * (pixels[p + 1][0].x - 0.5);
  covariance /= static_cast<double>(pixels.size());
  EXPECT_NEAR(covariance, 0, 4.0 / 12 / 64);
}

TEST(UnitSquareSampler, RefusesEmptyAndOversizedTasks) {
  EXPECT_THROW(Random(SamplingTask{{0, 5}, 10, 1}, {}), ConfigError);
  EXPECT_THROW(Random(SamplingTask{{5, 5}, 0, 1}, {}), ConfigError);
  EXPECT_THROW(Pmj02(SamplingTask{{1, 1}, std::uint64_t{1} << 31, 1}, {}), ConfigError);
}

}  // namespace
}  // namespace abn
