#include "harness/filtered_truth.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "sampling/error.h"
#include "sampling/vector_clones.h"

namespace abn::harness {
namespace {

/// The integral of `function` from a to b by eight Gauss-Legendre nodes.
double gauss_legendre(double a, double b, const auto& function) {
  constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                          0.9602898564975363};
  constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                            0.1012285362903763};
  const double centre = 0.5 * (a + b);
  const double half = 0.5 * (b - a);
  double sum = 0;
  for (std::size_t i = 0; i < node.size(); ++i) {
    sum += weight[i] * (function(centre - half * node[i]) + function(centre + half * node[i]));
  }
  return half * sum;
}

/// An axis of the image against the same axis of the plane: where texels lie, seen from the centre of a pixel [px].
/// Numerators are whole numbers, so that a position is rounded once.
struct Axis {
  std::int64_t texels, pixels;

  /// The position of `halves` / 2 texels from the image's border.
  double from_centre(std::int64_t halves, std::int64_t pixel) const {
    return static_cast<double>(halves * pixels - (2 * pixel + 1) * texels) / static_cast<double>(2 * texels);
  }
  double border(std::int64_t texel, std::int64_t pixel) const { return from_centre(2 * texel, pixel); }
  double centre(std::int64_t texel, std::int64_t pixel) const { return from_centre(2 * texel + 1, pixel); }
  /// The texel that contains a position `offset` from a pixel's centre; may lie beyond the image.
  std::int64_t texel_at(double offset, std::int64_t pixel) const {
    const double place = (static_cast<double>(pixel) + 0.5 + offset) * static_cast<double>(texels);
    return static_cast<std::int64_t>(std::floor(place / static_cast<double>(pixels)));
  }
};

/// The weights of the texels that one pixel of an axis sees.
struct Window {
  std::size_t first = 0;        // texel
  std::vector<double> weights;  // of texels first, first + 1, ...; their sum is 1
};

Window nearest_window(const Axis& axis, std::int64_t pixel, const PixelFilter& filter) {
  const std::int64_t last = axis.texels - 1;
  // One texel more on either side: texel_at() is rounded.
  const std::int64_t begin = std::clamp<std::int64_t>(axis.texel_at(-filter.radius(), pixel) - 1, 0, last);
  const std::int64_t end = std::clamp<std::int64_t>(axis.texel_at(filter.radius(), pixel) + 1, 0, last);
  Window window;
  window.first = static_cast<std::size_t>(begin);
  double before = 0;
  for (std::int64_t i = begin; i <= end; ++i) {
    const double after = i == end ? 1 : filter.integral(axis.border(i + 1, pixel));
    window.weights.push_back(after - before);
    before = after;
  }
  return window;
}

/// The integral of (x - origin) g(x) from a to b, with g's own integral to tell how finely it has to be cut.
double first_moment(const PixelFilter& filter, double a, double b, double origin, int depth = 0) {
  const double mass = filter.integral(b) - filter.integral(a);
  const double estimate = gauss_legendre(a, b, [&](double x) { return filter.profile(x); });
  if (depth < 30 && std::abs(estimate - mass) > 1e-14) {
    const double middle = 0.5 * (a + b);
    return first_moment(filter, a, middle, origin, depth + 1) + first_moment(filter, middle, b, origin, depth + 1);
  }
  return gauss_legendre(a, b, [&](double x) { return (x - origin) * filter.profile(x); });
}

Window bilinear_window(const Axis& axis, std::int64_t pixel, const PixelFilter& filter) {
  const std::int64_t last = axis.texels - 1;
  const double radius = filter.radius();
  const std::int64_t begin = std::clamp<std::int64_t>(axis.texel_at(-radius, pixel) - 1, 0, last);
  const std::int64_t end = std::clamp<std::int64_t>(axis.texel_at(radius, pixel) + 1, 0, last);
  const double spacing = static_cast<double>(axis.pixels) / static_cast<double>(axis.texels);
  Window window;
  window.first = static_cast<std::size_t>(begin);
  window.weights.assign(static_cast<std::size_t>(end - begin + 1), 0);
  window.weights.front() += filter.integral(axis.centre(begin, pixel));
  window.weights.back() += 1 - filter.integral(axis.centre(end, pixel));
  for (std::int64_t i = begin; i < end; ++i) {
    const double from = std::max(axis.centre(i, pixel), -radius);
    const double to = std::min(axis.centre(i + 1, pixel), radius);
    if (from >= to) continue;
    double moment = 0;
    double a = from;
    for (const double kink : {-1.0, 0.0, 1.0, radius}) {  // where filters are not smooth
      const double b = std::min(kink, to);
      if (b <= a) continue;
      moment += first_moment(filter, a, b, axis.centre(i, pixel));
      a = b;
    }
    const double right = moment / spacing;
    const auto slot = static_cast<std::size_t>(i - begin);
    window.weights[slot] += filter.integral(to) - filter.integral(from) - right;
    window.weights[slot + 1] += right;
  }
  return window;
}

