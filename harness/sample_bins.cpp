#include "harness/sample_bins.h"

#include <algorithm>

#include "sampling/kriging/sample_windows.h"
#include "sampling/sph/fixed_sum.h"

namespace abn::harness {
SampleBins::SampleBins(const Film& film) : plane_(film.stats().size()), channels_(film.channels()) {
  const KeptSamples& kept = film.kept();
  const std::size_t given = kept.position.size();
  constexpr std::uint32_t unused = ~0U;
  std::vector<std::uint32_t> pixel(given, unused);
  begin_.assign(plane_.area() + 1, 0);
  for (std::size_t i = 0; i < given; ++i) {
    if (!(kept.weight[i] > 0)) continue;
    pixel[i] =
        nearest_cell(kept.position[i].y, plane_.height) * plane_.width + nearest_cell(kept.position[i].x, plane_.width);
    ++begin_[pixel[i] + 1];
  }
  for (std::size_t p = 0; p < plane_.area(); ++p) begin_[p + 1] += begin_[p];
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  x_.resize(begin_.back());
  y_.resize(x_.size());
  added_.resize(x_.size());
  luminance_.resize(x_.size());
  value_.resize(x_.size() * channels_);
  for (std::size_t i = 0; i < given; ++i) {
    if (pixel[i] == unused) continue;
    const std::size_t to = next[pixel[i]]++;
    added_[to] = static_cast<std::uint32_t>(i);
    x_[to] = kept.position[i].x;
    y_[to] = kept.position[i].y;
    for (std::size_t c = 0; c < channels_; ++c) value_[to * channels_ + c] = kept.value[i * channels_ + c];
    luminance_[to] = luminance(value_.data() + to * channels_, channels_);
  }
}

void SampleBins::gather(std::uint32_t x, std::uint32_t y, float margin, bool round,
                        std::vector<std::uint32_t>& found) const {
  const auto left = static_cast<float>(x);
  const auto top = static_cast<float>(y);
  const auto [first_x, last_x, first_y, last_y] = window_around(x, y, margin, plane_);
  std::size_t candidates = 0;
  for (std::uint32_t row = first_y; row <= last_y; ++row) {
    const std::size_t p = std::size_t{row} * plane_.width;
    candidates += end(p + last_x) - begin(p + first_x);
  }
  if (found.size() < candidates) found.resize(candidates);
  std::size_t count = 0;
  const float limit = margin * margin;
  for (std::uint32_t row = first_y; row <= last_y; ++row) {
    const std::size_t p = std::size_t{row} * plane_.width;
    const std::uint32_t stop = end(p + last_x);
    for (std::uint32_t i = begin(p + first_x); i < stop; ++i) {
      const float dx = distance_outside(left, x_[i]);
      const float dy = distance_outside(top, y_[i]);
      const bool near = round ? dx * dx + dy * dy <= limit : std::max(dx, dy) <= margin;
      found[count] = i;  // written always, kept only if near: no branch to mispredict
      count += static_cast<std::size_t>(near);
    }
  }
  found.resize(count);
}

double SampleBins::luminance_squares() const {
  if (size() == 0) return 0;
  const auto light = [&](std::size_t i) { return double{luminance_[i]}; };
  const double mean = sph::fixed_order_sum(size(), light) / static_cast<double>(size());
  return sph::fixed_order_sum(size(), [&](std::size_t i) { return (light(i) - mean) * (light(i) - mean); });
}

void SampleBins::map_values(float (*map)(float)) {
  for (float& value : value_) value = map(value);
  for (std::size_t i = 0; i < size(); ++i) luminance_[i] = luminance(value(i), channels_);
}

Developed developed_for(const Film& film) {
  Developed developed;
  developed.samples = film.samples();
  developed.image = Image(film.stats().size(), film.channels());
  for (const PixelSum& sum : film.sums().cells()) {
    developed.max_samples_per_pixel = std::max(developed.max_samples_per_pixel, sum.count);
  }
  return developed;
}

}  // namespace abn::harness
