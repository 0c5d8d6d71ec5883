// The bars that sph_blue_noise is held to, on the means of five seeds, with every other parameter at its default.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sampling/analysis/axis_power.h"
#include "sampling/analysis/integration_error.h"
#include "sampling/analysis/pair_correlation.h"
#include "sampling/analysis/radial_profile.h"
#include "sampling/analysis/spacing.h"
#include "sampling/blue_noise_test.h"
#include "sampling/strategy.h"

namespace abn::analysis {
namespace {

constexpr int seeds = 5;

struct Quality {
  double relative_radius = 0, mean_nearest = 0, half_planes = 0, axis_power = 0;  // means over the seeds
  double effective_nyquist = 0, low_power = 0;
};

Quality quality_of(const std::string& strategy, Extent plane, std::uint64_t count, const ParameterWords& words = {}) {
  Quality quality;
  RadialAverage spectrum;
  std::vector<PairCorrelation> correlations;
  // Above this the exact spectrum takes minutes; the pair correlation's is then the measure.
  const bool exact_spectrum = count <= 20000;
  for (int seed = 1; seed <= seeds; ++seed) {
    ParameterWords given = words;
    const auto sampler = find_strategy(strategy, given)
                             .make({.plane = plane, .budget = count, .seed = static_cast<std::uint64_t>(seed)}, given);
    const auto points = to_unit(all_positions(*sampler), plane);
    EXPECT_EQ(points.size(), count);
    const Spacing distances = spacing(points);
    quality.relative_radius += distances.smallest / seeds;
    quality.mean_nearest += distances.mean / seeds;
    quality.half_planes += integration_error(points).half_planes / seeds;
    quality.axis_power += axis_power(points).largest / seeds;
    if (exact_spectrum) {
      spectrum.add(Periodogram(points, static_cast<int>(2 * std::sqrt(static_cast<double>(count)))));
    } else if (correlations.empty()) {  // a long range, because a short one blurs the spectrum: one set is enough
      correlations.push_back(pair_correlation(points, {}, {.range = 20}));
    }
  }
  RadialProfile profile;
  if (exact_spectrum) {
    profile = spectrum.profile();
    quality.low_power = profile.low_power;
  } else {
    const PairCorrelation mean = mean_of(correlations);
    profile.count = mean.count;
    profile.sets = mean.sets;
    std::vector<double> frequency;
    for (int ring = 0; ring <= 2 * std::sqrt(static_cast<double>(count)); ++ring) {
      frequency.push_back(ring / std::sqrt(static_cast<double>(count)));
    }
    profile.mean = radial_power(mean, frequency);
    quality.low_power = std::nan("");  // the window of the transform blurs it
  }
  quality.effective_nyquist = effective_nyquist(profile);
  return quality;
}

void expect_bars(const Quality& quality, double half_planes) {
  ::testing::Test::RecordProperty("relative_radius", std::to_string(quality.relative_radius));
  ::testing::Test::RecordProperty("mean_nearest", std::to_string(quality.mean_nearest));
  ::testing::Test::RecordProperty("half_planes", std::to_string(quality.half_planes));
  ::testing::Test::RecordProperty("axis_power", std::to_string(quality.axis_power));
  ::testing::Test::RecordProperty("effective_nyquist", std::to_string(quality.effective_nyquist));
  ::testing::Test::RecordProperty("low_power", std::to_string(quality.low_power));
  EXPECT_GE(quality.relative_radius, 0.70);
  EXPECT_GE(quality.mean_nearest, 0.87);
  EXPECT_GE(quality.effective_nyquist, 0.86);
  EXPECT_FALSE(quality.low_power > 5e-4) << quality.low_power;
  EXPECT_LE(quality.axis_power, 30);
  EXPECT_LE(quality.half_planes, half_planes);
}

TEST(SphQuality, HoldsAt4096Samples) { expect_bars(quality_of("sph_blue_noise", {64, 64}, 4096), 0.14); }
TEST(SphQuality, HoldsAt16384Samples) { expect_bars(quality_of("sph_blue_noise", {128, 128}, 16384), 0.11); }
TEST(SphQuality, HoldsAt240000Samples) { expect_bars(quality_of("sph_blue_noise", {200, 200}, 240000), 0.06); }

TEST(SphQuality, AWhiteStartKeepsItsLongWavesAndASobolStartItsLattice) {
  const Quality coarse = quality_of("sph_blue_noise", {128, 128}, 16384);
  const Quality white = quality_of("sph_blue_noise", {128, 128}, 16384, {{"start", "white"}});
  const Quality sobol = quality_of("sph_blue_noise", {128, 128}, 16384, {{"start", "sobol_owen"}});
  EXPECT_GT(white.half_planes, 3 * coarse.half_planes);
  EXPECT_GT(sobol.axis_power, 3 * coarse.axis_power);
}

TEST(SphQuality, OtherStrategiesMissTheBars) {
  const Quality jitter = quality_of("jitter_plane", {64, 64}, 4096);
  EXPECT_LT(jitter.effective_nyquist, 0.5);
  EXPECT_GT(jitter.low_power, 0.1);
  EXPECT_LT(jitter.relative_radius, 0.2);
  const Quality poisson = quality_of("poisson_disk", {64, 64}, 4096);
  EXPECT_GT(poisson.half_planes, 0.2);
  EXPECT_GT(poisson.low_power, 0.01);
}

TEST(SphQuality, ClassesAreBlueAloneAndTogether) {
  // 4 classes of 4096: the first quarter of the samples is the first class.
  ParameterWords words = {{"classes", "4"}};
  const Extent plane{128, 128};
  const auto sampler = find_strategy("sph_blue_noise", words).make({.plane = plane, .budget = 16384}, words);
  const auto together = to_unit(all_positions(*sampler), plane);
  const Points alone = Points(together).subspan(0, 4096);
  for (const Points set : {Points(together), alone}) {
    EXPECT_GT(spacing(set).mean, 0.76);  // white .46, jitter .59
    EXPECT_GT(spacing(set).smallest, 0.35);
    RadialAverage spectrum;
    spectrum.add(Periodogram(set, static_cast<int>(2 * std::sqrt(static_cast<double>(set.size())))));
    EXPECT_LT(spectrum.profile().low_power, 0.03);
    EXPECT_GT(effective_nyquist(spectrum.profile()), 0.6);
  }
}

}  // namespace
}  // namespace abn::analysis
