#include "harness/calibration.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "harness/color.h"
#include "harness/separable_filter.h"

namespace abn::harness {
namespace {

/// Where what was missed may lie: the pixels' error variance, smoothed, with mean 1.
Grid<float> shares_of(const Grid<float>& standard_error) {
  constexpr float reach = 8;      // standard deviation [px]
  constexpr int radius = 20;      // [px]
  constexpr float least = 1e-3F;  // of the mean: never nothing anywhere, so that the mean can always move
  std::vector<float> kernel;
  float sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    kernel.push_back(std::exp(-0.5F * static_cast<float>(k * k) / (reach * reach)));
    sum += kernel.back();
  }
  for (float& tap : kernel) tap /= sum;
  Grid<float> share(standard_error.size());
  for (std::size_t p = 0; p < share.cells().size(); ++p) {
    const float error = std::isfinite(standard_error[p]) ? standard_error[p] : 0;
    share[p] = std::min(error, 1e15F) * std::min(error, 1e15F);
  }
  share = filter_columns(filter_rows(share, kernel), kernel);
  double mean = 0;
  for (const float value : share.cells()) mean += double{value};
  mean /= static_cast<double>(share.cells().size());
  for (float& value : share.cells()) {
    value = mean > 0 ? (static_cast<float>(double{value} / mean) + least) / (1 + least) : 1;
  }
  return share;
}

}  // namespace

double calibrate(Developed& developed, const Film& film, std::uint64_t uniform) {
  const KeptSamples& kept = film.kept();
  assert(uniform <= kept.pixel.size());
  if (uniform < 2 || uniform == kept.pixel.size() || developed.standard_error.cells().empty()) return 0;
  Image& image = developed.image;
  const std::uint32_t channels = image.channels;
  std::array<double, 3> sum{};
  double light = 0;
  double light_squares = 0;
  for (std::uint64_t i = 0; i < uniform; ++i) {
    const float* value = &kept.value[i * channels];
    const float* pixel = &image.texels[std::size_t{kept.pixel[i]} * channels];
    std::array<float, 3> difference{};
    for (std::uint32_t c = 0; c < channels; ++c) {
      difference[c] = value[c] - pixel[c];
      sum[c] += double{difference[c]};
    }
    const auto luminous = double{luminance(difference.data(), channels)};
    light += luminous;
    light_squares += luminous * luminous;
  }
  const auto n = static_cast<double>(uniform);
  const double mean = light / n;
  const double variance_of_mean = (light_squares / n - mean * mean) / (n - 1);
  constexpr double factor = calibration_significance * calibration_significance;
  if (!(mean * mean > factor * variance_of_mean) || !std::isfinite(mean)) return 0;
  const Grid<float> share = shares_of(developed.standard_error);
  for (std::size_t p = 0; p < share.cells().size(); ++p) {
    for (std::uint32_t c = 0; c < channels; ++c) {
      image.texels[p * channels + c] += static_cast<float>(sum[c] / n * double{share[p]});
    }
  }
  return mean;
}

}  // namespace abn::harness
