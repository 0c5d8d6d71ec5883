#include "harness/ssim.h"

#include <cassert>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "harness/color.h"

namespace abn::harness {
namespace {

cv::Mat1d encoded_channel(const Image& image, std::uint32_t channel) {
  cv::Mat1d plane(static_cast<int>(image.size.height), static_cast<int>(image.size.width));
  for (std::size_t i = 0; i < image.size.area(); ++i) {
    plane.ptr<double>()[i] = linear_to_srgb(image.texels[i * image.channels + channel]);
  }
  return plane;
}

// Mean over the Gaussian window of every pixel.
cv::Mat1d window_mean(const cv::Mat1d& plane) {
  cv::Mat1d blurred;
  cv::GaussianBlur(plane, blurred, cv::Size(11, 11), 1.5);  // border: mirrored without repeating the edge
  return blurred;
}

cv::Mat1d similarity(const cv::Mat1d& x, const cv::Mat1d& y) {
  constexpr double c1 = 0.01 * 0.01;
  constexpr double c2 = 0.03 * 0.03;
  const cv::Mat1d mean_x = window_mean(x);
  const cv::Mat1d mean_y = window_mean(y);
  const cv::Mat1d mean_xx = window_mean(cv::Mat(x.mul(x)));
  const cv::Mat1d mean_yy = window_mean(cv::Mat(y.mul(y)));
  const cv::Mat1d mean_xy = window_mean(cv::Mat(x.mul(y)));
  cv::Mat1d map(x.size());
  for (std::size_t i = 0; i < map.total(); ++i) {
    const double mx = mean_x.ptr<double>()[i];
    const double my = mean_y.ptr<double>()[i];
    const double variances = mean_xx.ptr<double>()[i] - mx * mx + mean_yy.ptr<double>()[i] - my * my;
    const double covariance = mean_xy.ptr<double>()[i] - mx * my;
    map.ptr<double>()[i] =
        (2.0 * mx * my + c1) * (2.0 * covariance + c2) / ((mx * mx + my * my + c1) * (variances + c2));
  }
  return map;
}

}  // namespace

SimilarityResult structural_similarity(const Image& test, const Image& reference) {
  assert(test.size == reference.size && test.channels == reference.channels);
  std::vector<double> pixel_sums(test.size.area());
  for (std::uint32_t channel = 0; channel < test.channels; ++channel) {
    const cv::Mat1d map = similarity(encoded_channel(test, channel), encoded_channel(reference, channel));
    for (std::size_t i = 0; i < pixel_sums.size(); ++i) pixel_sums[i] += map.ptr<double>()[i];
  }
  SimilarityResult result{Grid<float>(test.size), 0.0};
  for (std::size_t i = 0; i < pixel_sums.size(); ++i) {
    result.map[i] = static_cast<float>(pixel_sums[i] / test.channels);
    result.mean += pixel_sums[i];
  }
  result.mean /= static_cast<double>(test.texels.size());
  return result;
}

}  // namespace abn::harness
