#include "sampling/adaptive/straight_edges.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

namespace abn {
namespace {

constexpr std::size_t least_samples = 10;
constexpr std::size_t least_class = 3;
constexpr double explained = 0.92;
constexpr double overlap = 0.05;  // [px]

struct Sample {
  double x = 0, y = 0;  // [px], inside the pixel
  double value = 0;
};

/// Sum of squared deviations of the values.
double deviation(std::span<const Sample> samples) {
  double mean = 0;
  for (const Sample& s : samples) mean += s.value;
  mean /= static_cast<double>(samples.size());
  double sum = 0;
  for (const Sample& s : samples) sum += (s.value - mean) * (s.value - mean);
  return sum;
}

/// How many of the samples, ordered by value, form the lower class; 0 if two classes do not explain enough.
std::size_t split(std::span<const Sample> samples, double total) {
  double sum = 0;
  for (const Sample& s : samples) sum += s.value;
  const auto n = static_cast<double>(samples.size());
  double lower = 0;
  double best = 0;
  std::size_t at = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    lower += samples[k - 1].value - sum / n;
    if (samples[k].value <= samples[k - 1].value) continue;
    const double between = lower * lower * n / (static_cast<double>(k) * (n - static_cast<double>(k)));
    if (between > best) {
      best = between;
      at = k;
    }
  }
  return best >= explained * total && at >= least_class && samples.size() - at >= least_class ? at : 0;
}

bool separated(std::span<const Sample> low, std::span<const Sample> high) {
  const auto centre = [](std::span<const Sample> samples) {
    std::array<double, 2> c{};
    for (const Sample& s : samples) {
      c[0] += s.x / static_cast<double>(samples.size());
      c[1] += s.y / static_cast<double>(samples.size());
    }
    return c;
  };
  const auto a = centre(low);
  const auto b = centre(high);
  double xx = 1e-4;  // [px^2], so that classes on a line have a discriminant too
  double yy = 1e-4;
  double xy = 0;
  const auto scatter = [&](std::span<const Sample> samples, const std::array<double, 2>& c) {
    for (const Sample& s : samples) {
      xx += (s.x - c[0]) * (s.x - c[0]);
      yy += (s.y - c[1]) * (s.y - c[1]);
      xy += (s.x - c[0]) * (s.y - c[1]);
    }
  };
  scatter(low, a);
  scatter(high, b);
  const double dx = b[0] - a[0];
  const double dy = b[1] - a[1];
  if (dx * dx + dy * dy < 1e-8) return false;  // one on the other
  double nx = yy * dx - xy * dy;
  double ny = xx * dy - xy * dx;
  const double length = std::sqrt(nx * nx + ny * ny);  // > 0: the scatter is positive definite
  nx /= length;
  ny /= length;
  double most = -1e30;
  double least = 1e30;
  for (const Sample& s : low) most = std::max(most, s.x * nx + s.y * ny);
  for (const Sample& s : high) least = std::min(least, s.x * nx + s.y * ny);
  return least - most > -overlap;
}

}  // namespace

double straight_edge_share(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                           Extent plane) {
  assert(value.size() == position.size() * channels);
  std::vector<std::uint32_t> begin(plane.area() + 1, 0);
  std::vector<std::uint32_t> pixel(position.size());
  for (std::size_t i = 0; i < position.size(); ++i) {
    pixel[i] = static_cast<std::uint32_t>(position[i].y) * plane.width + static_cast<std::uint32_t>(position[i].x);
    ++begin[pixel[i] + 1];
  }
  for (std::size_t p = 0; p < plane.area(); ++p) begin[p + 1] += begin[p];
  std::vector<Sample> sorted(position.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < position.size(); ++i) {
    double mean = 0;
    for (std::uint32_t c = 0; c < channels; ++c) mean += double{value[i * channels + c]} / channels;
    const Vec2f p = position[i];
    sorted[next[pixel[i]]++] = {double{p.x - std::floor(p.x)}, double{p.y - std::floor(p.y)}, mean};
  }
  double all = 0;
  double crossed = 0;
  for (std::size_t p = 0; p < plane.area(); ++p) {
    const std::span<Sample> samples(sorted.data() + begin[p], begin[p + 1] - begin[p]);
    if (samples.size() < 2) continue;
    const double total = deviation(samples);
    if (!(total > 0)) continue;
    const auto n = static_cast<double>(samples.size());
    const double left = total / n * std::pow(n, -1.5);
    all += left;
    if (samples.size() < least_samples) continue;
    std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
      return a.value != b.value ? a.value < b.value : a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    const std::size_t at = split(samples, total);
    if (at > 0 && separated(samples.first(at), samples.subspan(at))) crossed += left;
  }
  return all > 0 ? crossed / all : 0;
}

}  // namespace abn
