// What the filter importance strategies have in common: samples that belong to a pixel and are drawn from its filter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sampling/fis/filter_density.h"
#include "sampling/sampler.h"

namespace abn {

/// Filter importance sampling (Ernst, Stamminger, Greiner 2006; thesis 4.2): every pixel gets samples of its own,
/// placed around its centre with the filter as their density, so that the plain mean of a pixel's samples estimates the
/// filtered pixel and no sample is shared. Positions may lie outside the plane; the owner is in SampleBatch::pixel.
///
/// Every pixel gets floor(budget / pixels) samples, and budget % pixels pixels, the same pseudo-random choice as in
/// UnitSquareSampler, get one more; pixels follow row by row. Batches hold at most 2^20 samples.
class FilterSampler : public Sampler {
 public:
  SampleBatch next(const Feedback& seen) final;
  /// Of what was emitted: `filter_second_moment_error` (mean r^2 around the pixel's centre relative to that of the
  /// filter, minus 1) and `filter_ks` (greatest difference between the radial distributions, to .001). Numbers of the
  /// samples, not of the method: 400 000 independent ones have .002.
  std::vector<Diagnostic> diagnostics() const override;

 protected:
  /// Throws ConfigError for a filter with negative lobes or more than 2^26 samples per pixel.
  FilterSampler(const SamplingTask& task, const std::string& name);

  /// Called once, before the first samples.
  virtual void prepare() {}
  /// The offsets [px] of all samples of a pixel from its centre: a pure function, called from many threads at once.
  /// `weight` is empty unless weighted().
  virtual void offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float> weight) const = 0;
  virtual bool weighted() const { return false; }

  const SamplingTask& task() const { return task_; }
  const FilterDensity& density() const { return density_; }
  /// A 64-bit key of a pixel from the task's seed and the strategy's name.
  std::uint64_t pixel_key(std::uint32_t pixel) const;
  /// Samples of the pixels that have fewer; may be 0.
  std::uint64_t smaller_set() const { return per_pixel_; }
  /// Whether some pixels have one sample more.
  bool two_sizes() const { return remainder_ != 0; }

 private:
  static constexpr std::size_t kBins = 1024;
  struct Statistics {
    double weight = 0;
    double squares = 0;               // sum w r^2
    std::array<double, kBins> bin{};  // sum w by radial share
    void add(const Statistics& other);
  };

  std::uint64_t set_size(std::uint64_t pixel) const;
  void make_pixels();

  SamplingTask task_;
  std::uint32_t stream_;
  FilterDensity density_;
  std::uint64_t pixels_;
  std::uint64_t per_pixel_;
  std::uint64_t remainder_;
  std::uint64_t next_pixel_ = 0;
  bool prepared_ = false;
  std::vector<std::uint64_t> starts_;  // of the pixels made in set_
  PointSet set_;                       // samples of whole pixels, of which ...
  std::size_t emitted_ = 0;            // ... so many are emitted
  Statistics statistics_;
};

}  // namespace abn
