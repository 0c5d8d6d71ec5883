#include "harness/film.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <vector>

namespace abn::harness {
namespace {

// The pixel that contains `position`; the nearest one if it lies outside, which the contract excludes.
std::size_t owner(Vec2f position, Extent plane) {
  const auto w = static_cast<float>(plane.width);
  const auto h = static_cast<float>(plane.height);
  assert(position.x >= 0 && position.x < w && position.y >= 0 && position.y < h);
  // NaN fails the comparison and becomes 0.
  const float x = position.x > 0 ? std::min(position.x, w - 1) : 0;
  const float y = position.y > 0 ? std::min(position.y, h - 1) : 0;
  return static_cast<std::size_t>(y) * plane.width + static_cast<std::size_t>(x);
}

template <std::uint32_t Channels>
void add_samples(const SampleBatch& batch, const float* values, Grid<PixelSum>& sums, Grid<PixelStats>& stats) {
  const Extent plane = sums.size();
  // Samples mostly come pixel by pixel: the current pixel stays in registers until another one's turn comes.
  PixelSum sum;
  PixelStats stat;
  std::size_t current = plane.area();
  const auto store = [&] {
    if (current == plane.area()) return;
    sums[current] = sum;
    stats[current] = stat;
  };
  for (std::size_t i = 0; i < batch.position.size(); ++i) {
    const std::size_t p = batch.pixel.empty() ? owner(batch.position[i], plane) : batch.pixel[i];
    assert(p < plane.area());
    if (p != current) {
      store();
      sum = sums[p];
      stat = stats[p];
      current = p;
    }
    const double weight = batch.weight.empty() ? 1.0 : double{batch.weight[i]};
    const float* value = values + i * Channels;
    sum.weight += weight;
    ++sum.count;
#pragma GCC unroll 3
    for (std::uint32_t c = 0; c < Channels; ++c) sum.value[c] += weight * double{value[c]};
    stat.add(luminance(value, Channels));
  }
  store();
}

}  // namespace

Film::Film(Extent plane, std::uint32_t channels, bool keep_samples)
    : channels_(channels), sums_(plane), stats_(plane), keep_samples_(keep_samples) {
  assert(plane.area() > 0 && (channels == 1 || channels == 3));
}

void Film::add(const SampleBatch& batch, std::span<const float> values) {
  assert(values.size() == batch.position.size() * channels_);
  assert(batch.weight.empty() || batch.weight.size() == batch.position.size());
  assert(batch.pixel.empty() || batch.pixel.size() == batch.position.size());
  const auto function = channels_ == 1 ? add_samples<1> : add_samples<3>;
  function(batch, values.data(), sums_, stats_);
  samples_ += batch.position.size();
  if (!keep_samples_) return;
  kept_.position.insert(kept_.position.end(), batch.position.begin(), batch.position.end());
  kept_.value.insert(kept_.value.end(), values.begin(), values.end());
  kept_.weight.insert(kept_.weight.end(), batch.weight.begin(), batch.weight.end());
  kept_.weight.resize(samples_, 1.0F);
  for (std::size_t i = 0; i < batch.position.size(); ++i) {
    kept_.pixel.push_back(batch.pixel.empty() ? static_cast<std::uint32_t>(owner(batch.position[i], sums_.size()))
                                              : batch.pixel[i]);
  }
}

Developed Film::develop() const {
  const Extent plane = sums_.size();
  Developed developed;
  developed.samples = samples_;
  developed.image = Image(plane, channels_);
  Grid<std::uint8_t> covered(plane);
  for (std::size_t p = 0; p < plane.area(); ++p) {
    const PixelSum& sum = sums_[p];
    developed.max_samples_per_pixel = std::max(developed.max_samples_per_pixel, sum.count);
    if (!(sum.weight > 0)) continue;
    covered[p] = 1;
    for (std::uint32_t c = 0; c < channels_; ++c) {
      developed.image.texels[p * channels_ + c] = static_cast<float>(sum.value[c] / sum.weight);
    }
  }
  developed.empty_pixels = fill_empty(developed.image, covered);
  return developed;
}

std::uint64_t fill_empty(Image& image, const Grid<std::uint8_t>& covered) {
  const Extent size = image.size;
  assert(covered.size() == size);
  constexpr std::uint32_t unreached = std::numeric_limits<std::uint32_t>::max();
  Grid<std::uint32_t> layer(size, unreached);
  std::vector<std::size_t> front;  // pixels of the current layer
  for (std::size_t p = 0; p < size.area(); ++p) {
    if (covered[p] != 0) layer[p] = 0;
  }
  const std::uint64_t empty = static_cast<std::uint64_t>(
      std::count_if(covered.cells().begin(), covered.cells().end(), [](std::uint8_t c) { return c == 0; }));
  if (empty == size.area()) {
    std::fill(image.texels.begin(), image.texels.end(), 0.0F);
    return empty;
  }
  const auto for_neighbours = [size](std::size_t p, const auto& visit) {
    const auto x = static_cast<std::int64_t>(p % size.width);
    const auto y = static_cast<std::int64_t>(p / size.width);
    for (std::int64_t v = std::max<std::int64_t>(y - 1, 0); v <= std::min<std::int64_t>(y + 1, size.height - 1); ++v) {
      for (std::int64_t u = std::max<std::int64_t>(x - 1, 0); u <= std::min<std::int64_t>(x + 1, size.width - 1); ++u) {
        const auto q = static_cast<std::size_t>(v * size.width + u);
        if (q != p) visit(q);
      }
    }
  };
  if (empty > 0) {
    for (std::size_t p = 0; p < size.area(); ++p) {
      if (layer[p] == 0) front.push_back(p);
    }
  }
  for (std::uint32_t current = 1; !front.empty(); ++current) {
    std::vector<std::size_t> next;
    for (const std::size_t p : front) {
      for_neighbours(p, [&](std::size_t q) {
        if (layer[q] != unreached) return;
        layer[q] = current;
        next.push_back(q);
      });
    }
    for (const std::size_t p : next) {
      std::array<double, 3> sum{};
      int count = 0;
      for_neighbours(p, [&](std::size_t q) {
        if (layer[q] >= current) return;
        for (std::uint32_t c = 0; c < image.channels; ++c) sum[c] += double{image.texels[q * image.channels + c]};
        ++count;
      });
      for (std::uint32_t c = 0; c < image.channels; ++c) {
        image.texels[p * image.channels + c] = static_cast<float>(sum[c] / count);
      }
    }
    front.swap(next);
  }
  return empty;
}

}  // namespace abn::harness
