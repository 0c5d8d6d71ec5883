#include "harness/kriging.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "harness/kriging_solve.h"
#include "sampling/kriging/kriging_rules.h"
#include "sampling/kriging/sample_windows.h"

namespace abn::harness {
namespace {

using namespace kriging_rules;

constexpr std::size_t block_size = 512;  // pixels that one thread takes at a time
constexpr double prior_degrees = 1e-5;   // of the picture's mean scale: only samples that all agree leave it visible
// Pictures are not Gaussian fields of this variogram: their errors were 5 to 20 % smaller than its scale says, on all
// reference images, synthetic discs and sample sets looked at, at 6 and 16 samples per pixel.
constexpr double calibration = 0.85;
constexpr double least_at_gaps = 0.03;

/// The points of a pixel's estimate, relative to the pixel's corner.
struct Neighbours {
  std::vector<float> x, y, nugget, luminance;
  std::vector<float> value;  // [points * channels]

  void clear() {
    x.clear();
    y.clear();
    nugget.clear();
    luminance.clear();
    value.clear();
  }
};

struct PixelSystem {
  std::uint32_t pixel = 0;
  std::uint32_t first = 0;  // point
  std::uint32_t count = 0;
  float sill = 0;
};

class Kriger {
 public:
  Kriger(const SampleBins& bins, const Grid<PixelStep>* steps, const KrigingOptions& options)
      : bins_(bins), steps_(steps), options_(options), nugget_(nugget_of(bins.per_pixel(), options)) {}

  /// Pixels [begin, end) of the image.
  void run(std::size_t begin, std::size_t end, PixelEstimates& estimates) {
    points_.clear();
    systems_.clear();
    for (std::size_t p = begin; p < end; ++p) collect(p);
    // Equal counts side by side, so that the lanes of a batch are full.
    order_.resize(systems_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return systems_[a].count < systems_[b].count; });
    for (std::size_t k = 0; k < order_.size(); k += kriging_lanes) {
      const std::size_t lanes = std::min(kriging_lanes, order_.size() - k);
      batch_.resize(systems_[order_[k + lanes - 1]].count);
      for (std::size_t lane = 0; lane < lanes; ++lane) load(systems_[order_[k + lane]], lane);
      solve_kriging(batch_);
      for (std::size_t lane = 0; lane < lanes; ++lane) store(systems_[order_[k + lane]], lane, estimates);
    }
  }

 private:
  void collect(std::size_t p) {
    const std::uint32_t width = bins_.plane().width;
    const auto px = static_cast<std::uint32_t>(p % width);
    const auto py = static_cast<std::uint32_t>(p / width);
    float margin = options_.margin;
    bins_.gather(px, py, margin, true, found_);
    for (int k = 0; k < growths && found_.size() < options_.wanted; ++k) {
      margin *= growth;
      bins_.gather(px, py, margin, true, found_);
    }
    if (found_.empty()) return;
    PixelSystem system;
    system.pixel = static_cast<std::uint32_t>(p);
    system.first = static_cast<std::uint32_t>(points_.x.size());
    const std::size_t own = bins_.end(p) - bins_.begin(p);
    if (own + extra_neighbours > most_neighbours) {
      merge(p, static_cast<float>(px), static_cast<float>(py));
    } else {
      const std::size_t most = std::max<std::size_t>(usual_neighbours, own + extra_neighbours);
      if (found_.size() > most) keep_nearest(most, static_cast<float>(px), static_cast<float>(py));
      for (const std::uint32_t i : found_) {
        add_point(bins_.x()[i] - static_cast<float>(px), bins_.y()[i] - static_cast<float>(py), nugget_);
        copy_values(p, i);
      }
    }
    system.count = static_cast<std::uint32_t>(points_.x.size()) - system.first;
    system.sill = sill_for(margin);
    systems_.push_back(system);
  }

  // Ties go to the lower number.
  void keep_nearest(std::size_t count, float left, float top) {
    distance_.resize(found_.size());
    for (std::size_t k = 0; k < found_.size(); ++k) {
      const float dx = distance_outside(left, bins_.x()[found_[k]]);
      const float dy = distance_outside(top, bins_.y()[found_[k]]);
      distance_[k] = {dx * dx + dy * dy, found_[k]};
    }
    std::nth_element(distance_.begin(), distance_.begin() + static_cast<std::ptrdiff_t>(count) - 1, distance_.end());
    found_.resize(count);
    for (std::size_t k = 0; k < count; ++k) found_[k] = distance_[k].second;
    std::sort(found_.begin(), found_.end());
  }

