#include "sampling/adaptive/rank_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "sampling/rng.h"

namespace abn {
namespace {

std::vector<Vec2f> random_points(std::size_t count, Extent plane, std::uint64_t seed) {
  std::vector<Vec2f> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(to_plane(Rng(seed, stream_id("rank_order test"), i).uniform2(), plane));
  }
  return points;
}

double torus_distance(Vec2f a, Vec2f b, Extent plane) {
  double dx = std::abs(double{a.x} - double{b.x});
  double dy = std::abs(double{a.y} - double{b.y});
  dx = std::min(dx, plane.width - dx);
  dy = std::min(dy, plane.height - dy);
  return std::sqrt(dx * dx + dy * dy);
}

void expect_permutation(std::vector<std::uint32_t> order, std::size_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0U);
  std::sort(order.begin(), order.end());
  ASSERT_EQ(order, all);
}

// By measuring all distances: no point left was farther away than the one taken, but for the width of a class.
void expect_farthest_first(const std::vector<Vec2f>& points, Extent plane) {
  const auto order = farthest_first_order(points, plane, 1);
  expect_permutation(order, points.size());
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  for (const std::uint32_t chosen : order) {
    const double farthest = *std::max_element(distance.begin(), distance.end());
    if (farthest < std::numeric_limits<double>::infinity()) {
      ASSERT_GE(distance[chosen], farthest * 0.983 - 1e-5);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      distance[i] = std::min(distance[i], torus_distance(points[i], points[chosen], plane));
    }
    distance[chosen] = -1;
  }
}

TEST(FarthestFirstOrder, EveryPointIsTheFarthestLeft) {
  expect_farthest_first(random_points(1000, {20, 30}, 1), {20, 30});
  expect_farthest_first(random_points(500, {1, 200}, 2), {1, 200});
  expect_farthest_first(random_points(500, {300, 2}, 3), {300, 2});
  for (std::size_t count = 0; count < 20; ++count) expect_farthest_first(random_points(count, {5, 5}, count), {5, 5});
}

TEST(FarthestFirstOrder, CrowdedAndCoincidentPoints) {
  auto points = random_points(800, {50, 40}, 4);
  for (std::size_t i = 20; i < 700; ++i) points[i] = {41.0F + points[i].x / 50, points[i].y / 40};
  expect_farthest_first(points, {50, 40});
  for (std::size_t i = 100; i < 400; ++i) points[i] = {7.25F, 7.5F};
  const auto order = farthest_first_order(points, {50, 40}, 1);
  expect_permutation(order, points.size());
  // Of the coincident ones all but the first come last.
  const auto late = std::count_if(order.end() - 299, order.end(), [](std::uint32_t i) { return i >= 100 && i < 400; });
  EXPECT_EQ(late, 299);
}

TEST(FarthestFirstOrder, EquallyFarPointsAreTakenAllOver) {
  std::vector<Vec2f> points;
  for (int i = 0; i < 64 * 64; ++i) {
    points.push_back({static_cast<float>(i % 64) + 0.5F, static_cast<float>(i / 64) + 0.5F});
  }
  const auto order = farthest_first_order(points, {64, 64}, 1);
  for (const std::size_t k : {100, 1000, 3000}) {
    int quarter[4] = {};
    for (std::size_t i = 0; i < k; ++i)
      ++quarter[(points[order[i]].x < 32 ? 0 : 1) + (points[order[i]].y < 32 ? 0 : 2)];
    for (const int n : quarter) EXPECT_NEAR(n, static_cast<double>(k) / 4, 0.05 * static_cast<double>(k) + 8) << k;
  }
}

TEST(FarthestFirstOrder, IsOfTheSeed) {
  const auto points = random_points(500, {20, 30}, 5);
  EXPECT_EQ(farthest_first_order(points, {20, 30}, 7), farthest_first_order(points, {20, 30}, 7));
  EXPECT_NE(farthest_first_order(points, {20, 30}, 7), farthest_first_order(points, {20, 30}, 8));
}

}  // namespace
}  // namespace abn
