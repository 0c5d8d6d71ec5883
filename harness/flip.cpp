#include "harness/flip.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "harness/separable_filter.h"

namespace abn::harness {
namespace {

using Plane = Grid<float>;
using Kernel = std::vector<float>;

// Paper, section 4: exponents, split point and width of the feature detectors [degree].
constexpr float colour_exponent = 0.7F;   // q_c
constexpr float colour_split = 0.4F;      // p_c, share of the largest colour difference
constexpr float split_error = 0.95F;      // p_t, the error it maps to
constexpr float feature_exponent = 0.5F;  // q_f
constexpr double feature_width = 0.082;   // w

// Linear Rec. 709 to XYZ divided by the white point, so that white is (1,1,1).
const Eigen::Matrix3d& rgb_to_relative_xyz() {
  static const Eigen::Matrix3d matrix = [] {
    Eigen::Matrix3d m;
    m << 10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0,  //
        2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0,     //
        1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0;
    const Eigen::Vector3d white = m.rowwise().sum();
    return Eigen::Matrix3d(white.cwiseInverse().asDiagonal() * m);
  }();
  return matrix;
}

// The compressive curve of CIE L*a*b*.
float lab_curve(float t) {
  constexpr float delta = 6.0F / 29.0F;
  return t > delta * delta * delta ? std::cbrt(t) : t / (3.0F * delta * delta) + 4.0F / 29.0F;
}

// L*a*b* of a linear colour with the Hunt adjustment: chroma weighs less where it is dark.
Eigen::Vector3f hunt_lab(const Eigen::Vector3f& xyz) {
  const float x = lab_curve(xyz.x());
  const float y = lab_curve(xyz.y());
  const float z = lab_curve(xyz.z());
  const float lightness = 116.0F * y - 16.0F;
  const float hunt = 0.01F * lightness;
  return {lightness, hunt * 500.0F * (x - y), hunt * 200.0F * (y - z)};
}

// The HyAB distance (Abasi, Tehran, Fairchild 2020): city block in lightness, Euclidean in chroma.
float hyab(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::abs(a.x() - b.x()) + std::hypot(a.y() - b.y(), a.z() - b.z());
}

// An image in the opponent space YCxCz, one plane per axis.
struct Opponent {
  Plane y, cx, cz;
};

struct Display {  // linear light in [0,1] of one pixel, from any texel
  double exposure_scale = 1;
  bool tone_map = false;

  float operator()(float value) const {
    if (!tone_map) return std::clamp(value, 0.0F, 1.0F);
    // ACES fit of Narkowicz 2015 with its pre-exposure of .6 undone; in double, where squares of floats do not
    // overflow.
    const double x = std::max(0.0F, value) * exposure_scale;
    const double mapped = (0.9036 * x * x + 0.018 * x) / (0.8748 * x * x + 0.354 * x + 0.14);
    return static_cast<float>(std::isnan(value) ? value : std::clamp(mapped, 0.0, 1.0));
  }
};

Opponent opponent(const Image& image, const Display& display) {
  const Eigen::Matrix3f to_xyz = rgb_to_relative_xyz().cast<float>();
  Opponent planes{Plane(image.size), Plane(image.size), Plane(image.size)};
  const auto height = static_cast<int>(image.size.height);
#pragma omp parallel for schedule(static) if (image.size.area() >= smallest_parallel_raster)
  for (int row = 0; row < height; ++row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < image.size.width; ++x) {
      const float* texel = image.texel(x, y);
      Eigen::Vector3f rgb = Eigen::Vector3f::Constant(display(texel[0]));
      if (image.channels >= 3) rgb = {rgb.x(), display(texel[1]), display(texel[2])};
      const Eigen::Vector3f xyz = to_xyz * rgb;
      planes.y.at(x, y) = 116.0F * xyz.y() - 16.0F;
      planes.cx.at(x, y) = 500.0F * (xyz.x() - xyz.y());
      planes.cz.at(x, y) = 200.0F * (xyz.y() - xyz.z());
    }
  }
  return planes;
}

// Contrast sensitivity as Gaussians in space; the blue-yellow one is a sum of two, hence two kernels whose products
// add.
struct SpatialKernels {
  Kernel y, cx, cz_near, cz_far;
};

SpatialKernels spatial_kernels(double pixels_per_degree) {
  constexpr double pi = std::numbers::pi;
  const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * pixels_per_degree));
  const auto gaussian = [&](double weight, double spread) {
    std::vector<double> values;
    for (int i = -radius; i <= radius; ++i) {
      const double degrees = i / pixels_per_degree;
      values.push_back(std::sqrt(weight * std::sqrt(pi / spread)) * std::exp(-pi * pi * degrees * degrees / spread));
    }
    return values;
  };
  const auto sum = [](const std::vector<double>& values) {
    double total = 0;
    for (double value : values) total += value;
    return total;
  };
  const auto scaled = [](const std::vector<double>& values, double scale) {
    Kernel kernel;
    for (double value : values) kernel.push_back(static_cast<float>(value * scale));
    return kernel;
  };
  const auto y = gaussian(1.0, 0.0047);
  const auto cx = gaussian(1.0, 0.0053);
  const auto near = gaussian(34.1, 0.04);
  const auto far = gaussian(13.5, 0.025);
  const double norm = 1.0 / std::hypot(sum(near), sum(far));  // the two squared kernels together sum to 1
  return {scaled(y, 1.0 / sum(y)), scaled(cx, 1.0 / sum(cx)), scaled(near, norm), scaled(far, norm)};
}

