#include "harness/truth.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

// The weights of the texels that one pixel of an axis sees; whole numbers, exact in double.
struct Window {
  std::uint32_t first = 0;      // texel
  std::vector<double> weights;  // of texels first, first + 1, ...
};

struct AxisWeights {
  std::vector<Window> windows;  // one per pixel
  double sum = 1;               // of the weights of a window; the same for all
};

// Texel i covers [i W, (i+1) W) and pixel o covers [o N, (o+1) N) in units of 1/W texel: N texels on W pixels.
AxisWeights nearest_weights(std::uint64_t texels, std::uint64_t pixels) {
  AxisWeights axis;
  axis.sum = static_cast<double>(texels);
  axis.windows.resize(pixels);
  for (std::uint64_t o = 0; o < pixels; ++o) {
    const std::uint64_t begin = o * texels;
    const std::uint64_t end = begin + texels;
    Window& window = axis.windows[o];
    window.first = static_cast<std::uint32_t>(begin / pixels);
    for (std::uint64_t i = window.first; i * pixels < end; ++i) {
      const std::uint64_t overlap = std::min((i + 1) * pixels, end) - std::max(i * pixels, begin);
      window.weights.push_back(static_cast<double>(overlap));
    }
  }
  return axis;
}

// 8 W^2 times the integral, in texels, of the weight of texel i of N from its left end to t / (2W) texels right of its
// centre: the hat 1 - |t| / (2W), which stays 1 beyond the outermost texels.
std::int64_t hat_integral(std::int64_t t, std::int64_t i, std::int64_t texels, std::int64_t half_width) {
  const bool left_border = i == 0;
  const bool right_border = i == texels - 1;
  const std::int64_t square = half_width * half_width;
  if (t <= 0) {
    if (left_border) return square + 2 * half_width * t;
    const std::int64_t rise = std::max<std::int64_t>(half_width + t, 0);
    return rise * rise;
  }
  if (right_border) return square + 2 * half_width * t;
  const std::int64_t fall = std::max<std::int64_t>(half_width - t, 0);
  return 2 * square - fall * fall;
}

// In units of 1/(2W) texel: the centre of texel i at (2i+1) W, its hat 2W to each side, pixel o over [2oN, 2(o+1)N).
AxisWeights bilinear_weights(std::int64_t texels, std::int64_t pixels) {
  AxisWeights axis;
  axis.sum = 8.0 * static_cast<double>(pixels) * static_cast<double>(texels);
  axis.windows.resize(static_cast<std::size_t>(pixels));
  for (std::int64_t o = 0; o < pixels; ++o) {
    const std::int64_t begin = 2 * o * texels;
    const std::int64_t end = begin + 2 * texels;
    Window& window = axis.windows[static_cast<std::size_t>(o)];
    const std::int64_t first = std::max<std::int64_t>(begin / (2 * pixels) - 1, 0);
    const std::int64_t last = std::min<std::int64_t>((end - 1) / (2 * pixels) + 1, texels - 1);
    window.first = static_cast<std::uint32_t>(first);
    for (std::int64_t i = first; i <= last; ++i) {
      const std::int64_t centre = (2 * i + 1) * pixels;
      window.weights.push_back(static_cast<double>(hat_integral(end - centre, i, texels, 2 * pixels) -
                                                   hat_integral(begin - centre, i, texels, 2 * pixels)));
    }
  }
  return axis;
}

AxisWeights axis_weights(std::uint32_t texels, std::uint32_t pixels, Interpolation interpolation) {
  return interpolation == Interpolation::nearest ? nearest_weights(texels, pixels) : bilinear_weights(texels, pixels);
}

// Adds the sum of `Rows` rows of floats, `stride` apart, to `column`. Three rows at a time read memory faster than one
// after the other (and than five: too many streams for the prefetcher).
template <int Rows>
void add_rows(const float* row, std::size_t stride, std::size_t count, double* column) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    double sum = double{row[i]};
    for (int k = 1; k < Rows; ++k) sum += double{row[static_cast<std::size_t>(k) * stride + i]};
    column[i] += sum;
  }
}

}  // namespace

