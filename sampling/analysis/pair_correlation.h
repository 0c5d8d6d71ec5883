// How far apart points are, for uniform and for adaptive sets: distances measured in local spacings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/analysis/points.h"
#include "sampling/grid.h"

namespace abn::analysis {

struct PairCorrelationOptions {
  double range = 8;           // largest distance [spacings], > 0
  int bins_per_spacing = 32;  // in [1, 1024]
};

/// Differential domain analysis of one set or the mean over sets (Wei & Wang 2011, "Differential domain analysis for
/// non-uniform sampling"): all pairs of the torus by their difference d' = d 2 s_mean / (s_i + s_j), where the size s
/// of a point is proportional to the spacing wanted there. Lengths are in mean spacings 1/sqrt(N), for adaptive sets in
/// local ones; a Poisson process has 1 everywhere.
struct PairCorrelation {
  std::size_t count = 0;  // N, points per set
  int sets = 1;
  double range = 0;         // distances covered [spacings]: an even number of bins, cut where the range asked for
                            // would reach around the torus
  double bin_width = 0;     // [spacings]
  std::vector<double> g;    // [range / bin_width] radial distribution function; bin k is [k, k+1) bin widths
  Grid<double> difference;  // the same by direction: cells of two bin widths over [-range, range)^2, 0 beyond the range
  std::uint64_t pairs = 0;  // unordered, within the range, of all sets
  double plateau = 0;       // mean g over the outer quarter of the range: 1 if the density follows s^-2
};

/// `size` holds s of every point, or is empty for a uniform set. Throws ConfigError for fewer than two points, a `size`
/// of another length or not positive and finite, or options out of range.
///
/// Two deviations from the paper: bins instead of a Gaussian kernel, so that a pair counts once and results are exact
/// integers; and s_mean is the root mean square over the points, because the mean of s^2 over points of density
/// proportional to s^-2 is what turns d' into local spacings. About N pi range^2 / 2 pairs whatever the ratio of sizes:
/// a pair is found from its larger point. Bit-identical for any number of threads.
PairCorrelation pair_correlation(Points points, std::span<const float> size = {}, PairCorrelationOptions options = {});

/// Mean over sets of equal count and bin width, at least one, over the shortest of their ranges (which differ between
/// adaptive sets); `pairs` counts those of the full ranges. Throws ConfigError otherwise.
PairCorrelation mean_of(std::span<const PairCorrelation> sets);

/// The radial mean of the power spectrum that belongs to g, also for adaptive sets:
/// P(nu) = |1 + 2 pi N integral_0^range (g(r) - 1) J0(2 pi nu r) w(r) r dr| with the Blackman window w = 0.42 +
/// 0.5 cos(pi r / range) + 0.08 cos(2 pi r / range). `frequency` is relative to sqrt(N); result of the same length.
/// The bins average the power away by sinc(frequency * bin_width), the window blurs it by about 1 / range.
std::vector<double> radial_power(const PairCorrelation& correlation, std::span<const double> frequency);

}  // namespace abn::analysis
