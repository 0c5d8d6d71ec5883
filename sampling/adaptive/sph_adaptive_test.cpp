#include "sampling/adaptive/sph_adaptive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "sampling/contract.h"
#include "sampling/draw_for_tests.h"
#include "sampling/sph_blue_noise.h"

namespace abn {
namespace {

using Image = std::function<float(Vec2f)>;

struct Played {
  std::vector<Vec2f> position;
  std::vector<float> value, weight;
  std::vector<std::size_t> batch;  // sizes
  std::vector<Diagnostic> diagnostics;
  std::vector<Vec2f> ghosts;
};

Played play(const SamplingTask& task, const Image& image, const ParameterWords& words = {}) {
  const Strategy strategy = row<SphAdaptive>();
  const auto sampler = strategy.make(task, words);
  const Grid<PixelStats> unused(task.plane);
  Played played;
  std::vector<float> last;
  for (;;) {
    const SampleBatch batch = sampler->next({unused, last});
    if (batch.empty()) break;
    last.clear();
    for (const Vec2f p : batch.position) last.push_back(image(p));
    played.position.insert(played.position.end(), batch.position.begin(), batch.position.end());
    played.value.insert(played.value.end(), last.begin(), last.end());
    played.weight.insert(played.weight.end(), batch.weight.begin(), batch.weight.end());
    played.batch.push_back(batch.position.size());
  }
  played.diagnostics = sampler->diagnostics();
  played.ghosts.assign(sampler->ghosts().begin(), sampler->ghosts().end());
  return played;
}

double diagnostic(const Played& played, const std::string& name) {
  for (const auto& d : played.diagnostics) {
    if (d.name == name) return d.value;
  }
  ADD_FAILURE() << "no diagnostic " << name;
  return 0;
}

double share_where(const Played& played, const std::function<bool(Vec2f)>& inside) {
  return static_cast<double>(std::count_if(played.position.begin(), played.position.end(), inside)) /
         static_cast<double>(played.position.size());
}

SamplingTask task_of(Extent plane, double spp, std::uint64_t seed = 1) {
  return {.plane = plane,
          .budget = static_cast<std::uint64_t>(spp * static_cast<double>(plane.area())),
          .seed = seed,
          .cache = false};
}

bool sorted_equal(std::vector<Vec2f> a, std::vector<Vec2f> b) {
  const auto before = [](Vec2f p, Vec2f q) { return p.x != q.x ? p.x < q.x : p.y < q.y; };
  std::sort(a.begin(), a.end(), before);
  std::sort(b.begin(), b.end(), before);
  return a == b;
}

const Image edge = [](Vec2f p) { return p.x + 0.2F * p.y > 17.3F ? 1.0F : 0.0F; };
const Image noise = [](Vec2f p) {
  return Rng(9, 1, (static_cast<std::uint64_t>(p.x * 7919) << 24U) + static_cast<std::uint64_t>(p.y * 7919)).uniform();
};

TEST(SphAdaptive, SpendsTheBudgetWhereTheImageVaries) {
  const Played played = play(task_of({32, 32}, 6), edge);
  ASSERT_EQ(played.position.size(), 6U * 32 * 32);
  // Uniform would be about 1/8 of the samples in a strip 4 px wide.
  EXPECT_GT(share_where(played, [](Vec2f p) { return std::abs(p.x + 0.2F * p.y - 17.3F) < 2; }), 0.45);
  EXPECT_EQ(diagnostic(played, "gated"), 0);
  EXPECT_EQ(diagnostic(played, "relaxed_passes"), 3);
  EXPECT_FALSE(played.ghosts.empty());
}

TEST(SphAdaptive, IsPlainBlueNoiseWhereThereIsNothingToAdaptTo) {
  for (const Image& image : {Image([](Vec2f) { return 0.25F; }), noise}) {
    const SamplingTask task = task_of({24, 20}, 6, 5);
    const Played played = play(task, image);
    EXPECT_EQ(diagnostic(played, "gated"), 1);
    EXPECT_TRUE(sorted_equal(played.position, draw<SphBlueNoise>(task.plane, task.budget, task.seed)));
  }
}

TEST(SphAdaptive, GatesTheMoreTheFewerSamplesThereAre) {
  // Noise whose amplitude differs the more the steeper it is: between all to adapt to and nothing.
  bool opened_later = false;
  for (const float steepness : {1.0F, 1.4F, 1.8F}) {
    const Image image = [&](Vec2f p) { return noise(p) * std::exp(-steepness * p.x / 32); };
    std::vector<double> gated;
    for (const double spp : {2.0, 4.0, 16.0}) {
      const Played played = play(task_of({32, 32}, spp), image);
      gated.push_back(diagnostic(played, "gated"));
      EXPECT_EQ(gated.back(), diagnostic(played, "uniform_share") > 0.87 - 0.12 / spp ? 1 : 0) << steepness;
    }
    opened_later |= gated.front() == 1 && gated.back() == 0;
  }
  EXPECT_TRUE(opened_later);
}

TEST(SphAdaptive, IsPlainBlueNoiseBelowTwoSamplesPerPixel) {
  const SamplingTask task = task_of({24, 20}, 1);
  EXPECT_TRUE(sorted_equal(play(task, edge).position, draw<SphBlueNoise>(task.plane, task.budget, task.seed)));
}

TEST(SphAdaptive, OneBrightSampleCannotEatTheBudget) {
  // A firefly of 10^6 in one pixel, a soft edge elsewhere, untransformed and tone-mapped.
  const Image firefly = [](Vec2f p) {
    if (p.x > 5 && p.x < 6 && p.y > 5 && p.y < 6) return 1e6F;
    return edge(p);
  };
  for (const char* tone : {"linear", "displayed", "both"}) {
    const Played played = play(task_of({32, 32}, 6), firefly, {{"tone", tone}});
    const double around =
        share_where(played, [](Vec2f p) { return std::abs(p.x - 5.5F) < 2 && std::abs(p.y - 5.5F) < 2; });
    EXPECT_LT(around, 0.26) << tone;  // 16 px^2 of 1024 at 16 times the mean density are a quarter
    if (std::string(tone) == "displayed") {
      EXPECT_GT(share_where(played, [](Vec2f p) { return std::abs(p.x + 0.2F * p.y - 17.3F) < 2; }), 0.3);
    }
  }
}

TEST(SphAdaptive, HighDynamicRangeFollowsDisplayAndLight) {
  SamplingTask task = task_of({32, 32}, 6);
  const Image lamp = [](Vec2f p) {
    if (p.x < 4 && p.y < 4) return 5000.0F * noise(p) + 1000;
    return edge(p);
  };
  const auto at_lamp = [](Vec2f p) { return p.x < 3 && p.y < 3; };  // its border is an edge in any light
  const auto at_edge = [](Vec2f p) { return std::abs(p.x + 0.2F * p.y - 17.3F) < 2; };
  const Played linear = play(task, lamp, {{"tone", "linear"}});
  const Played displayed = play(task, lamp, {{"tone", "displayed"}});
  task.high_dynamic_range = true;
  const Played both = play(task, lamp);
  EXPECT_GT(share_where(linear, at_lamp), 0.1);
  EXPECT_LT(share_where(displayed, at_lamp), 0.03);
  EXPECT_GT(share_where(both, at_lamp), 1.5 * share_where(displayed, at_lamp));
  EXPECT_GT(share_where(displayed, at_edge), 0.3);
  EXPECT_GT(share_where(both, at_edge), 0.8 * share_where(displayed, at_edge));
}

TEST(SphAdaptive, SaysWhichSamplesWereUniform) {
  const auto uniform_samples = [](SamplingTask task, const Image& image, const ParameterWords& words) {
    const auto sampler = row<SphAdaptive>().make(task, words);
    const Grid<PixelStats> unused(task.plane);
    std::vector<float> last;
    std::size_t first = 0;
    for (;;) {
      const SampleBatch batch = sampler->next({unused, last});
      if (batch.empty()) break;
      if (first == 0) first = batch.position.size();
      last.clear();
      for (const Vec2f p : batch.position) last.push_back(image(p));
    }
    const std::uint64_t said = sampler->uniform_samples();
    EXPECT_TRUE(said == 0 || said == first);
    return said;
  };
  SamplingTask task = task_of({24, 16}, 6);
  EXPECT_GT(uniform_samples(task, edge, {}), 0U);
  EXPECT_EQ(uniform_samples(task, edge, {{"calibrate", "false"}}), 0U);
  EXPECT_EQ(uniform_samples(task, edge, {{"unbiased", "true"}}), 0U);
  EXPECT_EQ(uniform_samples(task, noise, {}), 0U);  // gated: all are uniform
  task.high_dynamic_range = true;
  EXPECT_EQ(uniform_samples(task, edge, {}), 0U);
}

TEST(SphAdaptive, ColourCountsJointly) {
  // Red varies left, blue right: both halves are found, and the mean of the two channels varies nowhere.
  const SamplingTask task = task_of({32, 32}, 6);
  const auto sampler = row<SphAdaptive>().make(task, {{"refine", "never"}, {"gate", "1"}});
  const Grid<PixelStats> unused(task.plane);
  std::vector<float> last;
  std::vector<Vec2f> all;
  for (;;) {
    const SampleBatch batch = sampler->next({unused, last, 3});
    if (batch.empty()) break;
    last.clear();
    for (const Vec2f p : batch.position) {
      const float wave = std::sin(5 * p.x) * std::sin(5 * p.y);
      const bool varies = p.x < 8 || p.x > 24;
      last.insert(last.end(), {varies ? 0.5F + 0.3F * wave : 0.5F, 0.5F, varies ? 0.5F - 0.3F * wave : 0.5F});
      all.push_back(p);
    }
  }
  const auto outer = std::count_if(all.begin(), all.end(), [](Vec2f p) { return p.x < 8 || p.x > 24; });
  EXPECT_GT(static_cast<double>(outer) / static_cast<double>(all.size()), 0.7);
}

TEST(SphAdaptive, DriversFollowWhatTheySay) {
  SamplingTask task = task_of({32, 32}, 6);
  const Image bright_left = [](Vec2f p) { return p.x < 16 ? 0.8F : 0.1F; };
  const auto left = [](Vec2f p) { return p.x < 15; };
  EXPECT_GT(share_where(play(task, bright_left, {{"driver", "luminance"}, {"refine", "never"}, {"gate", "1"}}), left),
            0.55);
  const auto middle = [](Vec2f p) { return std::abs(p.x - 16) < 2; };
  EXPECT_GT(share_where(play(task, bright_left, {{"driver", "gradient"}, {"refine", "never"}}), middle), 0.3);
  auto guide = std::make_shared<Grid<float>>(Extent{8, 8}, 0.1F);
  for (std::uint32_t y = 4; y < 8; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) guide->at(x, y) = 10;
  }
  EXPECT_THROW(play(task, edge, {{"driver", "guide"}}), ConfigError);
  task.guide = guide;
  EXPECT_GT(
      share_where(play(task, [](Vec2f) { return 0.5F; }, {{"driver", "guide"}, {"refine", "never"}, {"gate", "1"}}),
                  [](Vec2f p) { return p.y > 16; }),
      0.7);
}

TEST(SphAdaptive, RefinementNeedsStraightEdges) {
  EXPECT_EQ(diagnostic(play(task_of({32, 32}, 6), edge), "refined_passes"), 2);
  const Image dots = [](Vec2f p) {
    if (p.x < 16) return 0.5F;
    return std::fmod(p.x * 2.3F, 1.0F) < 0.5F && std::fmod(p.y * 2.3F, 1.0F) < 0.5F ? 1.0F : 0.0F;
  };
  EXPECT_EQ(diagnostic(play(task_of({32, 32}, 6), dots), "refined_passes"), 0);
}

TEST(SphAdaptive, SmallStepsGrowByAThird) {
  SamplingTask task = task_of({16, 16}, 12);
  task.small_steps = true;
  const Played played = play(task, edge);
  EXPECT_EQ(played.position.size(), task.budget);
  EXPECT_EQ(played.batch.front(), 2U * 16 * 16);
  std::size_t there = 0;
  for (const std::size_t batch : played.batch) {
    if (there > 0) {
      EXPECT_LE(batch, std::max<std::size_t>(there / 3, 64));
    }
    there += batch;
  }
}

TEST(SphAdaptive, UnbiasedDiscardsItsPilotAndMeetsEveryPixel) {
  const SamplingTask task = task_of({16, 16}, 6);
  const Played played = play(task, edge, {{"unbiased", "true"}});
  ASSERT_EQ(played.weight.size(), task.budget);
  ASSERT_EQ(played.batch.size(), 2U);
  std::vector<int> kept(256, 0);
  for (std::size_t i = 0; i < played.position.size(); ++i) {
    EXPECT_EQ(played.weight[i], i < played.batch[0] ? 0.0F : 1.0F);
    if (i >= played.batch[0]) {
      ++kept[static_cast<std::size_t>(played.position[i].y) * 16 + static_cast<std::size_t>(played.position[i].x)];
    }
  }
  EXPECT_GE(*std::min_element(kept.begin(), kept.end()), 1);
  EXPECT_GT(*std::max_element(kept.begin(), kept.end()), 10);
  EXPECT_THROW(play(task_of({16, 16}, 1.5), edge, {{"unbiased", "true"}}), ConfigError);
}

TEST(SphAdaptive, HardValuesNeverReachAPosition) {
  for (const float bad : {std::nanf(""), INFINITY, -INFINITY, 3e38F, -3e38F}) {
    const Image image = [&](Vec2f p) { return p.x < 3 ? bad : edge(p); };
    for (const char* tone : {"linear", "displayed", "both"}) {
      const Played played = play(task_of({24, 16}, 4), image, {{"tone", tone}});
      for (const Vec2f p : played.position) ASSERT_TRUE(p.x >= 0 && p.x < 24 && p.y >= 0 && p.y < 16) << bad;
    }
  }
}

TEST(SphAdaptive, ContractHoldsWithEveryVariant) {
  for (const ParameterWords& words : std::vector<ParameterWords>{
           {}, {{"boundary", "periodic"}}, {{"refine", "always"}}, {{"unbiased", "true"}}, {{"passes", "1"}}}) {
    for (const auto& breach : contract_breaches(row<SphAdaptive>(), task_of({20, 12}, 5), words))
      ADD_FAILURE() << breach;
  }
}

}  // namespace
}  // namespace abn
