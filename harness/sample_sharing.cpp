#include "harness/sample_sharing.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "harness/density_reconstruction.h"
#include "harness/sample_bins.h"

namespace abn::harness {
namespace {

constexpr double least_share = 0.1;

struct FilterSum {
  std::array<double, 3> value{};  // sum w f v
  double weight = 0;              // sum w f
  double magnitude = 0;           // sum w |f|
};

/// The indices of the samples of weight > 0, sorted by the row of pixels they lie in, else in the order added.
struct Rows {
  std::vector<std::uint32_t> sample;
  std::vector<std::size_t> start;  // [height + 1]
};

Rows sort_by_row(const KeptSamples& kept, Extent plane) {
  const auto row_of = [&](std::size_t i) {
    return std::min(static_cast<std::uint32_t>(std::max(kept.position[i].y, 0.0F)), plane.height - 1);
  };
  Rows rows;
  rows.start.assign(std::size_t{plane.height} + 1, 0);
  for (std::size_t i = 0; i < kept.position.size(); ++i) {
    if (kept.weight[i] > 0) ++rows.start[row_of(i) + 1];
  }
  for (std::size_t y = 0; y < plane.height; ++y) rows.start[y + 1] += rows.start[y];
  rows.sample.resize(rows.start.back());
  std::vector<std::size_t> next(rows.start.begin(), rows.start.end() - 1);
  for (std::size_t i = 0; i < kept.position.size(); ++i) {
    if (kept.weight[i] > 0) rows.sample[next[row_of(i)]++] = static_cast<std::uint32_t>(i);
  }
  return rows;
}

/// A coordinate of a sample, and what it stands for beyond the borders, as the pixels of an axis see it. An image is
/// never nearer to a pixel than the sample itself, so that it covers no others.
struct Reach {
  static constexpr std::size_t most = 17;  // pixels that a filter of radius 8 covers

  std::int64_t first = 0;              // pixel within [low, high)
  std::size_t count = 0;               // of pixels
  std::array<double, most> profile{};  // of every pixel, summed over the images; unless the filter is a disc
  std::array<double, 3> image{};       // the sample and its images, seen from the centre of pixel 0
  std::array<double, 3> weight{1, 0, 0};
  std::size_t images = 1;

  Reach(const PixelFilter& filter, float position, std::int64_t low, std::int64_t high, double length, double stretch) {
    const double radius = filter.radius();
    const double at = double{position};
    image[0] = at - 0.5;
    first = std::max(low, static_cast<std::int64_t>(std::ceil(image[0] - radius)));
    const auto last = std::min(high - 1, static_cast<std::int64_t>(std::floor(image[0] + radius)));
    count = last < first ? 0 : static_cast<std::size_t>(last - first + 1);
    assert(count <= most);
    const double beyond = radius - 0.5;  // the outermost centres are half a pixel inside
    for (const auto& [inside, sign, border] : {std::tuple(at, -1.0, 0.0), std::tuple(length - at, 1.0, length)}) {
      // An image on the border itself would be the sample again.
      if (!(inside > 0 && inside * stretch < beyond)) continue;
      image[images] = border + sign * inside * stretch - 0.5;
      weight[images++] = stretch;
    }
    if (filter.disc()) return;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < images; ++k) profile[i] += weight[k] * filter.profile(distance(i, k));
    }
  }
  /// Of image k from the centre of the i-th pixel.
  double distance(std::size_t i, std::size_t k) const {
    return image[k] - static_cast<double>(first + static_cast<std::int64_t>(i));
  }
};

/// The disc at the i-th pixel across and the j-th down.
double disc_value(const PixelFilter& filter, const Reach& across, std::size_t i, const Reach& down, std::size_t j) {
  double sum = 0;
  for (std::size_t l = 0; l < down.images; ++l) {
    for (std::size_t k = 0; k < across.images; ++k) {
      sum += across.weight[k] * down.weight[l] * filter.value(across.distance(i, k), down.distance(j, l));
    }
  }
  return sum;
}

}  // namespace

Developed share_samples(const Film& film, const PixelFilter& filter, bool by_density) {
  const KeptSamples& kept = film.kept();
  assert(kept.position.size() == film.samples());
  const Extent plane = film.sums().size();
  const std::uint32_t channels = film.channels();
  const Rows rows = sort_by_row(kept, plane);
  std::vector<float> weights = kept.weight;
  if (by_density) {
    const SampleBins bins(film);
    const std::vector<float> density = sample_densities(bins);
    for (std::size_t i = 0; i < bins.size(); ++i) weights[bins.added(i)] /= density[i];
  }
  const bool disc = filter.disc();
  const double spp = static_cast<double>(rows.sample.size()) / static_cast<double>(plane.area());
  // The squared error of a border pixel is a bias ~ 1 / stretch^2 and a variance ~ stretch / spp: least at the cube
  // root.
  const double stretch = std::max(1.0, std::cbrt(spp));
  Developed developed;
  developed.samples = film.samples();
  developed.image = Image(plane, channels);
  Grid<std::uint8_t> covered(plane);

  // Every band of pixel rows is one thread's: it looks at all samples near, in a fixed order.
  constexpr std::int64_t band = 16;
  const auto width = std::int64_t{plane.width};
  const auto height = std::int64_t{plane.height};
  const auto margin = static_cast<std::int64_t>(std::ceil(filter.radius() + 0.5));
#pragma omp parallel for schedule(dynamic)
  for (std::int64_t top = 0; top < height; top += band) {
    const std::int64_t bottom = std::min(top + band, height);
    std::vector<FilterSum> sums(static_cast<std::size_t>((bottom - top) * width));
    const std::size_t begin = rows.start[static_cast<std::size_t>(std::max<std::int64_t>(top - margin, 0))];
    const std::size_t end = rows.start[static_cast<std::size_t>(std::min(bottom + margin, height))];
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t sample = rows.sample[s];
      const Vec2f at = kept.position[sample];
      const double weight = double{weights[sample]};
      const float* value = kept.value.data() + sample * channels;
      const Reach down(filter, at.y, top, bottom, plane.height, stretch);
      if (down.count == 0) continue;
      const Reach across(filter, at.x, 0, width, plane.width, stretch);
      for (std::size_t j = 0; j < down.count; ++j) {
        const auto row = static_cast<std::size_t>((down.first + static_cast<std::int64_t>(j) - top) * width);
        FilterSum* sum = sums.data() + row + static_cast<std::size_t>(across.first);
        for (std::size_t i = 0; i < across.count; ++i) {
          const double f = disc ? disc_value(filter, across, i, down, j) : across.profile[i] * down.profile[j];
          const double wf = weight * f;
          sum[i].weight += wf;
          sum[i].magnitude += std::abs(wf);
          for (std::uint32_t c = 0; c < channels; ++c) sum[i].value[c] += wf * double{value[c]};
        }
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const FilterSum& sum = sums[i];
      if (!(sum.weight > least_share * sum.magnitude)) continue;
      const std::size_t pixel = static_cast<std::size_t>(top * width) + i;
      covered[pixel] = 1;
      for (std::uint32_t c = 0; c < channels; ++c) {
        developed.image.texels[pixel * channels + c] = static_cast<float>(sum.value[c] / sum.weight);
      }
    }
  }
  for (const PixelSum& sum : film.sums().cells())
    developed.max_samples_per_pixel = std::max(developed.max_samples_per_pixel, sum.count);
  developed.empty_pixels = fill_empty(developed.image, covered);
  return developed;
}

}  // namespace abn::harness