  void add_point(float x, float y, float nugget) {
    points_.x.push_back(x);
    points_.y.push_back(y);
    points_.nugget.push_back(nugget);
  }

  // The values of sample i, less the step of pixel p where there is one.
  void copy_values(std::size_t p, std::uint32_t i) {
    const float* value = bins_.value(i);
    float light = bins_.luminances()[i];
    const PixelStep* step = steps_ != nullptr && (*steps_)[p].found ? &(*steps_)[p] : nullptr;
    const bool upper = step != nullptr && light >= step->threshold;
    for (std::uint32_t c = 0; c < bins_.channels(); ++c) {
      points_.value.push_back(upper ? value[c] - step->jump[c] : value[c]);
    }
    points_.luminance.push_back(upper ? light - step->luminance_jump : light);
  }

  // One point for all of a pixel's own samples that share a cell: their means, with the nugget of a mean.
  void merge(std::size_t p, float left, float top) {
    const std::uint32_t channels = bins_.channels();
    cells_.assign(std::size_t{merge_cells} * merge_cells, {});
    const std::size_t first = points_.luminance.size();
    for (std::uint32_t i = bins_.begin(p); i < bins_.end(p); ++i) {
      const float x = bins_.x()[i] - left;
      const float y = bins_.y()[i] - top;
      Cell& cell = cells_[merge_cell(x, y)];
      copy_values(p, i);
      cell.count += 1;
      cell.x += double{x};
      cell.y += double{y};
      cell.luminance += double{points_.luminance[first]};
      for (std::uint32_t c = 0; c < channels; ++c) cell.value[c] += double{points_.value[first * channels + c]};
      points_.luminance.resize(first);
      points_.value.resize(first * channels);
    }
    for (const Cell& cell : cells_) {
      if (cell.count == 0) continue;
      add_point(static_cast<float>(cell.x / cell.count), static_cast<float>(cell.y / cell.count),
                merged_nugget(nugget_, cell.count));
      points_.luminance.push_back(static_cast<float>(cell.luminance / cell.count));
      for (std::uint32_t c = 0; c < channels; ++c) {
        points_.value.push_back(static_cast<float>(cell.value[c] / cell.count));
      }
    }
  }

  void load(const PixelSystem& system, std::size_t lane) {
    batch_.sill[lane] = system.sill;
    double mean = 0;
    for (std::size_t k = 0; k < system.count; ++k) mean += double{points_.luminance[system.first + k]};
    mean /= system.count;
    for (std::size_t k = 0; k < system.count; ++k) {
      const std::size_t point = system.first + k;
      const std::size_t at = k * kriging_lanes + lane;
      batch_.x[at] = points_.x[point];
      batch_.y[at] = points_.y[point];
      batch_.diagonal[at] = system.sill + points_.nugget[point];
      batch_.value[at] = static_cast<float>(double{points_.luminance[point]} - mean);
      batch_.live[at] = 1;
    }
  }

  float scale_at_gaps(const PixelSystem& system) const {
    if (system.count < fewest_for_gaps) return 1;
    const float* x = points_.x.data() + system.first;
    const float* y = points_.y.data() + system.first;
    const float* light = points_.luminance.data() + system.first;
    GapMean mean;
    for (std::uint32_t i = 0; i < system.count; ++i) mean.add(gap_scale(x, y, light, system.count, i));
    return mean.ratio(system.count);
  }