std::vector<Window> axis_windows(const Axis& axis, const PixelFilter& filter, Interpolation interpolation) {
  std::vector<Window> windows(static_cast<std::size_t>(axis.pixels));
  const auto make = interpolation == Interpolation::nearest ? nearest_window : bilinear_window;
#pragma omp parallel for schedule(static)
  for (std::int64_t o = 0; o < axis.pixels; ++o) windows[static_cast<std::size_t>(o)] = make(axis, o, filter);
  return windows;
}

/// sum[i] = sum over k of weights[k] * rows[k * stride + i].
ABN_VECTOR_CLONES
void weighted_rows(const float* rows, std::size_t stride, const std::vector<double>& weights, std::size_t count,
                   double* sum) {
  std::fill_n(sum, count, 0.0);
  std::size_t k = 0;
  for (; k + 4 <= weights.size(); k += 4) {
    const float* r0 = rows + k * stride;
    const float* r1 = r0 + stride;
    const float* r2 = r1 + stride;
    const float* r3 = r2 + stride;
    const double w0 = weights[k];
    const double w1 = weights[k + 1];
    const double w2 = weights[k + 2];
    const double w3 = weights[k + 3];
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) {
      sum[i] += (w0 * double{r0[i]} + w1 * double{r1[i]}) + (w2 * double{r2[i]} + w3 * double{r3[i]});
    }
  }
  for (; k < weights.size(); ++k) {
    const float* row = rows + k * stride;
    const double weight = weights[k];
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) sum[i] += weight * double{row[i]};
  }
}

/// First down, then across. Tiles of columns stay in the cache while the overlapping windows of successive pixels read
/// them; bands of pixel rows bound the memory.
Image separable_truth(const Image& image, Extent to, const std::vector<Window>& across,
                      const std::vector<Window>& down) {
  constexpr std::size_t tile = 1024;
  constexpr std::size_t band = 64;
  const std::uint32_t channels = image.channels;
  const std::size_t row_size = std::size_t{image.size.width} * channels;
  const std::size_t tiles = (row_size + tile - 1) / tile;
  std::vector<double> columns(std::min<std::size_t>(band, to.height) * row_size);
  Image truth(to, channels);
  for (std::size_t top = 0; top < to.height; top += band) {
    const std::size_t rows = std::min(band, to.height - top);
#pragma omp parallel
    {
#pragma omp for schedule(dynamic)
      for (std::size_t t = 0; t < tiles; ++t) {
        const std::size_t left = t * tile;
        for (std::size_t k = 0; k < rows; ++k) {
          const Window& window = down[top + k];
          weighted_rows(image.texels.data() + window.first * row_size + left, row_size, window.weights,
                        std::min(tile, row_size - left), columns.data() + k * row_size + left);
        }
      }
#pragma omp for schedule(static)
      for (std::size_t k = 0; k < rows; ++k) {
        for (std::uint32_t ox = 0; ox < to.width; ++ox) {
          const Window& window = across[ox];
          std::array<double, 3> sum{};
          const double* from = columns.data() + k * row_size + window.first * channels;
          for (const double weight : window.weights) {
            for (std::uint32_t c = 0; c < channels; ++c) sum[c] += weight * from[c];
            from += channels;
          }
          float* pixel = truth.texel(ox, static_cast<std::uint32_t>(top + k));
          for (std::uint32_t c = 0; c < channels; ++c) pixel[c] = static_cast<float>(sum[c]);
        }
      }
    }
  }
  return truth;
}

