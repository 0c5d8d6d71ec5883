// What every filter importance strategy promises: the contract, and samples distributed as the filter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "sampling/contract.h"
#include "sampling/error.h"
#include "sampling/fis/fis_inversion.h"
#include "sampling/fis/fis_jitter.h"
#include "sampling/fis/fis_metropolis.h"
#include "sampling/fis/fis_rejection.h"
#include "sampling/fis/fis_sph.h"
#include "sampling/strategy.h"
#include "sampling/test_folder.h"

namespace abn {
namespace {

static_assert(StrategyClass<FisJitter>);
static_assert(StrategyClass<FisInversion>);
static_assert(StrategyClass<FisRejection>);
static_assert(StrategyClass<FisMetropolis>);
static_assert(StrategyClass<FisSph>);

/// A strategy with the words of one test.
struct Case {
  Strategy strategy;
  ParameterWords words;
  bool even = true;  // its samples are better than independent ones
};

std::vector<Case> cases() {
  return {
      {row<FisJitter>(), {}},
      {row<FisInversion>(), {}},
      {row<FisInversion>(), {{"set", "sobol_owen"}}},
      {row<FisInversion>(), {{"set", "cmj"}}},
      {row<FisInversion>(), {{"set", "multijitter"}}},
      {row<FisInversion>(), {{"set", "random"}}, false},
      {row<FisRejection>(), {}, false},
      {row<FisMetropolis>(), {}, false},
      {row<FisSph>(), {}},
      {row<FisSph>(), {{"kernel", "sph"}, {"assignment", "tiles"}}},
      {row<FisSph>(), {{"weights", "kriging"}, {"symmetry", "none"}, {"sets", "256"}}},
  };
}

std::string describe(const Case& c) {
  std::string words = c.strategy.info.name;
  for (const auto& entry : c.words) words += " " + entry.first + "=" + entry.second;
  return words;
}

SamplingTask task_of(Extent plane, std::uint64_t budget, const std::string& filter, std::uint64_t seed = 1) {
  SamplingTask task{.plane = plane, .budget = budget, .seed = seed};
  task.filter = filter.empty() ? nullptr : make_filter(filter);
  task.cache = false;
  return task;
}

TEST(FilterImportance, KeepsTheContract) {
  struct Size {
    Extent plane;
    std::uint64_t budget;
  };
  for (const Case& c : cases()) {
    for (const Size& size : {Size{{1, 1}, 1}, Size{{7, 5}, 12}, Size{{7, 5}, 35 * 4 + 11}}) {
      const auto task = task_of(size.plane, size.budget, size.budget == 12 ? "" : "gaussian");
      ParameterWords words = c.words;
      if (c.strategy.info.name == "fis_sph") words["iterations"] = "40";
      const auto breaches = contract_breaches(c.strategy, task, words);
      EXPECT_TRUE(breaches.empty()) << describe(c) << ", budget " << size.budget << ": "
                                    << (breaches.empty() ? "" : breaches.front());
    }
  }
}

TEST(FilterImportance, CountsPerPixelDifferByAtMostOne) {
  for (const Case& c : cases()) {
    ParameterWords words = c.words;
    if (c.strategy.info.name == "fis_sph") words["iterations"] = "10";
    const auto set = draw_all(c.strategy, task_of({9, 7}, 63 * 3 + 20, "triangle"), words);
    ASSERT_EQ(set.pixel.size(), 63U * 3 + 20);
    EXPECT_TRUE(std::is_sorted(set.pixel.begin(), set.pixel.end()));
    std::vector<int> count(63);
    for (const std::uint32_t pixel : set.pixel) ++count[pixel];
    EXPECT_EQ(std::count(count.begin(), count.end(), 4), 20) << describe(c);
    EXPECT_EQ(std::count(count.begin(), count.end(), 3), 43) << describe(c);
  }
}

TEST(FilterImportance, ManySamplesOfOnePixel) {
  for (const Case& c : cases()) {
    ParameterWords words = c.words;
    if (c.strategy.info.name == "fis_sph") words["iterations"] = "4";
    const auto set = draw_all(c.strategy, task_of({1, 1}, 1000, "gaussian"), words);
    EXPECT_EQ(set.position.size(), 1000U) << describe(c);
  }
}

/// Numbers of the samples under the filter, weights included.
struct Moments {
  double x = 0, y = 0, second = 0, marginal_ks = 0, radial_ks = 0;
};

double distance(std::vector<std::pair<float, double>> shares) {
  std::sort(shares.begin(), shares.end());
  double total = 0;
  for (const auto& share : shares) total += share.second;
  double below = 0;
  double greatest = 0;
  for (const auto& share : shares) {
    greatest = std::max(greatest, std::abs(below / total - static_cast<double>(share.first)));
    below += share.second;
    greatest = std::max(greatest, std::abs(below / total - static_cast<double>(share.first)));
  }
  return greatest;
}

Moments moments(const PointSet& set, Extent plane, const FilterDensity& density) {
  std::vector<std::pair<float, double>> radial;
  std::vector<std::pair<float, double>> marginal;
  Moments m;
  double total = 0;
  for (std::size_t i = 0; i < set.position.size(); ++i) {
    const float x = set.position[i].x - (static_cast<float>(set.pixel[i] % plane.width) + 0.5F);
    const float y = set.position[i].y - (static_cast<float>(set.pixel[i] / plane.width) + 0.5F);
    const double w = set.weight.empty() ? 1.0 : static_cast<double>(set.weight[i]);
    m.x += w * static_cast<double>(x);
    m.y += w * static_cast<double>(y);
    m.second += w * static_cast<double>(x * x + y * y);
    total += w;
    radial.emplace_back(density.radial(std::sqrt(x * x + y * y)), w);
    marginal.emplace_back(density.marginal(x), w);
    marginal.emplace_back(density.marginal(y), w);
  }
  m.x /= total;
  m.y /= total;
  m.second /= total;
  m.radial_ks = distance(std::move(radial));
  m.marginal_ks = distance(std::move(marginal));
  return m;
}

// Independent samples: standard error of the centre .7 / sqrt(40 000) = .0035, KS below 1.63 / sqrt(40 000) = .008 in
// 99 of 100 cases; the states of a chain count for a tenth.
TEST(FilterImportance, SamplesAreDistributedAsTheFilter) {
  const Extent plane{80, 50};
  for (const std::string filter : {"gaussian", "", "gaussian:radius=1,support=disc"}) {
    for (const Case& c : cases()) {
      if (!c.words.empty() && filter != "gaussian") continue;
      const auto task = task_of(plane, plane.area() * 10, filter);
      const FilterDensity density(task.filter, "test");
      const auto set = draw_all(c.strategy, task, c.words);
      const Moments m = moments(set, plane, density);
      const std::string what = describe(c) + " " + filter;
      const bool sph = c.strategy.info.name == "fis_sph";
      const double spread = c.strategy.info.name == "fis_metropolis" ? 3 : 1;
      EXPECT_LT(std::abs(m.x), 0.012 * spread) << what;
      EXPECT_LT(std::abs(m.y), 0.012 * spread) << what;
      EXPECT_NEAR(m.second / density.second_moment(), 1, sph ? 0.05 : 0.015 * spread) << what;
      EXPECT_LT(m.radial_ks, sph ? 0.05 : 0.009 * spread) << what;
      EXPECT_LT(m.marginal_ks, sph ? 0.04 : 0.009 * spread) << what;
    }
  }
}

TEST(FilterImportance, DiagnosticsTellTheTruth) {
  const Extent plane{60, 40};
  for (const Case& c : cases()) {
    ParameterWords words = c.words;
    if (c.strategy.info.name == "fis_sph") words["iterations"] = "20";
    const auto task = task_of(plane, plane.area() * 10, "gaussian");
    const FilterDensity density(task.filter, "test");
    const auto set = draw_all(c.strategy, task, words);
    const Moments m = moments(set, plane, density);
    const auto sampler = c.strategy.make(task, words);
    const Grid<PixelStats> none;
    EXPECT_TRUE(sampler->diagnostics().empty());
    while (!sampler->next({none}).empty()) {
    }
    double second = -1;
    double ks = -1;
    for (const Diagnostic& d : sampler->diagnostics()) {
      if (d.name == "filter_second_moment_error") second = d.value;
      if (d.name == "filter_ks") ks = d.value;
    }
    EXPECT_NEAR(second, m.second / density.second_moment() - 1, 1e-4) << describe(c);
    EXPECT_NEAR(ks, m.radial_ks, 0.002) << describe(c);
  }
}

/// Mean squared error of every pixel's estimate of a function whose mean under the filter is 0.
template <class Function>
double error_of(const PointSet& set, Extent plane, const Function& g) {
  std::vector<double> sum(plane.area());
  std::vector<double> weight(plane.area());
  for (std::size_t i = 0; i < set.position.size(); ++i) {
    const std::uint32_t pixel = set.pixel[i];
    const double w = set.weight.empty() ? 1.0 : static_cast<double>(set.weight[i]);
    sum[pixel] += w * g(static_cast<double>(set.position[i].x - (static_cast<float>(pixel % plane.width) + 0.5F)),
                        static_cast<double>(set.position[i].y - (static_cast<float>(pixel / plane.width) + 0.5F)));
    weight[pixel] += w;
  }
  double error = 0;
  for (std::size_t p = 0; p < sum.size(); ++p) error += sum[p] / weight[p] * (sum[p] / weight[p]);
  return error / static_cast<double>(sum.size());
}

// Edges through a pixel: the evener the set under the filter, the smaller the error. Random samples have E = v / 10.
TEST(FilterImportance, EvenSetsBeatIndependentSamplesOnEdges) {
  const Extent plane{60, 40};
  const auto task = task_of(plane, plane.area() * 10, "gaussian");
  const auto edge_error = [&](const Case& c) {
    const auto set = draw_all(c.strategy, task, c.words);
    double error = 0;
    for (int k = 0; k < 8; ++k) {
      const double angle = 0.3 + 3.14159265 * k / 8;
      error += error_of(set, plane,
                        [&](double x, double y) { return x * std::cos(angle) + y * std::sin(angle) > 0 ? 0.5 : -0.5; });
    }
    return error / 8;
  };
  double inversion = 0;
  for (const Case& c : cases()) {
    const double error = edge_error(c);
    if (c.strategy.info.name == "fis_inversion" && c.words.empty()) inversion = error;
    if (c.even) {
      EXPECT_LT(error, 0.55 * 0.025) << describe(c);
    } else {
      EXPECT_GT(error, 0.9 * 0.025) << describe(c);
    }
    if (c.strategy.info.name == "fis_sph") {
      EXPECT_LT(error, 0.85 * inversion) << describe(c);
    }
  }
}

TEST(FilterImportance, BoxSamplesStayInTheirPixel) {
  for (const Case& c : cases()) {
    ParameterWords words = c.words;
    if (c.strategy.info.name == "fis_sph") words["iterations"] = "40";
    const auto set = draw_all(c.strategy, task_of({40, 30}, 1200 * 4, ""), words);
    for (std::size_t i = 0; i < set.position.size(); ++i) {
      const auto x = static_cast<float>(set.pixel[i] % 40);
      const auto y = static_cast<float>(set.pixel[i] / 40);
      ASSERT_TRUE(set.position[i].x >= x && set.position[i].x < x + 1) << describe(c);
      ASSERT_TRUE(set.position[i].y >= y && set.position[i].y < y + 1) << describe(c);
    }
  }
}

TEST(FilterImportance, NegativeLobesAreRefusedWithARemedy) {
  for (const Case& c : cases()) {
    for (const char* filter : {"mitchell", "lanczos"}) {
      try {
        c.strategy.make(task_of({4, 4}, 16, filter), c.words);
        FAIL() << describe(c);
      } catch (const ConfigError& error) {
        EXPECT_NE(std::string(error.what()).find("share"), std::string::npos) << error.what();
      }
    }
  }
}

TEST(FilterImportance, BadWordsAreRefused) {
  const auto square = task_of({4, 4}, 16, "gaussian");
  const auto disc = task_of({4, 4}, 16, "gaussian:support=disc");
  EXPECT_THROW(FisInversion(square, {.method = "box_muller"}), ConfigError);
  EXPECT_THROW(FisInversion(disc, {.method = "separable"}), ConfigError);
  EXPECT_NO_THROW(FisInversion(disc, {.method = "box_muller"}));
  EXPECT_THROW(FisSph(square, {.symmetry = "rotation"}), ConfigError);
  EXPECT_NO_THROW(FisSph(disc, {.symmetry = "rotation"}));
  EXPECT_THROW(FisJitter(task_of({1, 1}, std::uint64_t{1} << 40, "gaussian"), {}), ConfigError);
}

// The chain is over f, but its states repeat: that is what the strategy says of itself.
TEST(FisMetropolis, IsCorrelatedAndSaysSo) {
  const auto strategy = row<FisMetropolis>();
  const auto set = draw_all(strategy, task_of({20, 20}, 4000, "gaussian"), {});
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < set.position.size(); ++i) repeated += set.position[i] == set.position[i - 1] ? 1 : 0;
  EXPECT_GT(repeated, 800U);
}

TEST(FisSph, SecondRunTakesTheBankFromTheDisk) {
  const TestFolder folder;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
  FisSph::Params params;
  params.iterations = 20;
  auto task = task_of({20, 20}, 4400, "gaussian");  // 11 samples per pixel
  const auto draw_and_tell = [&](bool& cached) {
    FisSph sampler(task, params);
    const Grid<PixelStats> none;
    const SampleBatch batch = sampler.next({none});
    cached = sampler.cached();
    return std::vector<Vec2f>(batch.position.begin(), batch.position.end());
  };
  bool cached = true;
  const auto uncached_points = draw_and_tell(cached);
  EXPECT_FALSE(cached);
  task.cache = true;
  EXPECT_EQ(draw_and_tell(cached), uncached_points);
  EXPECT_FALSE(cached);
  EXPECT_EQ(draw_and_tell(cached), uncached_points);
  EXPECT_TRUE(cached);
  params.axis_weight = 0.01;  // another bank
  draw_and_tell(cached);
  EXPECT_FALSE(cached);
  if (before == nullptr) {
    unsetenv("XDG_CACHE_HOME");
  } else {
    setenv("XDG_CACHE_HOME", kept.c_str(), 1);
  }
}

TEST(FisSph, TilesUseEverySetOnce) {
  FisSph::Params params;
  params.assignment = "tiles";
  params.symmetry = "none";
  params.iterations = 20;
  FisSph sampler(task_of({32, 16}, 512 * 2, "gaussian"), params);
  const Grid<PixelStats> none;
  const SampleBatch batch = sampler.next({none});
  std::vector<Vec2f> first;
  for (std::size_t p = 0; p < 512; ++p) {
    const Vec2f corner{static_cast<float>(p % 32), static_cast<float>(p / 32)};
    first.push_back(batch.position[2 * p] - corner);
  }
  // Positions are rounded to the plane's floats: equal sets would agree to 1e-5.
  std::sort(first.begin(), first.end(), [](Vec2f a, Vec2f b) { return a.x < b.x; });
  std::size_t close = 0;  // equal
  for (std::size_t i = 1; i < first.size(); ++i) {
    close += std::abs(first[i].x - first[i - 1].x) < 1e-5F && std::abs(first[i].y - first[i - 1].y) < 1e-5F ? 1 : 0;
  }
  EXPECT_EQ(close, 0U);
}

}  // namespace
}  // namespace abn
