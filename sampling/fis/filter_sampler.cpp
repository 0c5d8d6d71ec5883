#include "sampling/fis/filter_sampler.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "sampling/error.h"
#include "sampling/hash.h"
#include "sampling/permutation.h"
#include "sampling/rng.h"
#include "sampling/strategy.h"

namespace abn {
namespace {

constexpr std::uint64_t kBatch = std::uint64_t{1} << 20;
constexpr std::uint64_t kMostPerPixel = std::uint64_t{1} << 26;
constexpr std::uint64_t kBlock = 2048;  // pixels made by one thread at a time

/// A position inside the square around a pixel's centre that the filter covers: the sum may round onto its far border,
/// which for the box is the next pixel's.
float place_around(float centre, float offset, float radius) {
  return std::clamp(centre + offset, centre - radius, std::nextafter(centre + radius, -1e30F));
}

}  // namespace

void FilterSampler::Statistics::add(const Statistics& other) {
  weight += other.weight;
  squares += other.squares;
  for (std::size_t b = 0; b < kBins; ++b) bin[b] += other.bin[b];
}

FilterSampler::FilterSampler(const SamplingTask& task, const std::string& name)
    : task_(task),
      stream_(stream_id(name.c_str())),
      density_(task.filter, name),
      pixels_(std::max<std::uint64_t>(1, task.plane.area())),
      per_pixel_(task.budget / pixels_),
      remainder_(task.budget % pixels_) {
  require_task(name, task);
  if (per_pixel_ >= kMostPerPixel || pixels_ >= std::uint64_t{1} << 31) {
    throw ConfigError(name + ": at most " + std::to_string(kMostPerPixel) +
                      " samples per pixel and 2^31 pixels; budget " + std::to_string(task.budget) + " on " +
                      std::to_string(task.plane.width) + "x" + std::to_string(task.plane.height) +
                      " pixels is more; lower the budget");
  }
}

std::uint64_t FilterSampler::pixel_key(std::uint32_t pixel) const {
  Rng rng(task_.seed, stream_, pixel);
  const std::uint64_t high = rng.next();
  return high << 32 | rng.next();
}

std::uint64_t FilterSampler::set_size(std::uint64_t pixel) const {
  if (remainder_ == 0) return per_pixel_;
  const Permutation order(static_cast<std::uint32_t>(pixels_), mix64(task_.seed ^ stream_id("one sample more")));
  return per_pixel_ + (order(static_cast<std::uint32_t>(pixel)) < remainder_ ? 1 : 0);
}

// The samples of the next pixels: as many whole ones as a batch holds, at least one.
void FilterSampler::make_pixels() {
  const std::uint64_t count = std::clamp<std::uint64_t>(kBatch / (per_pixel_ + 1), 1, pixels_ - next_pixel_);
  starts_.assign(count + 1, 0);
  for (std::uint64_t p = 0; p < count; ++p) starts_[p + 1] = starts_[p] + set_size(next_pixel_ + p);
  const std::size_t samples = starts_[count];
  set_.position.resize(samples);
  set_.pixel.resize(samples);
  if (weighted()) set_.weight.resize(samples);

  const auto blocks = static_cast<std::int64_t>((count + kBlock - 1) / kBlock);
  std::vector<Statistics> of_block(static_cast<std::size_t>(blocks));
  const float radius = density_.radius();
#pragma omp parallel for schedule(static) if (blocks > 1)
  for (std::int64_t b = 0; b < blocks; ++b) {
    Statistics& statistics = of_block[static_cast<std::size_t>(b)];
    const std::uint64_t begin = static_cast<std::uint64_t>(b) * kBlock;
    for (std::uint64_t p = begin; p < std::min(count, begin + kBlock); ++p) {
      const std::size_t n = starts_[p + 1] - starts_[p];
      if (n == 0) continue;
      const auto pixel = static_cast<std::uint32_t>(next_pixel_ + p);
      const auto offset = std::span(set_.position).subspan(starts_[p], n);
      const auto weight = weighted() ? std::span(set_.weight).subspan(starts_[p], n) : std::span<float>();
      offsets(pixel, offset, weight);
      const float centre_x = static_cast<float>(pixel % task_.plane.width) + 0.5F;
      const float centre_y = static_cast<float>(pixel / task_.plane.width) + 0.5F;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec2f d = offset[i];
        const double w = weight.empty() ? 1.0 : static_cast<double>(weight[i]);
        const float r_squared = d.x * d.x + d.y * d.y;
        const float share = density_.radial(std::sqrt(r_squared));
        statistics.weight += w;
        statistics.squares += w * static_cast<double>(r_squared);
        statistics.bin[std::min(kBins - 1, static_cast<std::size_t>(share * static_cast<float>(kBins)))] += w;
        offset[i] = {place_around(centre_x, d.x, radius), place_around(centre_y, d.y, radius)};
        set_.pixel[starts_[p] + i] = pixel;
      }
    }
  }
  for (const Statistics& block : of_block) statistics_.add(block);
  next_pixel_ += count;
  emitted_ = 0;
}

SampleBatch FilterSampler::next(const Feedback&) {
  if (!prepared_) prepare();
  prepared_ = true;
  while (emitted_ == set_.position.size()) {  // with a budget below the pixels, a run of pixels can be empty
    if (next_pixel_ == pixels_) return {};
    make_pixels();
  }
  const std::size_t count = std::min<std::size_t>(kBatch, set_.position.size() - emitted_);
  SampleBatch batch;
  batch.position = std::span<const Vec2f>(set_.position).subspan(emitted_, count);
  batch.pixel = std::span<const std::uint32_t>(set_.pixel).subspan(emitted_, count);
  if (weighted()) batch.weight = std::span<const float>(set_.weight).subspan(emitted_, count);
  emitted_ += count;
  return batch;
}

std::vector<Diagnostic> FilterSampler::diagnostics() const {
  if (!(statistics_.weight > 0)) return {};
  double below = 0;
  double greatest = 0;
  for (std::size_t b = 0; b < kBins; ++b) {
    below += statistics_.bin[b];
    greatest = std::max(greatest, std::abs(below / statistics_.weight - static_cast<double>(b + 1) / kBins));
  }
  return {{"filter_second_moment_error", statistics_.squares / statistics_.weight / density_.second_moment() - 1},
          {"filter_ks", greatest}};
}

}  // namespace abn
