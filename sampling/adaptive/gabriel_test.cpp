#include "sampling/adaptive/gabriel.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
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
    Rng rng(seed, stream_id("gabriel test"), i);
    samples.position.push_back(to_plane(rng.uniform2(), plane));
    for (std::uint32_t c = 0; c < channels; ++c) samples.value.push_back(rng.uniform());
  }
  return samples;
}

double squared(Vec2f a, Vec2f b) {
  const double dx = double{a.x} - double{b.x};
  const double dy = double{a.y} - double{b.y};
  return dx * dx + dy * dy;
}

/// Midpoints by the definitions, in O(n^3) and double: every pair, every other sample.
std::vector<Vec2f> twin(const Samples& samples, std::uint32_t channels, const GabrielOptions& options,
                        std::size_t wanted) {
  const auto& p = samples.position;
  const std::size_t n = p.size();
  const auto difference = [&](std::size_t i, std::size_t j) {
    double sum = 0;
    for (std::uint32_t c = 0; c < channels; ++c) {
      sum += std::pow(double{samples.value[i * channels + c]} - double{samples.value[j * channels + c]}, 2);
    }
    return std::sqrt(sum / channels);
  };
  double variance = 0;
  for (std::uint32_t c = 0; c < channels; ++c) {
    double mean = 0;
    for (std::size_t i = 0; i < n; ++i) mean += double{samples.value[i * channels + c]} / static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i) {
      variance += std::pow(double{samples.value[i * channels + c]} - mean, 2) / static_cast<double>(n) / channels;
    }
  }
  const auto is_neighbour = [&](std::size_t i, std::size_t j) {  // j of i
    int nearer = 0;
    for (std::size_t k = 0; k < n; ++k) nearer += k != i && squared(p[i], p[k]) < squared(p[i], p[j]) ? 1 : 0;
    return nearer < options.neighbours;
  };
  struct Edge {
    std::size_t i, j;
  };
  std::vector<Edge> edges;
  std::vector<double> activity(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double length_squared = squared(p[i], p[j]);
      bool empty = true;
      for (std::size_t k = 0; k < n && empty; ++k) {
        const double x = (double{p[i].x} + double{p[j].x}) / 2 - double{p[k].x};
        const double y = (double{p[i].y} + double{p[j].y}) / 2 - double{p[k].y};
        empty = k == i || k == j || x * x + y * y >= 0.999 * length_squared / 4;
      }
      const bool of_i = is_neighbour(i, j);
      const bool of_j = is_neighbour(j, i);
      if (!empty || !(of_i || of_j)) continue;
      if (of_i) activity[i] = std::max(activity[i], difference(i, j));
      if (of_j) activity[j] = std::max(activity[j], difference(i, j));
      if (length_squared >= options.min_length * options.min_length) edges.push_back({i, j});
    }
  }
  std::vector<std::pair<double, Vec2f>> ranked;
  for (const Edge& e : edges) {
    const double contrast = std::max(difference(e.i, e.j), options.activity * std::min(activity[e.i], activity[e.j]));
    const double urgency = (contrast + options.floor * std::sqrt(variance)) *
                           std::pow(squared(p[e.i], p[e.j]), options.length_exponent / 2);
    ranked.push_back({-urgency, (p[e.i] + p[e.j]) * 0.5F});
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  ranked.resize(std::min(wanted, ranked.size()));
  std::vector<Vec2f> midpoints;
  for (const auto& entry : ranked) midpoints.push_back(entry.second);
  return midpoints;
}