/// f = c exp(-k r^2) for r <= radius, integrated over texels. All that is not elementary is a function of one
/// coordinate: the integral of f up to the circle, arc(y) = c times the integral of exp(-k t^2) half(sqrt(R^2 - t^2))
/// over t in [0, y], by quadrature in the angle t = R sin(a), where it is smooth.
class Disc {
 public:
  explicit Disc(const PixelFilter& filter) : radius_(filter.radius()), peak_(filter.value(0, 0)) {
    double x = radius_ * (1 - 1e-9);
    while (filter.value(x, 0) < 1e-100 * peak_) x *= 0.5;
    // A disc much smaller than sigma is flat; the lower bound keeps half() defined there.
    root_ = std::max(std::sqrt(std::max(0.0, std::log(peak_ / filter.value(x, 0)))) / x, 1e-9 / radius_);
    const auto pieces = static_cast<std::size_t>(std::ceil(8 + 5 * radius_ * root_));
    step_ = 0.5 * std::numbers::pi / static_cast<double>(pieces);
    before_.assign(pieces + 1, 0);
    for (std::size_t i = 0; i < pieces; ++i) {
      const auto at = static_cast<double>(i);
      before_[i + 1] = before_[i] + piece(step_ * at, step_ * (at + 1));
    }
  }
  double radius() const { return radius_; }
  double peak() const { return peak_; }
  /// The integral of exp(-k t^2) over t in [0, x].
  double half(double x) const { return std::erf(root_ * x) / (root_ * std::numbers::inv_sqrtpi * 2); }
  double arc(double y) const {
    const double angle = std::asin(std::clamp(std::abs(y) / radius_, 0.0, 1.0));
    const auto i = std::min(static_cast<std::size_t>(angle / step_), before_.size() - 2);
    return std::copysign(before_[i] + piece(step_ * static_cast<double>(i), angle), y);
  }

 private:
  double piece(double from, double to) const {
    return gauss_legendre(from, to, [this](double angle) {
      const double chord = radius_ * std::cos(angle);
      const double t = root_ * radius_ * std::sin(angle);
      return peak_ * std::exp(-t * t) * half(chord) * chord;
    });
  }

  double radius_, peak_;
  double root_ = 0;  // of k
  double step_ = 0;  // [radian]
  std::vector<double> before_;
};

/// A border between texels, seen from a pixel's centre.
struct Edge {
  double at;         // clipped to the disc
  double half, arc;  // half(at), arc(at)
  double chord;      // half the length of the disc's chord through it
  double half_chord, arc_chord;
};

/// The edges around the texels that a pixel's disc touches; the first of these texels.
struct Edges {
  std::int64_t first = 0;  // may lie beyond the image
  std::vector<Edge> edges;
};

Edges disc_edges(const Axis& axis, std::int64_t pixel, const Disc& disc) {
  const double radius = disc.radius();
  Edges result;
  result.first = axis.texel_at(-radius, pixel) - 1;
  const std::int64_t end = axis.texel_at(radius, pixel) + 2;
  for (std::int64_t i = result.first; i <= end; ++i) {
    const double at = std::clamp(axis.border(i, pixel), -radius, radius);
    const double chord = std::sqrt(std::max(0.0, (radius - at) * (radius + at)));
    result.edges.push_back({at, disc.half(at), disc.arc(at), chord, disc.half(chord), disc.arc(chord)});
  }
  return result;
}

/// The integral of f over x in [0, edge] and the rows from `top` to `bottom`: straight where the chord is longer than
/// the edge is far, up to the circle elsewhere.
double area_up_to(const Disc& disc, const Edge& edge, const Edge& top, const Edge& bottom) {
  const auto inner = [&edge](const Edge& y) {
    if (y.at > edge.chord) return std::pair(edge.half_chord, edge.arc_chord);
    if (y.at < -edge.chord) return std::pair(-edge.half_chord, -edge.arc_chord);
    return std::pair(y.half, y.arc);
  };
  const auto [half_top, arc_top] = inner(top);
  const auto [half_bottom, arc_bottom] = inner(bottom);
  const double circle = (bottom.arc - top.arc) - (arc_bottom - arc_top);
  return disc.peak() * edge.half * (half_bottom - half_top) + std::copysign(circle, edge.at);
}

/// The weights of the texels around a pixel, row by row.
struct Kernel {
  std::int64_t first_x = 0, first_y = 0;
  std::size_t width = 0, height = 0;
  std::vector<double> weights;
};

Kernel disc_kernel(const Disc& disc, const Edges& across, const Edges& down) {
  Kernel kernel{across.first, down.first, across.edges.size() - 1, down.edges.size() - 1, {}};
  for (std::size_t y = 0; y < kernel.height; ++y) {
    double before = area_up_to(disc, across.edges[0], down.edges[y], down.edges[y + 1]);
    for (std::size_t x = 0; x < kernel.width; ++x) {
      const double after = area_up_to(disc, across.edges[x + 1], down.edges[y], down.edges[y + 1]);
      kernel.weights.push_back(after - before);
      before = after;
    }
  }
  return kernel;
}

