// Variance of the mean of four integrands over n points of the unit square, n = 16 ... 4096: its slope in log-log and
// its value at n = 256 are what tells one strategy from another, so they are held in bands.
//
// Rows marked "published" repeat an independent implementation (design notes, literature 3.1: 1000 to 3000 trials);
// the others were measured with this code (1000 trials) and frozen. Blue noise costs more, so n ends at 256 or 1024 and
// 100 to 400 sets must do. sobol and regular have no randomness, hence no variance.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ostream>
#include <string>

#include "sampling/ccvt.h"
#include "sampling/cmj.h"
#include "sampling/dart.h"
#include "sampling/draw_for_tests.h"
#include "sampling/gbn.h"
#include "sampling/halton.h"
#include "sampling/hammersley.h"
#include "sampling/jitter.h"
#include "sampling/lloyd.h"
#include "sampling/multijitter.h"
#include "sampling/nrooks.h"
#include "sampling/pmj02.h"
#include "sampling/poisson_disk.h"
#include "sampling/random.h"
#include "sampling/sobol_owen.h"
#include "sampling/sph_blue_noise.h"
#include "sampling/strategy.h"
#include "sampling/zero_two.h"

namespace abn {
namespace {

constexpr std::size_t kIntegrands = 4;  // gauss, bilinear, disk, slanted edge
constexpr double kSlopeBand = 0.12;
constexpr double kVarianceBand = 0.25;

std::array<double, kIntegrands> integrands(Vec2f p) {
  const double x = p.x;
  const double y = p.y;
  return {std::exp(-x * x - y * y), x * y, x * x + y * y < 2 / 3.14159265358979323846 ? 1.0 : 0.0,
          y < 0.3 + 0.37 * x ? 1.0 : 0.0};
}

struct Convergence {
  std::array<double, kIntegrands> slope{};
  std::array<double, kIntegrands> variance_at_256{};
};

/// The first `sizes` of the counts 16, 64, ... , `trials` sets of each.
Convergence measure(const Strategy& strategy, const ParameterWords& words, std::size_t sizes, int trials) {
  constexpr std::array<std::uint64_t, 5> counts{16, 64, 256, 1024, 4096};
  const Grid<PixelStats> none;
  const Feedback feedback{none};
  Convergence result;
  std::array<std::array<double, counts.size()>, kIntegrands> log_variance{};
  for (std::size_t c = 0; c < sizes; ++c) {
    std::array<double, kIntegrands> mean{}, m2{};
    for (int trial = 0; trial < trials; ++trial) {
      const auto seed = static_cast<std::uint64_t>(trial) + 1;
      const auto sampler = strategy.make(SamplingTask{{1, 1}, counts[c], seed}, words);
      std::array<double, kIntegrands> sum{};
      for (auto batch = sampler->next(feedback); !batch.empty(); batch = sampler->next(feedback)) {
        for (const Vec2f p : batch.position) {
          const auto value = integrands(p);
          for (std::size_t f = 0; f < kIntegrands; ++f) sum[f] += value[f];
        }
      }
      for (std::size_t f = 0; f < kIntegrands; ++f) {
        const double delta = sum[f] / static_cast<double>(counts[c]) - mean[f];
        mean[f] += delta / (trial + 1);
        m2[f] += delta * (sum[f] / static_cast<double>(counts[c]) - mean[f]);
      }
    }
    for (std::size_t f = 0; f < kIntegrands; ++f) {
      const double variance = m2[f] / (trials - 1);
      log_variance[f][c] = std::log(variance);
      if (counts[c] == 256) result.variance_at_256[f] = variance;
    }
  }
  // Least squares; the logarithms of the counts are equally spaced.
  for (std::size_t f = 0; f < kIntegrands; ++f) {
    double numerator = 0;
    double denominator = 0;
    for (std::size_t c = 0; c < sizes; ++c) {
      const double t = static_cast<double>(c) - 0.5 * static_cast<double>(sizes - 1);
      numerator += t * log_variance[f][c];
      denominator += t * t;
    }
    result.slope[f] = numerator / denominator / std::log(4.0);
  }
  return result;
}

struct Expected {
  const char* label;
  Strategy strategy;
  ParameterWords words;
  std::array<double, kIntegrands> slope;
  std::array<double, kIntegrands> variance_at_256;
  std::size_t sizes = 5;  // 16 ... 4096
  int trials = 1000;
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.label; }

class ConvergenceOf : public testing::TestWithParam<Expected> {};

TEST_P(ConvergenceOf, SlopeAndVarianceInBand) {
  const char* const name[kIntegrands] = {"gauss", "bilinear", "disk", "edge"};
  const Convergence measured = measure(GetParam().strategy, GetParam().words, GetParam().sizes, GetParam().trials);
  for (std::size_t f = 0; f < kIntegrands; ++f) {
    EXPECT_NEAR(measured.slope[f], GetParam().slope[f], kSlopeBand) << name[f];
    EXPECT_NEAR(measured.variance_at_256[f] / GetParam().variance_at_256[f], 1, kVarianceBand) << name[f];
  }
}

std::string label(const testing::TestParamInfo<Expected>& info) { return info.param.label; }

// clang-format off
INSTANTIATE_TEST_SUITE_P(Published, ConvergenceOf, testing::Values(
    Expected{"random", row<Random>(), {}, {-1.01, -1.01, -1.00, -1.01}, {1.77e-4, 1.80e-4, 9.43e-4, 1.02e-3}},
    Expected{"jitter", row<Jitter>(), {}, {-1.97, -1.98, -1.47, -1.51}, {7.09e-7, 8.44e-7, 5.42e-5, 4.22e-5}},
    Expected{"jitter_plane", row<JitterPlane>(), {}, {-1.97, -1.98, -1.47, -1.51}, {7.09e-7, 8.44e-7, 5.42e-5, 4.22e-5}},
    Expected{"nrooks", row<NRooks>(), {}, {-1.03, -1.02, -1.01, -1.00}, {6.19e-6, 2.63e-5, 2.87e-4, 1.86e-4}},
    Expected{"multijitter", row<MultiJitter>(), {}, {-2.13, -2.06, -1.48, -1.49}, {5.41e-8, 2.32e-7, 5.33e-5, 4.28e-5}},
    Expected{"cmj", row<Cmj>(), {}, {-1.55, -1.53, -1.51, -1.51}, {6.93e-7, 3.57e-6, 3.15e-5, 2.49e-5}},
    Expected{"sobol_owen", row<SobolOwen>(), {}, {-2.91, -2.83, -1.52, -1.50}, {6.60e-9, 2.13e-8, 3.86e-5, 3.29e-5}},
    // As sets of 2^m points these are sobol_owen's in law.
    Expected{"pmj02", row<Pmj02>(), {}, {-2.91, -2.83, -1.52, -1.50}, {6.60e-9, 2.13e-8, 3.86e-5, 3.29e-5}},
    Expected{"hammersley", row<Hammersley>(), {}, {-1.94, -1.86, -1.59, -1.78}, {9.50e-7, 2.48e-6, 3.09e-5, 1.20e-5}}),
    label);

INSTANTIATE_TEST_SUITE_P(Frozen, ConvergenceOf, testing::Values(
    Expected{"halton_owen", row<Halton>(), {}, {-2.00, -1.99, -1.50, -1.50}, {5.61e-7, 9.58e-7, 5.03e-5, 4.33e-5}},
    Expected{"halton_digit", row<Halton>(), {{"scramble", "digit"}}, {-1.91, -1.93, -1.55, -1.51}, {1.41e-6, 1.69e-6, 6.26e-5, 4.98e-5}},
    Expected{"zero_two", row<ZeroTwo>(), {}, {-2.01, -2.01, -1.65, -1.52}, {5.77e-7, 6.48e-7, 2.88e-5, 6.72e-5}}),
    label);

INSTANTIATE_TEST_SUITE_P(BlueNoise, ConvergenceOf, testing::Values(
    Expected{"dart", row<Dart>(), {}, {-1.26, -1.28, -1.24, -1.25}, {1.88e-5, 2.29e-5, 1.09e-4, 1.06e-4}, 4, 400},
    Expected{"poisson_disk", row<PoissonDisk>(), {}, {-1.26, -1.28, -1.24, -1.25}, {1.88e-5, 2.29e-5, 1.09e-4, 1.06e-4}, 4, 400},
    // These are frozen; the two above are published.
    Expected{"sph_blue_noise", row<SphBlueNoise>(), {}, {-1.52, -1.54, -1.49, -1.49}, {1.04e-5, 1.30e-5, 5.44e-5, 4.31e-5}, 4, 400},
    Expected{"gbn", row<Gbn>(), {}, {-1.52, -1.50, -1.48, -1.47}, {7.63e-6, 1.03e-5, 4.90e-5, 4.45e-5}, 4, 200},
    Expected{"lloyd", row<Lloyd>(), {}, {-1.55, -1.47, -1.40, -1.43}, {9.46e-6, 1.55e-5, 6.56e-5, 5.38e-5}, 3, 100},
    Expected{"ccvt", row<Ccvt>(), {}, {-1.53, -1.48, -1.52, -1.51}, {7.33e-6, 1.08e-5, 4.66e-5, 3.55e-5}, 3, 200}),
    label);
// clang-format on

}  // namespace
}  // namespace abn
