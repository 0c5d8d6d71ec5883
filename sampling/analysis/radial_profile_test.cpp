#include "sampling/analysis/radial_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sampling/analysis/point_sets_test.h"
#include "sampling/error.h"

namespace abn::analysis {
namespace {

RadialProfile profile_of(const char* strategy, std::uint64_t count, int sets, int reach,
                         const ParameterWords& words = {}) {
  RadialAverage average;
  for (int k = 1; k <= sets; ++k) {
    average.add(Periodogram(make_set(strategy, count, static_cast<std::uint64_t>(k), words), reach));
  }
  return average.profile();
}

double mean_of_first_rings(const RadialProfile& profile) {
  return (profile.mean[1] + profile.mean[2] + profile.mean[3] + profile.mean[4]) / 4;
}

RadialProfile made_up(std::size_t count, int reach, double (*power)(int)) {
  RadialProfile profile;
  profile.count = count;
  profile.sets = 1;
  profile.mean.push_back(0);
  for (int k = 1; k <= reach; ++k) profile.mean.push_back(power(k));
  return profile;
}

TEST(RadialProfile, RingsHoldEveryPairOfFrequenciesOnce) {
  const std::vector<Point> point(1);
  RadialAverage average;
  average.add(Periodogram(point, 40));
  const RadialProfile profile = average.profile();
  EXPECT_EQ(profile.reach(), 40);
  EXPECT_EQ(profile.frequencies[1], 4U);  // (1,0) (0,1) (1,1) (1,-1)
  EXPECT_EQ(profile.frequencies[2], 6U);  // (2,0) (0,2) (1,2) (1,-2) (2,1) (2,-1)
  std::size_t inside = 0;
  for (const std::size_t n : profile.frequencies) inside += n;
  EXPECT_NEAR(static_cast<double>(inside), std::numbers::pi * 40.5 * 40.5 / 2, 30);
  for (std::size_t k = 1; k <= 40; ++k) EXPECT_NEAR(profile.mean[k], 1, 1e-12);
  EXPECT_TRUE(std::isnan(profile.standard_error[1]));
  EXPECT_TRUE(std::isnan(profile.low_power));  // no frequency below half a cycle
}

TEST(RadialProfile, WhiteNoiseHasPowerOneWithinThePredictedError) {
  constexpr int kSets = 10;
  const RadialProfile profile = profile_of("random", 1024, kSets, 160);
  EXPECT_EQ(profile.sets, kSets);
  EXPECT_EQ(profile.count, 1024U);
  double squares = 0;
  double error_ratio = 0;
  for (std::size_t k = 1; k <= 160; ++k) {
    const double predicted = 1 / std::sqrt(static_cast<double>(profile.frequencies[k]) * kSets);
    const double deviation = (profile.mean[k] - 1) / predicted;
    EXPECT_LT(std::abs(deviation), 4.5) << k;
    squares += deviation * deviation / 160;
    error_ratio += profile.standard_error[k] / predicted / 160;
  }
  EXPECT_NEAR(squares, 1, 0.35);
  EXPECT_NEAR(error_ratio, 0.973, 0.08);  // the mean of a standard deviation of ten
  EXPECT_NEAR(profile.low_power, 1, 4 * profile.low_power_error);
  EXPECT_NEAR(profile.low_power_error, 1 / std::sqrt(402.0 * kSets), 0.01);
  EXPECT_DOUBLE_EQ(profile.isotropic_db, -10);
  EXPECT_NEAR(mean_anisotropy_db(profile), -10, 0.5);
}

// One uniform point in each of m * m cells: the cells' own spectra cancel against the lattice's.
TEST(RadialProfile, JitterHasItsClosedForm) {
  constexpr int kReach = 128;
  constexpr double kCells = 32;
  const auto sinc = [](double t) { return t == 0 ? 1.0 : std::sin(std::numbers::pi * t) / (std::numbers::pi * t); };
  const RadialProfile profile = profile_of("jitter", 1024, 20, kReach);
  std::vector<double> expected(kReach + 1);
  for (int v = 0; v <= kReach; ++v) {
    for (int u = -kReach; u <= kReach; ++u) {
      const long ring = std::lround(std::hypot(u, v));
      if ((v == 0 && u <= 0) || ring > kReach) continue;
      const double cell = sinc(u / kCells) * sinc(v / kCells);
      expected[static_cast<std::size_t>(ring)] += 1 - cell * cell;
    }
  }
  double squares = 0;
  for (std::size_t k = 1; k <= kReach; ++k) {
    const double deviation =
        (profile.mean[k] - expected[k] / static_cast<double>(profile.frequencies[k])) / profile.standard_error[k];
    EXPECT_LT(std::abs(deviation), 5) << k;
    squares += deviation * deviation / kReach;
  }
  EXPECT_NEAR(squares, 19.0 / 17, 0.5);  // the variance of Student's t of 20 sets
  EXPECT_NEAR(mean_anisotropy_db(profile), profile.isotropic_db, 0.5);
}

TEST(RadialProfile, AnisotropyTellsALatticeFromARandomSet) {
  RadialAverage lattice;
  lattice.add(Periodogram(square_lattice(32), 80));
  EXPECT_GT(lattice.profile().anisotropy_db[32], 10);
  EXPECT_LT(std::abs(mean_anisotropy_db(profile_of("random", 1024, 1, 80))), 0.5);
}

TEST(EffectiveNyquist, FollowsItsDefinition) {
  // A step at 36: by the trapezoidal rule C(37) = 109/1369 = 0.080, C(38) = 184/1444 = 0.127.
  EXPECT_DOUBLE_EQ(effective_nyquist(made_up(4096, 128, [](int k) { return k < 36 ? 0.0 : 1.0; })), 37.0 / 64);
  EXPECT_EQ(effective_nyquist(made_up(4096, 128, [](int) { return 1.0; })), 0);
  // Power just above a tenth everywhere below the peak: nothing is empty enough.
  EXPECT_EQ(effective_nyquist(made_up(4096, 128, [](int k) { return k < 60 ? 0.11 : 2.0; })), 0);
  RadialAverage lattice;
  lattice.add(Periodogram(square_lattice(32), 64));
  EXPECT_DOUBLE_EQ(effective_nyquist(lattice.profile()), 31.0 / 32);
}

TEST(Oscillation, FollowsItsDefinition) {
  EXPECT_NEAR(oscillation(made_up(256, 100, [](int k) { return k < 10 ? 0.0 : 1.5; })), 5, 1e-12);
  EXPECT_NEAR(oscillation(made_up(256, 100, [](int k) { return k < 10 ? 0.5 : 1.0; })), 0, 1e-12);
  // nu0 = 16, nu1 = 96 = the last bad ring but one: rings beyond do not count.
  EXPECT_NEAR(oscillation(made_up(256, 200, [](int k) { return k < 16 ? 0.0 : k <= 96 ? 1.1 : 9.0; })), 1, 1e-12);
}

TEST(SpectralPeak, IsTheHighestRing) {
  const Peak peak = spectral_peak(made_up(256, 100, [](int k) { return k == 20 ? 3.0 : 1.0; }));
  EXPECT_EQ(peak.power, 3);
  EXPECT_DOUBLE_EQ(peak.frequency, 1.25);
}

TEST(RadialProfile, TooShortASpectrumIsRefused) {
  const RadialProfile profile = profile_of("random", 1024, 1, 47);
  EXPECT_THROW(effective_nyquist(profile), ConfigError);
  EXPECT_THROW(oscillation(profile), ConfigError);
}

// Published orders of magnitude, measured by an independent implementation at N = 1024, frequencies up to 5 sqrt(N).
TEST(SpectralAnchors, OfAThousandPoints) {
  const RadialProfile random = profile_of("random", 1024, 10, 160);
  EXPECT_EQ(effective_nyquist(random), 0);
  EXPECT_NEAR(oscillation(random), 0.20, 0.04);

  const RadialProfile jitter = profile_of("jitter", 1024, 10, 160);
  EXPECT_NEAR(effective_nyquist(jitter), 0.19, 0.04);
  EXPECT_NEAR(mean_of_first_rings(jitter), 0.026, 0.005);

  EXPECT_NEAR(effective_nyquist(profile_of("sobol_owen", 1024, 10, 160)), 0.31, 0.05);

  const RadialProfile disk = profile_of("dart", 1024, 10, 160, {{"radius", "0.74"}, {"throws", "2"}});  // reaches 0.69
  EXPECT_NEAR(effective_nyquist(disk), 0.53, 0.05);
  EXPECT_NEAR(oscillation(disk), 1.4, 0.15);
  EXPECT_NEAR(mean_of_first_rings(disk), 0.076, 0.015);
}

TEST(SpectralAnchors, OfFourThousandPoints) {
  EXPECT_NEAR(effective_nyquist(profile_of("jitter", 4096, 3, 128)), 0.235, 0.025);
  const RadialProfile disk = profile_of("dart", 4096, 3, 128, {{"radius", "0.72"}, {"throws", "2"}});  // reaches 0.68
  EXPECT_GT(effective_nyquist(disk), 0.40);
  EXPECT_LT(effective_nyquist(disk), 0.52);
  EXPECT_NEAR(disk.low_power, 0.1, 0.02);
}

}  // namespace
}  // namespace abn::analysis
