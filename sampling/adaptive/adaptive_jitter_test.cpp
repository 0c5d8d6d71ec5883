#include "sampling/adaptive/adaptive_jitter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "sampling/contract.h"
#include "sampling/draw_for_tests.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

static_assert(StrategyClass<AdaptiveJitter>);

using Image = std::function<float(Vec2f)>;

/// Samples of every pixel in their order.
std::vector<std::vector<Vec2f>> run(const SamplingTask& task, const AdaptiveJitter::Params& params, const Image& image,
                                    std::size_t* batches = nullptr) {
  AdaptiveJitter sampler(task, params);
  Grid<PixelStats> pixels(task.plane);
  std::vector<Vec2f> all;
  std::vector<float> values;
  for (;;) {
    const SampleBatch batch = sampler.next({pixels, values});
    if (batch.empty()) break;
    if (batches != nullptr) ++*batches;
    EXPECT_LE(batch.position.size(), std::size_t{1} << 20);
    values.clear();
    for (const Vec2f p : batch.position) {
      values.push_back(image(p));
      pixels[static_cast<std::size_t>(p.y) * task.plane.width + static_cast<std::size_t>(p.x)].add(values.back());
      all.push_back(p);
    }
    EXPECT_LE(all.size(), task.budget);
    if (all.size() > task.budget) break;
  }
  EXPECT_EQ(all.size(), task.budget);
  return by_pixel(all, task.plane);
}

constexpr Extent plane{24, 20};

SamplingTask task_of(std::uint64_t budget, Extent extent = plane) {
  return {.plane = extent, .budget = budget, .seed = 5};
}

float flat(Vec2f) { return 0.5F; }

/// A fair coin of 0 and `high`, by the place.
float coin(Vec2f p, float high) {
  const auto place = static_cast<std::uint64_t>(p.x * 65536) * 1000003 + static_cast<std::uint64_t>(p.y * 65536);
  return Rng(7, 1, place).uniform() < 0.5F ? 0.0F : high;
}

/// The strategy with its parameters given.
Strategy row_with(const AdaptiveJitter::Params& params) {
  Strategy strategy;
  strategy.info = AdaptiveJitter::info;
  strategy.make = [params](const SamplingTask& task, const ParameterWords&) -> std::unique_ptr<Sampler> {
    return std::make_unique<AdaptiveJitter>(task, params);
  };
  return strategy;
}

TEST(AdaptiveJitter, KeepsTheContract) {
  const std::vector<std::string> none;
  for (const std::uint64_t budget : {1U, 7U, 479U, 480U, 481U, 959U, 961U, 2880U, 2881U, 40000U}) {
    EXPECT_EQ(contract_breaches(row_with({}), task_of(budget)), none) << budget;
  }
  EXPECT_EQ(contract_breaches(row_with({}), task_of(1000, {1, 1})), none);
  EXPECT_EQ(contract_breaches(row_with({.base_share = 0, .rounds = 1000}), task_of(2881)), none);
  EXPECT_EQ(contract_breaches(row_with({.base_share = 1}), task_of(2881)), none);
  EXPECT_EQ(contract_breaches(row_with({.most_samples_per_pixel = 6}), task_of(2880)), none);
}

TEST(AdaptiveJitter, AConstantImageGetsTheSameEverywhere) {
  for (const auto& pixel : run(task_of(6 * plane.area()), {}, flat)) EXPECT_EQ(pixel.size(), 6U);
}

TEST(AdaptiveJitter, SamplesFollowTheVariance) {
  // Three stripes with standard deviations 0, 1/2 and 1: V / n equal means n in the ratio 1 : 4 beyond the equal base.
  const auto image = [](Vec2f p) { return p.x < 8 ? 0.5F : coin(p, p.x < 16 ? 1.0F : 2.0F); };
  const auto pixels = run(task_of(16 * plane.area()), {.base_share = 0.25, .rounds = 8}, image);
  double stripe[3] = {};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::size_t x = i % plane.width;
    const bool inner = x % 8 >= 2 && x % 8 < 6;  // beside a border the neighbour's variance counts
    EXPECT_GE(pixels[i].size(), 4U);
    if (inner) stripe[x / 8] += static_cast<double>(pixels[i].size()) / (4.0 * plane.height);
  }
  EXPECT_LT(stripe[0], 4.5);
  EXPECT_GT(stripe[1], 6.0);
  EXPECT_NEAR(stripe[2] / stripe[1], 4, 0.8);
}