/// One pixel; the kernel of its class is moved by whole texels. Each row's sum on its own keeps the chain of additions
/// short.
template <std::uint32_t Channels>
void apply(const Kernel& kernel, const Image& image, std::int64_t shift_x, std::int64_t shift_y, float* pixel) {
  const std::int64_t last_x = std::int64_t{image.size.width} - 1;
  const std::int64_t last_y = std::int64_t{image.size.height} - 1;
  const std::int64_t left = kernel.first_x + shift_x;
  const bool inside = left >= 0 && left + static_cast<std::int64_t>(kernel.width) - 1 <= last_x;
  std::array<double, Channels> sum{};
  for (std::size_t j = 0; j < kernel.height; ++j) {
    const double* weight = kernel.weights.data() + j * kernel.width;
    const auto y = std::clamp<std::int64_t>(kernel.first_y + shift_y + static_cast<std::int64_t>(j), 0, last_y);
    const float* row = image.texel(0, static_cast<std::uint32_t>(y));
    std::array<double, Channels> row_sum{};
    if (inside) {
      const float* texel = row + static_cast<std::size_t>(left) * Channels;
      for (std::size_t i = 0; i < kernel.width; ++i) {
        for (std::size_t c = 0; c < Channels; ++c) row_sum[c] += weight[i] * double{texel[i * Channels + c]};
      }
    } else {
      for (std::size_t i = 0; i < kernel.width; ++i) {
        const auto x = std::clamp<std::int64_t>(left + static_cast<std::int64_t>(i), 0, last_x);
        const float* texel = row + static_cast<std::size_t>(x) * Channels;
        for (std::size_t c = 0; c < Channels; ++c) row_sum[c] += weight[i] * double{texel[c]};
      }
    }
    for (std::size_t c = 0; c < Channels; ++c) sum[c] += row_sum[c];
  }
  for (std::size_t c = 0; c < Channels; ++c) pixel[c] = static_cast<float>(sum[c]);
}

/// Pixels a period apart see the same texel borders: one kernel per residue class in each direction.
Image disc_truth(const Image& image, Extent to, const PixelFilter& filter) {
  const Disc disc(filter);
  const Axis across{image.size.width, to.width};
  const Axis down{image.size.height, to.height};
  const std::int64_t period_x = across.pixels / std::gcd(across.pixels, across.texels);
  const std::int64_t period_y = down.pixels / std::gcd(down.pixels, down.texels);
  const std::int64_t texels_x = period_x * across.texels / across.pixels;
  const std::int64_t texels_y = period_y * down.texels / down.pixels;
  std::vector<Edges> columns;
  for (std::int64_t x = 0; x < period_x; ++x) columns.push_back(disc_edges(across, x, disc));
  std::vector<Kernel> kernels(columns.size());
  const auto apply_channels = image.channels == 1 ? apply<1> : apply<3>;
  Image truth(to, image.channels);
  for (std::int64_t class_y = 0; class_y < period_y; ++class_y) {
    const Edges rows = disc_edges(down, class_y, disc);
    const std::int64_t count = (down.pixels - class_y + period_y - 1) / period_y;
#pragma omp parallel
    {
#pragma omp for schedule(static)
      for (std::size_t x = 0; x < kernels.size(); ++x) kernels[x] = disc_kernel(disc, columns[x], rows);
#pragma omp for schedule(static) collapse(2)
      for (std::int64_t k = 0; k < count; ++k) {
        for (std::int64_t x = 0; x < across.pixels; ++x) {
          apply_channels(
              kernels[static_cast<std::size_t>(x % period_x)], image, x / period_x * texels_x, k * texels_y,
              truth.texel(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(class_y + k * period_y)));
        }
      }
    }
  }
  return truth;
}

}  // namespace

GroundTruth filtered_truth(const Image& image, Extent to, const PixelFilter& filter, Interpolation interpolation) {
  assert(image.size.area() > 0 && to.area() > 0);
  GroundTruth truth;
  truth.method = "exact";
  if (filter.disc()) {
    if (interpolation != Interpolation::nearest) {
      throw ConfigError("--filter " + filter.words() +
                        " with --integrand bilinear has no exact truth; use support=square, or --integrand nearest");
    }
    truth.image = disc_truth(image, to, filter);
    return truth;
  }
  truth.image = separable_truth(image, to, axis_windows({image.size.width, to.width}, filter, interpolation),
                                axis_windows({image.size.height, to.height}, filter, interpolation));
  return truth;
}

}  // namespace abn::harness
