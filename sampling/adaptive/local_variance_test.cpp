#include "sampling/adaptive/local_variance.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "sampling/rng.h"

namespace abn {
namespace {

struct Samples {
  std::vector<Vec2f> position;
  std::vector<float> value;
};

Samples random_samples(std::size_t count, std::uint32_t channels, Extent plane, std::uint64_t seed) {
  Samples samples;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, stream_id("local_variance test"), i);
    samples.position.push_back(to_plane(rng.uniform2(), plane));
    for (std::uint32_t c = 0; c < channels; ++c) samples.value.push_back(rng.uniform());
  }
  return samples;
}

/// By sorting all samples for every cell.
Grid<float> twin(const Samples& samples, std::uint32_t channels, Extent plane, Extent map, std::size_t neighbours) {
  Grid<float> variance(map);
  std::vector<std::size_t> order(samples.position.size());
  for (std::uint32_t y = 0; y < map.height; ++y) {
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const auto at_x = static_cast<float>((x + 0.5) * plane.width / map.width);
      const auto at_y = static_cast<float>((y + 0.5) * plane.height / map.height);
      const auto distance = [&](std::size_t i) {
        const Vec2f d = samples.position[i] - Vec2f{at_x, at_y};
        return d.x * d.x + d.y * d.y;
      };
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
      const std::size_t n = std::min(neighbours, order.size());
      double sum = 0;
      for (std::uint32_t c = 0; c < channels; ++c) {
        double mean = 0;
        for (std::size_t k = 0; k < n; ++k) mean += double{samples.value[order[k] * channels + c]};
        mean /= static_cast<double>(n);
        for (std::size_t k = 0; k < n; ++k) {
          sum += std::pow(double{samples.value[order[k] * channels + c]} - mean, 2);
        }
      }
      variance.at(x, y) = static_cast<float>(n < 2 ? 0 : sum / (static_cast<double>(n) - 1) / channels);
    }
  }
  return variance;
}

void expect_twin(const Samples& samples, std::uint32_t channels, Extent plane, Extent map, int neighbours) {
  const Grid<float> fast = local_variance(samples.position, samples.value, channels, plane, map, neighbours);
  const Grid<float> slow = twin(samples, channels, plane, map, static_cast<std::size_t>(neighbours));
  ASSERT_EQ(fast.size(), map);
  for (std::size_t i = 0; i < map.area(); ++i) {
    ASSERT_NEAR(fast[i], slow[i], 1e-6) << "cell " << i << " of " << map.width << "x" << map.height << ", "
                                        << samples.position.size() << " samples";
  }
}

TEST(LocalVariance, IsThatOfTheNearestSamples) {
  expect_twin(random_samples(900, 1, {20, 20}, 1), 1, {20, 20}, {40, 40}, 8);
  expect_twin(random_samples(700, 3, {20, 20}, 2), 3, {20, 20}, {21, 17}, 8);
  expect_twin(random_samples(500, 1, {3, 200}, 3), 1, {3, 200}, {6, 100}, 5);
  expect_twin(random_samples(400, 1, {500, 1}, 4), 1, {500, 1}, {200, 2}, 32);
}

TEST(LocalVariance, FewSamplesAllCount) {
  for (std::size_t count = 0; count <= 12; ++count) {
    if (count >= 1) expect_twin(random_samples(count, 3, {7, 5}, count), 3, {7, 5}, {9, 4}, 8);
    const Samples samples = random_samples(count, 1, {7, 5}, count);
    const Grid<float> map = local_variance(samples.position, samples.value, 1, {7, 5}, {3, 3});
    if (count < 2) {
      EXPECT_EQ(*std::max_element(map.cells().begin(), map.cells().end()), 0.0F);
    }
  }
}

// Samples crowded into one pixel of many: wide empty gaps, and cells with hundreds of samples.
TEST(LocalVariance, ClusteredSamplesAreFound) {
  Samples samples = random_samples(800, 1, {50, 40}, 5);
  for (std::size_t i = 10; i < 800; ++i) samples.position[i] = {41.0F + samples.position[i].x / 50, 3.5F};
  expect_twin(samples, 1, {50, 40}, {25, 20}, 8);
}

// A lattice: nearly every distance is shared by several samples; the lower index must win as in the stable sort.
TEST(LocalVariance, TiesAreBrokenByIndex) {
  Samples samples = random_samples(256, 1, {16, 16}, 6);
  for (std::size_t i = 0; i < 256; ++i) {
    const std::size_t k = (i * 77) % 256;
    samples.position[i] = {static_cast<float>(k % 16) + 0.5F, static_cast<float>(k / 16) + 0.5F};
  }
  expect_twin(samples, 1, {16, 16}, {16, 16}, 8);
  expect_twin(samples, 1, {16, 16}, {32, 32}, 7);
}