TEST(AdaptiveJitter, NeighboursShareWhatOnePixelSaw) {
  const auto image = [](Vec2f p) { return p.x >= 12 && p.x < 13 && p.y >= 10 && p.y < 11 ? coin(p, 1.0F) : 0.5F; };
  const auto alone = run(task_of(6 * plane.area()), {.most_samples_per_pixel = 50, .neighbourhood = 0}, image);
  const auto shared = run(task_of(6 * plane.area()), {.most_samples_per_pixel = 50, .neighbourhood = 1}, image);
  EXPECT_EQ(alone[10 * 24 + 12].size(), 50U);
  EXPECT_LE(alone[10 * 24 + 13].size(), 7U);
  for (std::size_t y = 9; y <= 11; ++y) {
    for (std::size_t x = 11; x <= 13; ++x) EXPECT_EQ(shared[y * 24 + x].size(), 50U) << x << " " << y;
  }
  EXPECT_LE(shared[10 * 24 + 15].size(), 7U);
}

TEST(AdaptiveJitter, APixelsSamplesStayStratifiedHoweverManyCame) {
  const auto pixels = run(task_of(12 * plane.area()), {}, [](Vec2f p) { return coin(p, p.x); });
  std::size_t largest = 0;
  for (const auto& pixel : pixels) {
    largest = std::max(largest, pixel.size());
    for (unsigned m = 1; std::size_t{1} << m <= pixel.size(); ++m) {
      EXPECT_TRUE(is_zero_net({pixel.begin(), pixel.begin() + (std::ptrdiff_t{1} << m)}, m));
    }
  }
  EXPECT_GE(largest, 24U);
}

TEST(AdaptiveJitter, AFireflyTakesNoMoreThanTheCap) {
  const float inf = std::numeric_limits<float>::infinity();
  for (const float value : {1e4F, 3e38F, inf, std::nanf("")}) {
    const auto image = [&](Vec2f p) { return p.x >= 3 && p.x < 4 && p.y < 1 && p.x < 3.5F ? value : 0.5F; };
    const auto pixels = run(task_of(6 * plane.area()), {.neighbourhood = 0}, image);
    EXPECT_LE(pixels[3].size(), 96U) << value;  // 16 times the mean
    EXPECT_GT(pixels[3].size(), 12U) << value;
    for (const auto& pixel : pixels) EXPECT_GE(pixel.size(), 3U);
  }
}

TEST(AdaptiveJitter, AllFeedbackWildStillSpendsTheBudget) {
  const std::vector<float> wild = {std::nanf(""), std::numeric_limits<float>::infinity(), 3e38F, -3e38F, 1e-40F, 0.0F};
  std::size_t at = 0;
  run(task_of(3000, {12, 10}), {}, [&](Vec2f) { return wild[at++ % wild.size()]; });
}

TEST(AdaptiveJitter, TheCapMustHoldTheBudget) {
  EXPECT_THROW(AdaptiveJitter(task_of(6 * plane.area() + 1), {.most_samples_per_pixel = 6}), ConfigError);
  for (const auto& pixel : run(task_of(6 * plane.area()), {.most_samples_per_pixel = 6}, [](Vec2f p) { return p.x; })) {
    EXPECT_EQ(pixel.size(), 6U);
  }
}

TEST(AdaptiveJitter, LargeBudgetsComeInBatchesOfAtMostAMillion) {
  std::size_t batches = 0;
  run(task_of(3'000'001, {2, 1}), {.rounds = 1}, flat, &batches);
  EXPECT_GE(batches, 4U);
}

}  // namespace
}  // namespace abn