// A Gaussian and its first two derivatives; positive and negative weights of the derivatives sum to +1 and -1.
struct FeatureKernels {
  Kernel blur, edge, point;
};

FeatureKernels feature_kernels(double pixels_per_degree) {
  const double sigma = 0.5 * feature_width * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<std::array<double, 3>> values;
  std::array<double, 3> positive{};
  std::array<double, 3> negative{};
  for (int i = -radius; i <= radius; ++i) {
    const double g = std::exp(-i * i / (2.0 * sigma * sigma));
    values.push_back({g, -i * g, (i * i / (sigma * sigma) - 1.0) * g});
    for (std::size_t k = 0; k < 3; ++k) (values.back()[k] > 0 ? positive : negative)[k] += std::abs(values.back()[k]);
  }
  std::array<Kernel, 3> kernels;
  for (const auto& value : values) {
    for (std::size_t k = 0; k < 3; ++k) {
      kernels[k].push_back(value[k] == 0 ? 0.0F
                                         : static_cast<float>(value[k] / (value[k] > 0 ? positive : negative)[k]));
    }
  }
  return {kernels[0], kernels[1], kernels[2]};
}

Plane filter(const Plane& plane, const Kernel& kernel) { return filter_columns(filter_rows(plane, kernel), kernel); }

// The image as the eye resolves it, still in the opponent space.
Opponent seen(const Opponent& image, const SpatialKernels& kernels) {
  Opponent filtered{filter(image.y, kernels.y), filter(image.cx, kernels.cx), filter(image.cz, kernels.cz_near)};
  const Plane far = filter(image.cz, kernels.cz_far);
  for (std::size_t i = 0; i < far.cells().size(); ++i) filtered.cz[i] += far[i];
  return filtered;
}

// Colour of a filtered pixel in Hunt-adjusted L*a*b*, clamped to what the display can show.
Eigen::Vector3f perceived(const Opponent& image, std::size_t i, const Eigen::Matrix3f& to_xyz,
                          const Eigen::Matrix3f& to_rgb) {
  const float y = (image.y[i] + 16.0F) / 116.0F;
  const Eigen::Vector3f xyz(y + image.cx[i] / 500.0F, y, y - image.cz[i] / 200.0F);
  Eigen::Vector3f rgb = to_rgb * xyz;
  for (float& value : rgb) value = std::clamp(value, 0.0F, 1.0F);
  return hunt_lab(to_xyz * rgb);
}

// Strength of edges and of points (lines, dots) at every pixel.
struct Features {
  Plane edge, point;
};

Features features(const Plane& opponent_y, const FeatureKernels& kernels) {
  Plane luminance = opponent_y;
  for (float& value : luminance.cells()) value = (value + 16.0F) / 116.0F;
  const Plane blurred = filter_rows(luminance, kernels.blur);
  const auto gradient = [&](const Kernel& derivative) {
    Plane length = filter_columns(filter_rows(luminance, derivative), kernels.blur);
    const Plane vertical = filter_columns(blurred, derivative);
    for (std::size_t i = 0; i < vertical.cells().size(); ++i) {
      length[i] = std::sqrt(length[i] * length[i] + vertical[i] * vertical[i]);
    }
    return length;
  };
  return {gradient(kernels.edge), gradient(kernels.point)};
}