TEST(LocalVariance, CoincidentSamplesAreAllSeen) {
  Samples samples = random_samples(300, 1, {4, 4}, 7);
  for (Vec2f& p : samples.position) p = {1.25F, 2.5F};
  expect_twin(samples, 1, {4, 4}, {8, 8}, 8);
}

TEST(LocalVariance, IsExactlyZeroWhereValuesAreEqual) {
  for (const float value : {0.1F, 1e-30F, -3.3F, 1e30F, 0.0F}) {
    Samples samples = random_samples(500, 1, {10, 10}, 8);
    std::fill(samples.value.begin(), samples.value.end(), value);
    for (const int neighbours : {3, 8, 31}) {
      const Grid<float> map = local_variance(samples.position, samples.value, 1, {10, 10}, {20, 20}, neighbours);
      for (const float v : map.cells()) ASSERT_EQ(v, 0.0F) << value;
    }
  }
}

// A small contrast on a bright ground is what a difference of mean squares loses.
TEST(LocalVariance, SmallContrastOnBrightGroundSurvives) {
  Samples samples = random_samples(500, 1, {10, 10}, 9);
  Samples shifted = samples;
  for (std::size_t i = 0; i < samples.value.size(); ++i) {
    samples.value[i] = std::round(samples.value[i] * 16);
    shifted.value[i] = samples.value[i] + 1e6F;
  }
  const Grid<float> map = local_variance(samples.position, samples.value, 1, {10, 10}, {20, 20});
  const Grid<float> bright = local_variance(shifted.position, shifted.value, 1, {10, 10}, {20, 20});
  for (std::size_t i = 0; i < 400; ++i) ASSERT_FLOAT_EQ(map[i], bright[i]);
}

TEST(LocalVariance, HugeValuesStayFinite) {
  Samples samples = random_samples(500, 3, {10, 10}, 10);
  for (std::size_t i = 0; i < samples.value.size(); i += 5) samples.value[i] = i % 2 == 0 ? 3e38F : -3e38F;
  Grid<float> map = local_variance(samples.position, samples.value, 3, {10, 10}, {20, 20});
  blur(map, 3);
  for (const float v : map.cells()) ASSERT_TRUE(std::isfinite(v) && v >= 0);
}

TEST(LocalVariance, SameForAnyNumberOfThreads) {
  const Samples samples = random_samples(20'000, 1, {60, 70}, 11);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Grid<float> one = local_variance(samples.position, samples.value, 1, {60, 70}, {120, 140});
  blur(one, 2);
  omp_set_num_threads(3);
  Grid<float> three = local_variance(samples.position, samples.value, 1, {60, 70}, {120, 140});
  blur(three, 2);
  omp_set_num_threads(threads);
  EXPECT_TRUE(std::equal(one.cells().begin(), one.cells().end(), three.cells().begin()));
}

TEST(Blur, SpreadsABinomialAndMirrorsAtTheBorder) {
  Grid<float> map({5, 5});
  map.at(2, 2) = 16;
  map.at(0, 4) = 16;
  blur(map, 1);
  EXPECT_EQ(map.at(2, 2), 4.0F);
  EXPECT_EQ(map.at(1, 2), 2.0F);
  EXPECT_EQ(map.at(2, 1), 2.0F);
  EXPECT_EQ(map.at(3, 3), 1.0F);
  EXPECT_EQ(map.at(4, 2), 0.0F);
  EXPECT_EQ(map.at(0, 4), 9.0F);  // the mirrored half comes back
  EXPECT_EQ(map.at(1, 4), 3.0F);
}

TEST(Blur, KeepsConstantsAndSums) {
  for (const Extent size : {Extent{1, 1}, Extent{2, 1}, Extent{1, 7}, Extent{33, 20}}) {
    Grid<float> constant(size, 0.1F);
    blur(constant, 5);
    for (const float v : constant.cells()) ASSERT_EQ(v, 0.1F);
    Grid<float> random(size);
    double before = 0;
    for (std::size_t i = 0; i < size.area(); ++i) {
      random[i] = Rng(1, stream_id("blur test"), i).uniform();
      before += double{random[i]};
    }
    const std::vector<float> unblurred(random.cells().begin(), random.cells().end());
    blur(random, 0);
    EXPECT_TRUE(std::equal(unblurred.begin(), unblurred.end(), random.cells().begin()));
    blur(random, 4);
    double after = 0;
    for (const float v : random.cells()) after += double{v};
    EXPECT_NEAR(after, before, 1e-5 * before);
  }
}

}  // namespace
}  // namespace abn