  void store(const PixelSystem& system, std::size_t lane, PixelEstimates& estimates) {
    const std::uint32_t channels = bins_.channels();
    const PixelStep* step = steps_ != nullptr && (*steps_)[system.pixel].found ? &(*steps_)[system.pixel] : nullptr;
    for (std::uint32_t c = 0; c < channels; ++c) {
      const float* value = points_.value.data() + std::size_t{system.first} * channels + c;
      // Deviations from the mean are what is weighted: constants come out exactly, whatever the weights' rounding.
      double mean = 0;
      for (std::size_t k = 0; k < system.count; ++k) mean += double{value[k * channels]};
      mean /= system.count;
      double sum = 0;
      for (std::size_t k = 0; k < system.count; ++k) {
        sum += double{batch_.weight[k * kriging_lanes + lane]} * (double{value[k * channels]} - mean);
      }
      sum += mean;
      if (step != nullptr) sum += double{step->share} * double{step->jump[c]};
      estimates.value[std::size_t{system.pixel} * channels + c] = static_cast<float>(sum);
    }
    estimates.scale[system.pixel] = {batch_.variance[lane], batch_.squares[lane], batch_.degrees[lane],
                                     batch_.trend[lane], scale_at_gaps(system)};
  }

  struct Cell {
    double x = 0, y = 0, luminance = 0;
    std::array<double, 3> value{};
    double count = 0;
  };

  const SampleBins& bins_;
  const Grid<PixelStep>* steps_;
  KrigingOptions options_;
  float nugget_ = 0;
  Neighbours points_;
  std::vector<PixelSystem> systems_;
  std::vector<std::uint32_t> found_, order_;
  std::vector<std::pair<float, std::uint32_t>> distance_;
  std::vector<Cell> cells_;
  KrigingBatch batch_;
};

// The scale of the variogram around every pixel, from the squares of the pixel and its neighbours together; then
// errors.
Grid<float> standard_errors(const Grid<PixelScale>& scales, const Grid<PixelStep>* steps) {
  const Extent size = scales.size();
  Grid<float> errors(size);
  double all_squares = 0;
  double all_degrees = 0;
  for (const PixelScale& scale : scales.cells()) {
    all_squares += double{scale.squares};
    all_degrees += double{scale.degrees};
  }
  const double mean_scale = all_degrees > 0 ? all_squares / all_degrees : 0;
#pragma omp parallel for schedule(static)
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      double squares = prior_degrees * mean_scale;
      double degrees = prior_degrees;
      for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, size.height - 1); ++v) {
        for (std::uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, size.width - 1); ++u) {
          const PixelScale& scale = scales.at(u, v);
          squares += double{scale.squares};
          degrees += double{scale.degrees};
        }
      }
      const PixelScale& own = scales.at(x, y);
      // Among few samples the ratio is noise; it never says that the error is larger. Its root fits best: as it is, the
      // bins of smallest errors come out two to three times too small; without it, adaptive sets up to 2.3 times too
      // large.
      const double gaps = std::sqrt(std::clamp(double{own.at_gaps}, least_at_gaps, 1.0));
      double variance =
          calibration * double{own.unit_variance} * squares / degrees * gaps + double{own.trend} * double{own.trend};
      if (steps != nullptr && steps->at(x, y).found) {
        const PixelStep& step = steps->at(x, y);
        const double area = double{step.share_error} * double{step.luminance_jump};
        variance += area * area;
      }
      errors.at(x, y) = static_cast<float>(std::sqrt(variance));
    }
  }
  return errors;
}

float tonemap(float value) { return value / (1 + std::max(value, 0.0F)); }
float invert_tonemap(float mapped) { return mapped / (1 - std::max(mapped, 0.0F)); }

// The largest value of every pixel's own samples, per channel; the lowest float where there are none.
Image brightest_samples(const SampleBins& bins) {
  Image brightest(bins.plane(), bins.channels());
  std::fill(brightest.texels.begin(), brightest.texels.end(), std::numeric_limits<float>::lowest());
  for (std::size_t p = 0; p < bins.plane().area(); ++p) {
    for (std::uint32_t i = bins.begin(p); i < bins.end(p); ++i) {
      for (std::uint32_t c = 0; c < bins.channels(); ++c) {
        float& most = brightest.texels[p * bins.channels() + c];
        most = std::max(most, bins.value(i)[c]);
      }
    }
  }
  return brightest;
}

