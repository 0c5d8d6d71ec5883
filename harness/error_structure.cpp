#include "harness/error_structure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "harness/metrics.h"

namespace abn::harness {
namespace {

/// Luminance of test - reference, in double.
cv::Mat1d luminance_error(const Image& test, const Image& reference) {
  require_comparable(test, reference);
  cv::Mat1d error(static_cast<int>(test.size.height), static_cast<int>(test.size.width));
  auto value = error.begin();
  for (std::size_t i = 0; i < test.texels.size(); i += test.channels, ++value) {
    *value = static_cast<double>(luminance(&test.texels[i], test.channels)) -
             static_cast<double>(luminance(&reference.texels[i], test.channels));
  }
  return error;
}

/// The largest size <= n without prime factors above 5.
int fast_size(int n) {
  const auto is_fast = [](int size) {
    for (const int factor : {2, 3, 5}) {
      while (size % factor == 0) size /= factor;
    }
    return size == 1;
  };
  while (!is_fast(n)) --n;
  return n;
}

}  // namespace

double spectral_peak(const Image& test, const Image& reference) {
  const cv::Mat1d whole = luminance_error(test, reference);
  cv::Mat1d error = whole(cv::Rect(0, 0, fast_size(whole.cols), fast_size(whole.rows))).clone();
  error -= cv::mean(error)[0];
  cv::Mat2d spectrum;
  cv::dft(error, spectrum, cv::DFT_COMPLEX_OUTPUT);
  double largest = 0;
  double sum = 0;
  for (const cv::Vec2d& wave : spectrum) {
    const double power = wave[0] * wave[0] + wave[1] * wave[1];
    largest = std::max(largest, power);
    sum += power;
  }
  return sum > 0 ? largest / (sum / static_cast<double>(spectrum.total())) : sum;  // NaN stays
}

double error_run_length(const Image& test, const Image& reference) {
  const cv::Mat1d error = luminance_error(test, reference);
  const double threshold = 0.5 * std::sqrt(error.dot(error) / static_cast<double>(error.total()));
  if (!std::isfinite(threshold)) return std::numeric_limits<double>::quiet_NaN();
  if (threshold == 0) return 0;
  const auto sign = [&](int y, int x) { return error(y, x) > threshold ? 1 : error(y, x) < -threshold ? -1 : 0; };
  double runs = 0;
  double members = 0;  // every pixel with a sign belongs to one run along its row and one along its column
  for (int y = 0; y < error.rows; ++y) {
    for (int x = 0; x < error.cols; ++x) {
      const int here = sign(y, x);
      if (here == 0) continue;
      members += 2;
      runs += (x == 0 || sign(y, x - 1) != here ? 1 : 0) + (y == 0 || sign(y - 1, x) != here ? 1 : 0);
    }
  }
  return runs > 0 ? members / runs : 0;
}

}  // namespace abn::harness
