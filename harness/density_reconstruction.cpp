#include "harness/density_reconstruction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace abn::harness {
namespace {

constexpr std::size_t neighbours = 12;
constexpr std::size_t chunk = 1024;  // samples
constexpr float least_support = 1e-4F;

/// Squared distances of the samples near one point, the nearest `neighbours` of them in order.
class Nearest {
 public:
  void clear() {
    count_ = 0;
    distance_.fill(std::numeric_limits<float>::max());
  }
  void add(float squared) {
    if (!(squared < distance_.back())) return;
    std::size_t k = distance_.size() - 1;
    for (; k > 0 && distance_[k - 1] > squared; --k) distance_[k] = distance_[k - 1];
    distance_[k] = squared;
    count_ = std::min(count_ + 1, distance_.size());
  }
  bool full() const { return count_ == distance_.size(); }
  std::size_t count() const { return count_; }
  float farthest() const { return distance_[count_ - 1]; }
  float operator[](std::size_t k) const { return distance_[k]; }

 private:
  std::array<float, neighbours + 1> distance_{};  // the point itself is one of them
  std::size_t count_ = 0;
};

class DensityEstimator {
 public:
  explicit DensityEstimator(const SampleBins& bins) : bins_(bins) {}

  float at(std::size_t i) {
    const float x = bins_.x()[i];
    const float y = bins_.y()[i];
    const Extent plane = bins_.plane();
    const auto width = static_cast<float>(plane.width);
    const auto height = static_cast<float>(plane.height);
    const auto px = static_cast<std::int64_t>(std::clamp(x, 0.0F, just_below(width)));
    const auto py = static_cast<std::int64_t>(std::clamp(y, 0.0F, just_below(height)));
    // Rings of pixels around the sample's own, mirrored ones included, until none farther out can be nearer.
    nearest_.clear();
    const auto last = static_cast<std::int64_t>(std::max(plane.width, plane.height));
    for (std::int64_t ring = 0; ring <= last; ++ring) {
      const float covered =
          static_cast<float>(ring - 1) + std::min({x - static_cast<float>(px), static_cast<float>(px + 1) - x,
                                                   y - static_cast<float>(py), static_cast<float>(py + 1) - y});
      if (nearest_.full() && covered > 0 && nearest_.farthest() <= covered * covered) break;
      for (std::int64_t v = py - ring; v <= py + ring; ++v) {
        const bool whole = v == py - ring || v == py + ring;
        for (std::int64_t u = px - ring; u <= px + ring; u += whole || ring == 0 ? 1 : 2 * ring) {
          add_pixel(u, v, x, y);
        }
      }
    }
    return density(nearest_);
  }

 private:
  // The samples of pixel (u, v), which may be the mirror image of one of the plane's; beyond one reflection nothing.
  void add_pixel(std::int64_t u, std::int64_t v, float x, float y) {
    const Extent plane = bins_.plane();
    const auto width = static_cast<std::int64_t>(plane.width);
    const auto height = static_cast<std::int64_t>(plane.height);
    const std::int64_t a = u < 0 ? -1 - u : u >= width ? 2 * width - 1 - u : u;
    const std::int64_t b = v < 0 ? -1 - v : v >= height ? 2 * height - 1 - v : v;
    if (a < 0 || a >= width || b < 0 || b >= height) return;
    const std::size_t p = static_cast<std::size_t>(b) * plane.width + static_cast<std::size_t>(a);
    const float mirror_x = u < 0 ? 0.0F : 2 * static_cast<float>(width);
    const float mirror_y = v < 0 ? 0.0F : 2 * static_cast<float>(height);
    for (std::uint32_t i = bins_.begin(p); i < bins_.end(p); ++i) {
      const float dx = (a == u ? bins_.x()[i] : mirror_x - bins_.x()[i]) - x;
      const float dy = (b == v ? bins_.y()[i] : mirror_y - bins_.y()[i]) - y;
      nearest_.add(dx * dx + dy * dy);
    }
  }

  static float density(const Nearest& nearest) {
    const float support = std::max(std::sqrt(nearest.farthest()), least_support);
    float sum = 0;
    for (std::size_t k = 0; k < nearest.count(); ++k) {
      const float q = std::min(std::sqrt(nearest[k]) / support, 1.0F);
      const float t = (1 - q) * (1 - q);
      sum += t * t * (1 + 4 * q);
    }
    return 7 / std::numbers::pi_v<float> * sum / (support * support);
  }

  const SampleBins& bins_;
  Nearest nearest_;
};

}  // namespace

std::vector<float> sample_densities(const SampleBins& bins) {
  std::vector<float> densities(bins.size());
  const std::size_t chunks = (bins.size() + chunk - 1) / chunk;
#pragma omp parallel
  {
    DensityEstimator estimator(bins);
#pragma omp for schedule(dynamic, 1)
    for (std::size_t c = 0; c < chunks; ++c) {
      for (std::size_t i = c * chunk; i < std::min((c + 1) * chunk, bins.size()); ++i) densities[i] = estimator.at(i);
    }
  }
  return densities;
}

Developed density_weighted(const Film& film) {
  const SampleBins bins(film);
  const std::vector<float> densities = sample_densities(bins);
  Developed developed = developed_for(film);
  const std::uint32_t channels = bins.channels();
  Grid<std::uint8_t> covered(bins.plane());
  for (std::size_t p = 0; p < bins.plane().area(); ++p) {
    if (bins.begin(p) == bins.end(p)) continue;
    covered[p] = 1;
    const float* first = bins.value(bins.begin(p));  // deviations from it are weighted: constants come out exactly
    std::array<double, 3> sum{};
    double weights = 0;
    for (std::uint32_t i = bins.begin(p); i < bins.end(p); ++i) {
      const double weight = 1 / double{densities[i]};
      weights += weight;
      for (std::uint32_t c = 0; c < channels; ++c) sum[c] += weight * (double{bins.value(i)[c]} - double{first[c]});
    }
    for (std::uint32_t c = 0; c < channels; ++c) {
      developed.image.texels[p * channels + c] = static_cast<float>(double{first[c]} + sum[c] / weights);
    }
  }
  developed.empty_pixels = fill_empty(developed.image, covered);
  return developed;
}

}  // namespace abn::harness