// What the samples say of every pixel.
PixelEstimates estimate(const SampleBins& bins, const Grid<PixelStep>* steps, const KrigingOptions& options) {
  const std::size_t pixels = bins.plane().area();
  PixelEstimates estimates;
  estimates.value.resize(pixels * bins.channels());
  estimates.scale = Grid<PixelScale>(bins.plane());
  estimates.samples = bins.size();
  estimates.luminance_squares = bins.luminance_squares();
  for (std::size_t p = 0; p < pixels; ++p) {
    estimates.empty_pixels += static_cast<std::uint64_t>(bins.begin(p) == bins.end(p));
  }
  const std::size_t blocks = (pixels + block_size - 1) / block_size;
#pragma omp parallel
  {
    Kriger kriger(bins, steps, options);
#pragma omp for schedule(dynamic, 1)
    for (std::size_t block = 0; block < blocks; ++block) {
      kriger.run(block * block_size, std::min<std::size_t>((block + 1) * block_size, pixels), estimates);
    }
  }
  return estimates;
}

// Fills what no sample reaches, and tells errors.
Developed develop(const Film& film, PixelEstimates estimates, const Grid<PixelStep>* steps) {
  const Grid<PixelScale>& scales = estimates.scale;
  Developed developed = developed_for(film);
  assert(estimates.value.size() == developed.image.texels.size());
  developed.image.texels = std::move(estimates.value);
  developed.empty_pixels = estimates.empty_pixels;
  Grid<std::uint8_t> covered(scales.size());
  for (std::size_t p = 0; p < covered.cells().size(); ++p) {
    covered[p] = static_cast<std::uint8_t>(scales[p].unit_variance > 0);
  }
  fill_empty(developed.image, covered);
  // Nothing can be said about errors by one sample, and about a pixel far from all only what values do anywhere.
  if (estimates.samples < 2) return developed;
  developed.standard_error = standard_errors(scales, steps);
  const auto anywhere =
      static_cast<float>(std::sqrt(estimates.luminance_squares / static_cast<double>(estimates.samples - 1)));
  for (std::size_t p = 0; p < covered.cells().size(); ++p) {
    if (covered[p] == 0) developed.standard_error[p] = anywhere;
  }
  return developed;
}

}  // namespace

Developed krige(const Film& film, const SampleBins& bins, const Grid<PixelStep>* steps, const KrigingOptions& options) {
  assert(steps == nullptr || steps->size() == bins.plane());
  return develop(film, estimate(bins, steps, options), steps);
}

Developed krige(const Film& film, PixelEstimates estimates) {
  const Grid<PixelStep> steps = std::move(estimates.step);
  return develop(film, std::move(estimates), steps.cells().empty() ? nullptr : &steps);
}

EstimatePixels estimate_kept(SampleEstimator on_samples) {
  if (!on_samples) return nullptr;
  return [on_samples = std::move(on_samples)](const Film& film, bool steps) {
    const KeptSamples& kept = film.kept();
    return on_samples(kept.position, kept.value, kept.weight, film.channels(), film.stats().size(), steps);
  };
}

Developed kriging(const Film& film, const EstimatePixels& on_device) {
  return on_device ? krige(film, on_device(film, false)) : krige(film, SampleBins(film));
}

Developed kriging_tonemapped(const Film& film) {
  SampleBins bins(film);
  bins.map_values(tonemap);
  Developed developed = krige(film, bins);
  Image& image = developed.image;
  // Negative weights may overshoot, beyond 1 even, which is infinitely bright: what is inverted is kept below the
  // brightest sample in or around the pixel.
  const Extent plane = bins.plane();
  const Image brightest = brightest_samples(bins);
  for (std::uint32_t y = 0; y < plane.height; ++y) {
    for (std::uint32_t x = 0; x < plane.width; ++x) {
      for (std::uint32_t c = 0; c < image.channels; ++c) {
        float limit = std::numeric_limits<float>::lowest();
        for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, plane.height - 1); ++v) {
          for (std::uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, plane.width - 1); ++u) {
            limit = std::max(limit, brightest.texel(u, v)[c]);
          }
        }
        float& texel = image.texel(x, y)[c];
        // Without a sample around, the pixel's own value is an average of farther ones, below 1 as they are.
        if (limit > std::numeric_limits<float>::lowest()) texel = std::min(texel, limit);
        texel = invert_tonemap(std::min(texel, just_below(1.0F)));
      }
      // By the slope of the inverted map, (1 + value)^2.
      const float slope = 1 + std::max(luminance(image.texel(x, y), image.channels), 0.0F);
      if (!developed.standard_error.cells().empty()) developed.standard_error.at(x, y) *= slope * slope;
    }
  }
  return developed;
}

}  // namespace abn::harness
