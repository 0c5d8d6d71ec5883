// Gaussian blue noise: points whose Gaussian-blurred sum is as flat as gradient descent makes it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sampling/emit_by_pixel.h"
#include "sampling/sampler.h"
#include "sampling/strategy.h"

namespace abn {

/// Where the Gaussian is cut off [spacings]; what is cut off is 2 pi exp(-reach^2/2) = 2e-5 of 6.28.
inline constexpr float gaussian_reach = 5.0F;

/// exp(-r2/2), and 0 from gaussian_reach on, at a squared distance r2 >= 0. Within 2e-5 of the exponential, relatively:
/// its sixteenth root by a polynomial (equal extrema of the relative error on [0,1], by Remez' exchange), squared four
/// times; a library's exp() would not vectorise the same everywhere.
inline float gaussian_overlap(float r2) {
  const float u = r2 * (1.0F / 32.0F);
  float root =
      1.0F + u * (-0.999970177F + u * (0.499609779F + u * (-0.164948888F + u * (0.0382467974F + u * -0.00505834914F))));
  root *= root;
  root *= root;
  root *= root;
  root *= root;
  return r2 < gaussian_reach * gaussian_reach ? root : 0.0F;
}

struct GaussianDescent {
  double step = 0.6;      // along the gradient; stable below (1 + momentum) / 2.31, where long waves overshoot
  double momentum = 0.9;  // share of the last move that is made again, in [0,1)
  int iterations = 100;
  double tolerance = 0;  // mean move [spacings] below which to stop
};

struct GaussianReport {
  int iterations = 0;
  double first_energy = 0;       // per point, before the first iteration
  double energy = 0;             // per point, at the end
  double mean_displacement = 0;  // of the last iteration [spacings]
  std::uint64_t non_finite = 0;  // moves that were dropped
  bool converged = false;
};

/// Gradient descent, with momentum (Polyak 1964), of the energy per point E = 1/N sum_ij exp(-|x_i - x_j|^2/2) in
/// spacings sqrt(area/N), over all periodic images and with i = j, on the torus of `plane`: of the square of the
/// points' sum of Gaussians. By Plancherel's theorem E - 2 pi = 2 pi sum exp(-k^2/2) power(k) / N over the frequencies
/// k != 0 [radians per spacing]: the smaller, the less power at low frequencies. Every point moves by step * sum_j (x_i
/// - x_j) exp(-|x_i - x_j|^2/2), at most half a spacing. Positions [px] inside the plane, changed in place; coincident
/// ones do not part. The result is the same for any number of threads.
GaussianReport relax_gaussian(std::vector<Vec2f>& positions, Extent plane, const GaussianDescent& descent);

/// Ahmed, Ren, Wonka 2022, "Gaussian blue noise" (ACM TOG 41(6)), with their sigma of one spacing. Deviations, each for
/// speed: momentum (N = 4096, 5 seeds: 100 iterations reach relative radius .53, mean nearest neighbour .80 and
/// half-plane error .124, where 1000 of the paper's plain ones with step .25 reach .53, .79 and .121), a start that is
/// not white, a cut-off at gaussian_reach (the authors' code: 5.8 spacings), and cells instead of all pairs.
class Gbn final : public Sampler {
 public:
  struct Params {
    int iterations = 100;
    double step = 0.6;
    double momentum = 0.9;
    double tolerance = 0;
    std::string start = "coarse_cells";
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a budget of 0 or above 2^32-1. Nothing is computed before the first next().
  Gbn(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  SamplingTask task_;
  Params params_;
  EmitByPixel samples_;
  GaussianReport report_;
};

}  // namespace abn