// LDR-FLIP of the two images as the display shows them.
Plane flip_map(const Image& test, const Image& reference, const Display& display, double pixels_per_degree) {
  const Opponent test_opponent = opponent(test, display);
  const Opponent reference_opponent = opponent(reference, display);
  const SpatialKernels spatial = spatial_kernels(pixels_per_degree);
  const Opponent test_seen = seen(test_opponent, spatial);
  const Opponent reference_seen = seen(reference_opponent, spatial);
  const FeatureKernels feature = feature_kernels(pixels_per_degree);
  const Features test_features = features(test_opponent.y, feature);
  const Features reference_features = features(reference_opponent.y, feature);

  const Eigen::Matrix3f to_xyz = rgb_to_relative_xyz().cast<float>();
  const Eigen::Matrix3f to_rgb = rgb_to_relative_xyz().inverse().cast<float>();
  // No two colours of the display are further apart than its green and its blue.
  const float largest = std::pow(hyab(hunt_lab(to_xyz.col(1)), hunt_lab(to_xyz.col(2))), colour_exponent);
  const float split = colour_split * largest;

  Plane map(test.size);
  const auto count = static_cast<std::ptrdiff_t>(map.cells().size());
#pragma omp parallel for schedule(static) if (map.cells().size() >= smallest_parallel_raster)
  for (std::ptrdiff_t pixel = 0; pixel < count; ++pixel) {
    const auto i = static_cast<std::size_t>(pixel);
    float colour = std::pow(hyab(perceived(reference_seen, i, to_xyz, to_rgb), perceived(test_seen, i, to_xyz, to_rgb)),
                            colour_exponent);
    colour = colour < split ? colour * split_error / split
                            : split_error + (colour - split) / (largest - split) * (1.0F - split_error);
    const float edge = std::abs(reference_features.edge[i] - test_features.edge[i]);
    const float point = std::abs(reference_features.point[i] - test_features.point[i]);
    const float difference = std::pow(std::max(edge, point) / std::numbers::sqrt2_v<float>, feature_exponent);
    map[i] = std::pow(colour, 1.0F - difference);
  }
  return map;
}

double mean(const Plane& map) {
  double total = 0;
  for (float value : map.cells()) total += value;
  return total / static_cast<double>(map.cells().size());
}

// Luminance of every pixel, ascending; pixels that are not finite are left out.
std::vector<float> sorted_luminances(const Image& image) {
  std::vector<float> values;
  values.reserve(image.size.area());
  for (std::size_t i = 0; i < image.size.area(); ++i) {
    const float value = luminance(image.texels.data() + i * image.channels, image.channels);
    if (std::isfinite(value)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  return values;
}

double median_of_sorted(std::span<const float> values) {
  return 0.5 * (double{values[(values.size() - 1) / 2]} + double{values[values.size() / 2]});
}

}  // namespace

FlipResult ldr_flip(const Image& test, const Image& reference, double pixels_per_degree) {
  assert(test.size == reference.size && test.channels == reference.channels);
  Plane map = flip_map(test, reference, Display{}, pixels_per_degree);
  const double average = mean(map);
  return {std::move(map), average};
}

ExposureRange flip_exposures(const Image& test, const Image& reference) {
  // The x that the ACES fit maps to .85: the larger root of (.9036-.85*.8748)x^2 + (.018-.85*.354)x - .85*.14.
  constexpr double a = 0.9036 - 0.85 * 0.8748;
  constexpr double b = 0.018 - 0.85 * 0.354;
  constexpr double c = -0.85 * 0.14;
  const double white = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);

  std::vector<float> values = sorted_luminances(reference);
  if (values.empty() || values.back() <= 0) values = sorted_luminances(test);
  if (values.empty() || values.back() <= 0) return {0.0, 0.0, 2};
  const double brightest = values.back();
  double middle = median_of_sorted(values);
  if (middle <= 0) {
    const auto first = std::upper_bound(values.begin(), values.end(), 0.0F);
    middle = median_of_sorted({first, values.end()});
  }
  middle = std::max(middle, brightest * 0x1p-32);
  const double start = std::log2(white / brightest);
  const double stop = std::log2(white / middle);
  return {start, stop, std::max(2, static_cast<int>(std::ceil(stop - start)))};
}

FlipResult hdr_flip(const Image& test, const Image& reference, double pixels_per_degree) {
  assert(test.size == reference.size && test.channels == reference.channels);
  const ExposureRange range = flip_exposures(test, reference);
  Plane largest(test.size);
  // A single distinct exposure needs a single pass, whatever the count says.
  const int passes = range.stop > range.start ? range.count : 1;
  for (int pass = 0; pass < passes; ++pass) {
    const double exposure = range.start + (passes > 1 ? (range.stop - range.start) * pass / (passes - 1) : 0.0);
    const Plane map = flip_map(test, reference, Display{std::exp2(exposure), true}, pixels_per_degree);
    for (std::size_t i = 0; i < map.cells().size(); ++i) {
      if (!(map[i] <= largest[i])) largest[i] = map[i];  // NaN is kept
    }
  }
  const double average = mean(largest);
  return {std::move(largest), average};
}

}  // namespace abn::harness