namespace detail {

Image weighted_mean(const Image& image, Extent to, Interpolation interpolation) {
  const std::uint32_t channels = image.channels;
  const AxisWeights across = axis_weights(image.size.width, to.width, interpolation);
  const AxisWeights down = axis_weights(image.size.height, to.height, interpolation);
  const double total = across.sum * down.sum;
  const std::size_t row_size = std::size_t{image.size.width} * channels;
  Image mean(to, channels);
#pragma omp parallel
  {
    std::vector<double> column(row_size);
#pragma omp for schedule(static)
    for (std::uint32_t oy = 0; oy < to.height; ++oy) {
      std::fill(column.begin(), column.end(), 0.0);
      const Window& rows = down.windows[oy];
      for (std::size_t k = 0; k < rows.weights.size(); ++k) {
        const double weight = rows.weights[k];
        const float* row = image.texels.data() + (rows.first + k) * row_size;
#pragma omp simd
        for (std::size_t i = 0; i < row_size; ++i) column[i] += weight * double{row[i]};
      }
      for (std::uint32_t ox = 0; ox < to.width; ++ox) {
        const Window& columns = across.windows[ox];
        for (std::uint32_t c = 0; c < channels; ++c) {
          const double* from = column.data() + std::size_t{columns.first} * channels + c;
          double sum = 0;
          for (std::size_t k = 0; k < columns.weights.size(); ++k) sum += columns.weights[k] * from[k * channels];
          mean.texel(ox, oy)[c] = static_cast<float>(sum / total);
        }
      }
    }
  }
  return mean;
}

Image block_mean(const Image& image, Extent to) {
  const std::uint32_t channels = image.channels;
  const std::uint32_t block_width = image.size.width / to.width;
  const std::uint32_t block_height = image.size.height / to.height;
  assert(block_width * to.width == image.size.width && block_height * to.height == image.size.height);
  const double total = static_cast<double>(block_width) * block_height;
  const std::size_t row_size = std::size_t{image.size.width} * channels;
  Image mean(to, channels);
#pragma omp parallel
  {
    std::vector<double> column(row_size);
#pragma omp for schedule(static)
    for (std::uint32_t oy = 0; oy < to.height; ++oy) {
      std::fill(column.begin(), column.end(), 0.0);
      const float* row = image.texels.data() + std::size_t{oy} * block_height * row_size;
      std::uint32_t left = block_height;
      for (; left >= 3; left -= 3, row += 3 * row_size) add_rows<3>(row, row_size, row_size, column.data());
      for (; left >= 1; left -= 1, row += row_size) add_rows<1>(row, row_size, row_size, column.data());
      for (std::uint32_t ox = 0; ox < to.width; ++ox) {
        std::array<double, 3> sum{};
        const double* from = column.data() + std::size_t{ox} * block_width * channels;
        for (std::uint32_t k = 0; k < block_width; ++k) {
          for (std::uint32_t c = 0; c < channels; ++c) sum[c] += from[std::size_t{k} * channels + c];
        }
        for (std::uint32_t c = 0; c < channels; ++c) mean.texel(ox, oy)[c] = static_cast<float>(sum[c] / total);
      }
    }
  }
  return mean;
}

}  // namespace detail

GroundTruth exact_truth(const Image& image, Extent to, Interpolation interpolation) {
  assert(image.size.area() > 0 && to.area() > 0);
  // The integer weights: 4 (2W)^2 must fit into 63 bits, their products into the 53 of a double.
  assert(image.size.width <= 1U << 24 && image.size.height <= 1U << 24 && to.width <= 1U << 24 &&
         to.height <= 1U << 24);
  const bool whole = image.size.width % to.width == 0 && image.size.height % to.height == 0;
  GroundTruth truth;
  truth.method = "exact";
  truth.image = whole && interpolation == Interpolation::nearest ? detail::block_mean(image, to)
                                                                 : detail::weighted_mean(image, to, interpolation);
  return truth;
}

GroundTruth monte_carlo_truth(const Integrand& integrand, std::uint64_t spp, std::uint64_t seed) {
  if (spp < 2) {
    throw ConfigError("truth monte_carlo:" + std::to_string(spp) +
                      ": one sample has no standard error; give at least 2 samples per pixel, e.g. monte_carlo:1000");
  }
  const Extent plane = integrand.plane();
  const std::uint32_t channels = integrand.channels();
  GroundTruth truth;
  truth.method = "monte_carlo:" + std::to_string(spp);
  truth.image = Image(plane, channels);
  truth.standard_error = Image(plane, channels);
  constexpr std::uint64_t chunk = 1024;
  const auto n = static_cast<double>(spp);
#pragma omp parallel
  {
    std::vector<Vec2f> position(std::min(chunk, spp));
    std::vector<float> values(position.size() * channels);
#pragma omp for schedule(static)
    for (std::uint32_t y = 0; y < plane.height; ++y) {
      for (std::uint32_t x = 0; x < plane.width; ++x) {
        const std::size_t pixel = std::size_t{y} * plane.width + x;
        Rng rng(seed, stream_id("monte_carlo_truth"), pixel);
        // Sums of the deviations from the first value and of their squares: a large common part does not cancel.
        std::array<double, 3> origin{};
        std::array<double, 3> sum{};
        std::array<double, 3> squares{};
        for (std::uint64_t done = 0; done < spp; done += chunk) {
          const auto count = static_cast<std::size_t>(std::min(chunk, spp - done));
          for (std::size_t i = 0; i < count; ++i) position[i] = to_pixel(rng.uniform2(), x, y);
          integrand.evaluate({position.data(), count}, {values.data(), count * channels});
          if (done == 0) {
            for (std::uint32_t c = 0; c < channels; ++c) origin[c] = double{values[c]};
          }
          for (std::size_t i = 0; i < count; ++i) {
            for (std::uint32_t c = 0; c < channels; ++c) {
              const double deviation = double{values[i * channels + c]} - origin[c];
              sum[c] += deviation;
              squares[c] += deviation * deviation;
            }
          }
        }
        for (std::uint32_t c = 0; c < channels; ++c) {
          const double variance = std::max(squares[c] - sum[c] * sum[c] / n, 0.0) / (n - 1);
          truth.image.texels[pixel * channels + c] = static_cast<float>(origin[c] + sum[c] / n);
          truth.standard_error.texels[pixel * channels + c] = static_cast<float>(std::sqrt(variance / n));
        }
      }
    }
  }
  return truth;
}

double standard_error_rms(const GroundTruth& truth) {
  if (truth.standard_error.texels.empty()) return 0;
  double sum = 0;
  for (const float error : truth.standard_error.texels) sum += static_cast<double>(error) * static_cast<double>(error);
  return std::sqrt(sum / static_cast<double>(truth.standard_error.texels.size()));
}

}  // namespace abn::harness
