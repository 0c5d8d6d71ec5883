#include "harness/integrand.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstring>

#include "sampling/error.h"

namespace abn::harness {
namespace {

// One axis of the map from the plane to texels.
struct Axis {
  double scale;  // texels per pixel
  double last;   // index of the last texel

  Axis(std::uint32_t texels, std::uint32_t pixels)
      // The quotient is enlarged by 2^-50 so that its rounding never takes a position on a texel border to the texel
      // before. It cannot reach the next texel: x has 24 bits and the sides at most 2^24, so that a product below an
      // integer is below it by more than 2^-48 of itself.
      : scale(static_cast<double>(texels) / pixels * (1.0 + 0x1p-50)), last(static_cast<double>(texels - 1)) {}

  // NaN fails the comparison and becomes 0: no position makes an index outside the image.
  double clamp(double u) const {
    u = u > 0.0 ? u : 0.0;
    return u < last ? u : last;
  }
};

// The address of a sample is computed, and announced to the cache, this many samples before its texel is read, so that
// reads from memory overlap. Measured: 12 is slower, 48 no faster.
constexpr std::size_t lead = 24;

// Calls locate(i) lead samples ahead of take(i, what locate(i) returned), for i = 0 ... count - 1.
template <class Locate, class Take>
void run_ahead(std::size_t count, const Locate& locate, const Take& take) {
  constexpr std::size_t ring_size = std::bit_ceil(lead + 1);
  std::array<decltype(locate(std::size_t{0})), ring_size> ring;
  const std::size_t head = std::min(lead, count);
  for (std::size_t i = 0; i < head; ++i) ring[i] = locate(i);
  for (std::size_t i = 0; i + head < count; ++i) {
    ring[(i + head) % ring_size] = locate(i + head);
    take(i, ring[i % ring_size]);
  }
  for (std::size_t i = count - head; i < count; ++i) take(i, ring[i % ring_size]);
}

template <std::uint32_t Channels>
void evaluate_nearest(const Image& image, Axis ax, Axis ay, std::span<const Vec2f> position, float* values) {
  const float* texels = image.texels.data();
  const std::size_t width = image.size.width;
  const auto locate = [&](std::size_t i) {
    const auto x = static_cast<std::uint32_t>(static_cast<std::int32_t>(ax.clamp(double{position[i].x} * ax.scale)));
    const auto y = static_cast<std::uint32_t>(static_cast<std::int32_t>(ay.clamp(double{position[i].y} * ay.scale)));
    const float* texel = texels + (y * width + x) * Channels;
    __builtin_prefetch(texel);
    return texel;
  };
  const auto take = [&](std::size_t i, const float* texel) {
    std::memcpy(values + i * Channels, texel, Channels * sizeof(float));
  };
  run_ahead(position.size(), locate, take);
}

template <std::uint32_t Channels>
void evaluate_bilinear(const Image& image, Axis ax, Axis ay, std::span<const Vec2f> position, float* values) {
  struct Place {
    const float* top;
    std::size_t right, down;  // to the neighbours
    float fx, fy;
  };
  const std::size_t row = std::size_t{image.size.width} * Channels;
  const auto locate = [&](std::size_t i) -> Place {
    const double u = ax.clamp(double{position[i].x} * ax.scale - 0.5);
    const double v = ay.clamp(double{position[i].y} * ay.scale - 0.5);
    const auto x = static_cast<std::int32_t>(u);
    const auto y = static_cast<std::int32_t>(v);
    const float* top = image.texels.data() + static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x) * Channels;
    // Beside the last texel there is none: its own value again, with weight 0.
    const std::size_t right = static_cast<std::uint32_t>(x) + 1 < image.size.width ? Channels : 0;
    const std::size_t down = static_cast<std::uint32_t>(y) + 1 < image.size.height ? row : 0;
    __builtin_prefetch(top);
    __builtin_prefetch(top + down);
    return {top, right, down, static_cast<float>(u - x), static_cast<float>(v - y)};
  };
  const auto take = [&](std::size_t i, const Place& place) {
    const float* top = place.top;
    const float* bottom = top + place.down;
#pragma GCC unroll 3
    for (std::uint32_t c = 0; c < Channels; ++c) {
      const float a = top[c] + place.fx * (top[place.right + c] - top[c]);
      const float b = bottom[c] + place.fx * (bottom[place.right + c] - bottom[c]);
      values[i * Channels + c] = a + place.fy * (b - a);
    }
  };
  run_ahead(position.size(), locate, take);
}

}  // namespace

Interpolation parse_interpolation(const std::string& word) {
  if (word == "nearest") return Interpolation::nearest;
  if (word == "bilinear") return Interpolation::bilinear;
  throw ConfigError("interpolation '" + word + "' is unknown; known: nearest, bilinear");
}

ImageIntegrand::ImageIntegrand(const Image& image, Extent plane, Interpolation interpolation)
    : image_(image), plane_(plane), interpolation_(interpolation) {
  assert(image.channels == 1 || image.channels == 3);
  assert(image.size.area() > 0 && image.size.width <= 1U << 24 && image.size.height <= 1U << 24);
  assert(plane.area() > 0 && plane.width <= 1U << 24 && plane.height <= 1U << 24);
}

void ImageIntegrand::evaluate(std::span<const Vec2f> position, std::span<float> values) const {
  const std::size_t channels = image_.channels;
  assert(values.size() == position.size() * channels);
  const Axis ax(image_.size.width, plane_.width);
  const Axis ay(image_.size.height, plane_.height);
  const auto function = interpolation_ == Interpolation::nearest
                            ? (channels == 1 ? evaluate_nearest<1> : evaluate_nearest<3>)
                            : (channels == 1 ? evaluate_bilinear<1> : evaluate_bilinear<3>);
  constexpr std::size_t part = std::size_t{1} << 14;  // large enough to be worth a thread
  const std::size_t parts = (position.size() + part - 1) / part;
#pragma omp parallel for schedule(static) if (parts > 1)
  for (std::size_t p = 0; p < parts; ++p) {
    const std::size_t begin = p * part;
    const std::size_t count = std::min(part, position.size() - begin);
    function(image_, ax, ay, position.subspan(begin, count), values.data() + begin * channels);
  }
}

}  // namespace abn::harness
