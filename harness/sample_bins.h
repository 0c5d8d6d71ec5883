// The samples of a film sorted by pixel, for reconstructions that look at the samples themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/film.h"
#include "sampling/vec.h"

namespace abn::harness {

/// The samples of weight > 0, sorted by the pixel that contains their position; those of one pixel keep the order in
/// which they came. A position outside the plane counts to the nearest pixel. The size of a weight is not looked at:
/// where these reconstructions are used it follows from the positions. Owns copies of positions and values.
class SampleBins {
 public:
  /// The film has to keep its samples: without them there are none here.
  explicit SampleBins(const Film& film);

  Extent plane() const { return plane_; }
  std::uint32_t channels() const { return channels_; }
  std::size_t size() const { return x_.size(); }
  /// Mean number per pixel.
  double per_pixel() const { return static_cast<double>(size()) / static_cast<double>(plane_.area()); }

  std::span<const float> x() const { return x_; }                   // [px]
  std::span<const float> y() const { return y_; }                   // [px]
  std::span<const float> luminances() const { return luminance_; }  // of linear light, unless values were mapped
  /// The sum of (luminance - mean)^2, in the order of fixed_sum.h. 0 without samples.
  double luminance_squares() const;
  const float* value(std::size_t i) const { return value_.data() + i * channels_; }  // [channels]

  std::uint32_t added(std::size_t i) const { return added_[i]; }  // the sample's place in Film::kept()

  /// The samples of pixel p = y*width+x are [begin(p), end(p)), those of the pixels p..q of a row [begin(p), end(q)).
  std::uint32_t begin(std::size_t pixel) const { return begin_[pixel]; }
  std::uint32_t end(std::size_t pixel) const { return begin_[pixel + 1]; }

  /// Writes to `found` the samples in and around pixel (x, y): those within `margin` [px] of the pixel's square, by
  /// Euclidean distance if `round`, else those in the square enlarged by `margin`. In order of their numbers.
  void gather(std::uint32_t x, std::uint32_t y, float margin, bool round, std::vector<std::uint32_t>& found) const;

  /// Replaces every value by map(value), luminances by those of the mapped values.
  void map_values(float (*map)(float));

 private:
  Extent plane_;
  std::uint32_t channels_;
  std::vector<std::uint32_t> begin_;  // [pixels + 1]
  std::vector<std::uint32_t> added_;
  std::vector<float> x_, y_, luminance_;
  std::vector<float> value_;  // [samples * channels]
};

/// Fills a picture's numbers that every reconstruction of `film` shares, apart from empty_pixels.
Developed developed_for(const Film& film);

}  // namespace abn::harness