void expect_twin(const Samples& samples, std::uint32_t channels, Extent plane, GabrielOptions options,
                 std::size_t wanted) {
  options.jitter = 0;
  const auto expected = twin(samples, channels, options, wanted);
  const auto found = gabriel_midpoints(samples.position, samples.value, channels, plane, wanted, 1, options);
  ASSERT_EQ(found.position.size(), wanted);
  ASSERT_EQ(found.pairs, expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_EQ(found.position[k], expected[k]) << k;
}

TEST(GabrielMidpoints, AreThoseOfTheDefinition) {
  expect_twin(random_samples(200, 1, {10, 10}, 1), 1, {10, 10}, {}, 60);
  expect_twin(random_samples(200, 3, {10, 10}, 2), 3, {10, 10}, {}, 1000);  // all pairs
  expect_twin(random_samples(200, 1, {2, 90}, 3), 1, {2, 90}, {.neighbours = 4}, 100);
  expect_twin(random_samples(150, 3, {100, 1}, 4), 3, {100, 1}, {.min_length = 0.4, .activity = 0.5}, 90);
  expect_twin(random_samples(200, 1, {10, 10}, 5), 1, {10, 10}, {.floor = 0.5, .length_exponent = 1}, 60);
  expect_twin(random_samples(2, 1, {10, 10}, 6), 1, {10, 10}, {}, 5);
}

TEST(GabrielMidpoints, OfCrowdedSamples) {
  Samples samples = random_samples(200, 1, {50, 40}, 5);
  for (std::size_t i = 30; i < 200; ++i)
    samples.position[i] = {40.0F + samples.position[i].x / 10, samples.position[i].y / 20};
  expect_twin(samples, 1, {50, 40}, {}, 1000);
}

// The first midpoints of a step lie at the step, and a second pass closes in on it.
TEST(GabrielMidpoints, CloseInOnAStraightEdge) {
  const Extent plane{20, 20};
  Samples samples = random_samples(2000, 1, plane, 7);
  const auto side = [](Vec2f p) { return (0.8F * (p.x - 10) + 0.6F * (p.y - 9)); };  // distance from the edge [px]
  for (std::size_t i = 0; i < samples.value.size(); ++i) samples.value[i] = side(samples.position[i]) < 0 ? 0.1F : 0.9F;
  double mean[3] = {};
  for (int pass = 0; pass < 3; ++pass) {
    const auto midpoints =
        gabriel_midpoints(samples.position, samples.value, 1, plane, 60, static_cast<std::uint64_t>(pass) + 1);
    ASSERT_EQ(midpoints.pairs, 60U);
    for (const Vec2f p : midpoints.position) {
      EXPECT_LT(std::abs(side(p)), 1.0F);  // the widest gaps of 2000 random points are 1 px
      mean[pass] += double{std::abs(side(p))} / 60;
      samples.position.push_back(p);
      samples.value.push_back(side(p) < 0 ? 0.1F : 0.9F);
    }
  }
  EXPECT_LT(mean[0], 0.2);
  EXPECT_LT(mean[1], 0.85 * mean[0]);
  EXPECT_LT(mean[2], 0.9 * mean[1]);
}

TEST(GabrielMidpoints, NothingToSeeFillsTheWidestGaps) {
  const Extent plane{12, 12};
  Samples samples = random_samples(500, 1, plane, 8);
  std::fill(samples.value.begin(), samples.value.end(), 0.25F);
  const auto midpoints = gabriel_midpoints(samples.position, samples.value, 1, plane, 20, 1);
  double nearest_of_all = 1e9;
  for (const Vec2f m : midpoints.position) {
    double nearest = 1e9;
    for (const Vec2f p : samples.position) nearest = std::min(nearest, std::sqrt(squared(m, p)));
    nearest_of_all = std::min(nearest_of_all, nearest);
  }
  EXPECT_GT(nearest_of_all, 0.4);  // mean distance of neighbours: .27 px
}

// On a lattice all pairs are equally urgent: the chosen ones must lie all over the plane.
TEST(GabrielMidpoints, EquallyUrgentPairsAreChosenAllOver) {
  Samples samples;
  for (int i = 0; i < 1600; ++i) {
    samples.position.push_back({static_cast<float>(i % 40) + 0.5F, static_cast<float>(i / 40) + 0.5F});
    samples.value.push_back(1.0F);
  }
  const auto midpoints = gabriel_midpoints(samples.position, samples.value, 1, {40, 40}, 400, 1);
  ASSERT_EQ(midpoints.pairs, 400U);
  int quarter[4] = {};
  for (const Vec2f p : midpoints.position) ++quarter[(p.x < 20 ? 0 : 1) + (p.y < 20 ? 0 : 2)];
  for (const int n : quarter) EXPECT_NEAR(n, 100, 35);
}

TEST(GabrielMidpoints, TooFewPairsLeaveTheRestRandom) {
  const Extent plane{30, 20};
  for (const std::size_t count : {0, 1, 2, 3, 12}) {
    const Samples samples = random_samples(count, 3, plane, 9);
    const auto midpoints = gabriel_midpoints(samples.position, samples.value, 3, plane, 500, 1);
    ASSERT_EQ(midpoints.position.size(), 500U);
    EXPECT_LE(midpoints.pairs, 3 * count);
    EXPECT_EQ(midpoints.pairs == 0, count < 2);
    double x = 0;
    for (const Vec2f p : midpoints.position) {
      ASSERT_TRUE(p.x >= 0 && p.x < 30 && p.y >= 0 && p.y < 20);
      x += double{p.x} / 500;
    }
    EXPECT_NEAR(x, 15, 2);
  }
  EXPECT_TRUE(gabriel_midpoints({}, {}, 1, plane, 0, 1).position.empty());
}

TEST(GabrielMidpoints, CoincidentAndHugeAndBorderSamples) {
  const Extent plane{4, 4};
  Samples samples = random_samples(300, 1, plane, 10);
  for (std::size_t i = 0; i < 40; ++i) samples.position[i] = {1.5F, 1.5F};
  for (std::size_t i = 40; i < 80; ++i) samples.position[i].x = just_below(4.0F);
  for (std::size_t i = 80; i < 120; ++i) samples.position[i].y = 0;
  for (std::size_t i = 0; i < 300; i += 7) samples.value[i] = i % 2 == 0 ? 3e38F : -3e38F;
  const auto midpoints = gabriel_midpoints(samples.position, samples.value, 1, plane, 400, 1, {.jitter = 0.5});
  EXPECT_GT(midpoints.pairs, 300U);
  for (const Vec2f p : midpoints.position) ASSERT_TRUE(p.x >= 0 && p.x < 4 && p.y >= 0 && p.y < 4);
}

TEST(GabrielMidpoints, JitterIsSmallAndOfTheSeed) {
  const Samples samples = random_samples(1000, 1, {20, 20}, 11);
  const auto exact = gabriel_midpoints(samples.position, samples.value, 1, {20, 20}, 100, 1, {.jitter = 0});
  const auto first = gabriel_midpoints(samples.position, samples.value, 1, {20, 20}, 100, 1);
  const auto again = gabriel_midpoints(samples.position, samples.value, 1, {20, 20}, 100, 1);
  const auto other = gabriel_midpoints(samples.position, samples.value, 1, {20, 20}, 100, 2);
  EXPECT_EQ(first.position, again.position);
  EXPECT_NE(first.position, other.position);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_LE(std::abs(first.position[k].x - exact.position[k].x), 0.00151F);
    EXPECT_LE(std::abs(first.position[k].y - exact.position[k].y), 0.00151F);
  }
  EXPECT_NE(first.position, exact.position);
}

TEST(GabrielMidpoints, SameForAnyNumberOfThreads) {
  const Samples samples = random_samples(30'000, 3, {70, 60}, 12);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = gabriel_midpoints(samples.position, samples.value, 3, {70, 60}, 3000, 1);
  omp_set_num_threads(3);
  const auto three = gabriel_midpoints(samples.position, samples.value, 3, {70, 60}, 3000, 1);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.position, three.position);
}

}  // namespace
}  // namespace abn
