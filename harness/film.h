// Where samples become pixels: sums for the picture, running statistics for the strategies.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/image.h"
#include "sampling/grid.h"
#include "sampling/sampler.h"

namespace abn::harness {

/// A picture and what is to be known about how it came about.
struct Developed {
  Image image;                              // no NaN, no holes
  std::uint64_t empty_pixels = 0;           // had no usable sample and were filled from their neighbours
  std::uint64_t max_samples_per_pixel = 0;  // of the fullest pixel
  std::uint64_t samples = 0;                // all that were added
  Grid<float> standard_error;               // of every pixel's luminance, estimated from its samples; empty = unknown
};

/// What a pixel has received; sums in double, so that 24-bit values and weights add up without visible rounding.
struct PixelSum {
  std::array<double, 3> value{};  // sum of weight * value, per channel
  double weight = 0;              // sum of weights
  std::uint64_t count = 0;        // number of samples
};

/// Samples with their values.
struct KeptSamples {
  std::vector<Vec2f> position;       // [px]
  std::vector<float> value;          // [samples * channels]
  std::vector<float> weight;         // 0 = it counts as evaluated and nothing else
  std::vector<std::uint32_t> pixel;  // owner y*width+x
};

/// Collects samples on a plane. Samples are added one after the other in the order given, so that the result does not
/// depend on threads.
class Film {
 public:
  /// `keep_samples`: for the reconstructions that look at the samples themselves.
  explicit Film(Extent plane, std::uint32_t channels, bool keep_samples = false);

  /// Adds a batch with its values [batch size * channels]. A sample belongs to batch.pixel or, without it, to the pixel
  /// that contains its position.
  void add(const SampleBatch& batch, std::span<const float> values);

  /// Count, mean and variance of the unweighted luminances of every pixel, for Feedback.
  const Grid<PixelStats>& stats() const { return stats_; }
  const Grid<PixelSum>& sums() const { return sums_; }
  std::uint32_t channels() const { return channels_; }
  std::uint64_t samples() const { return samples_; }
  /// Every sample in the order added, its weight and owner spelled out; nothing unless kept.
  const KeptSamples& kept() const { return kept_; }

  /// The box reconstruction: the mean of each pixel's samples by their actual number (by their actual sum of weights,
  /// sum w f / sum w). A pixel without samples or with sum w <= 0 is filled by fill_empty() and counted.
  Developed develop() const;

 private:
  std::uint32_t channels_;
  Grid<PixelSum> sums_;
  Grid<PixelStats> stats_;
  std::uint64_t samples_ = 0;
  bool keep_samples_ = false;
  KeptSamples kept_;
};

/// Fills the pixels that are not `covered` (non-zero) layer by layer from the covered ones outwards: a pixel takes the
/// mean of those of its eight neighbours that are covered or lie in an earlier layer. Returns how many were filled; an
/// image without any covered pixel becomes black.
std::uint64_t fill_empty(Image& image, const Grid<std::uint8_t>& covered);

}  // namespace abn::harness
