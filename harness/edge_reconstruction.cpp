#include "harness/edge_reconstruction.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "sampling/kriging/step_rules.h"
#include "sampling/vector_clones.h"

namespace abn::harness {
namespace {

using namespace step_rules;

constexpr std::size_t rows_at_once = 4;

/// Directions and, for each, how far apart the two classes are along it.
struct Scan {
  std::array<float, angles> cosine{}, sine{};
  std::array<float, angles> low_min, low_max, high_min, high_max;
};

Scan half_turn() {
  Scan scan;
  for (std::size_t a = 0; a < angles; ++a) {
    const double angle = coarse_angle(static_cast<std::uint32_t>(a));
    scan.cosine[a] = static_cast<float>(std::cos(angle));
    scan.sine[a] = static_cast<float>(std::sin(angle));
  }
  return scan;
}

/// The extent of the given points along every direction.
ABN_VECTOR_CLONES void extents(const Scan& scan, const float* x, const float* y, std::size_t count, float* least,
                               float* most) {
  for (std::size_t a = 0; a < angles; ++a) {
    least[a] = far_away;
    most[a] = -far_away;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const float px = x[k];
    const float py = y[k];
#pragma omp simd
    for (std::size_t a = 0; a < angles; ++a) {
      const float along = scan.cosine[a] * px + scan.sine[a] * py;
      least[a] = along < least[a] ? along : least[a];
      most[a] = along > most[a] ? along : most[a];
    }
  }
}

class StepFinder {
 public:
  StepFinder(const SampleBins& bins, const EdgeOptions& options, float least_range)
      : bins_(bins), options_(options), least_range_(least_range) {}

  PixelStep find(std::uint32_t px, std::uint32_t py) {
    PixelStep step;
    for (int window = 0; window < windows; ++window) {
      bins_.gather(px, py, window_margin(window, options_.margin), false, found_);
      if (found_.size() < options_.samples) break;
      if (!sort_luminances()) break;
      const Split split = split_classes(sorted_.data(), sorted_.size(), options_);
      if (!split.good) continue;
      divide(split.threshold, static_cast<float>(px), static_cast<float>(py));
      SharePosterior posterior;
      if (!separate(posterior)) continue;
      step.found = true;
      step.threshold = split.threshold;
      posterior.store(step);
      find_jump(step);
      break;
    }
    return step;
  }

 private:
  // False if they are flat, which those of smaller windows are then too.
  bool sort_luminances() {
    sorted_.resize(found_.size());
    float least = bins_.luminances()[found_[0]];
    float most = least;
    for (std::size_t k = 0; k < found_.size(); ++k) {
      const float light = bins_.luminances()[found_[k]];
      sorted_[k] = light;
      least = std::min(least, light);
      most = std::max(most, light);
    }
    if (!(most - least > least_range_)) return false;
    std::sort(sorted_.begin(), sorted_.end());
    return true;
  }

  void divide(float threshold, float left, float top) {
    for (std::size_t side = 0; side < 2; ++side) {
      x_[side].clear();
      y_[side].clear();
      of_[side].clear();
    }
    for (const std::uint32_t i : found_) {
      const std::size_t side = bins_.luminances()[i] < threshold ? 0 : 1;
      x_[side].push_back(bins_.x()[i] - left);
      y_[side].push_back(bins_.y()[i] - top);
      of_[side].push_back(i);
    }
  }

  void measure(Scan& scan) const {
    extents(scan, x_[0].data(), y_[0].data(), x_[0].size(), scan.low_min.data(), scan.low_max.data());
    extents(scan, x_[1].data(), y_[1].data(), x_[1].size(), scan.high_min.data(), scan.high_max.data());
  }

  // Looks at the first `count` angles of the scan; those that separate go to `posterior`.
  AngleCount look(std::uint32_t count, SharePosterior& posterior) {
    measure(scan_);
    AngleCount seen;
    for (std::uint32_t a = 0; a < count; ++a) {
      const Family lines = family_between(scan_.low_min[a], scan_.low_max[a], scan_.high_min[a], scan_.high_max[a]);
      if (!seen.add(a, lines.gap)) continue;
      posterior.add(lines.gap, lines.low_first, shares_of(scan_.cosine[a], scan_.sine[a], lines));
    }
    return seen;
  }

  // Whether lines separate the classes; then all of them are in `posterior`.
  bool separate(SharePosterior& posterior) {
    static const Scan coarse = half_turn();
    scan_.cosine = coarse.cosine;
    scan_.sine = coarse.sine;
    const AngleCount seen = look(angles, posterior);
    if (seen.separating >= enough_angles) return true;
    if (seen.widest < hopeless) return false;
    return refine(coarse_angle(seen.best), posterior);
  }

  // Looks at finer angles around the best one, until enough of them separate.
  bool refine(double centre, SharePosterior& posterior) {
    FineAngles fine = around(centre, first_spacing);
    for (int level = 0; level < refinements; ++level) {
      posterior = {};
      for (std::uint32_t a = 0; a <= fine_angles; ++a) {  // what the scan has beyond is not looked at
        scan_.cosine[a] = static_cast<float>(std::cos(fine[a]));
        scan_.sine[a] = static_cast<float>(std::sin(fine[a]));
      }
      const AngleCount seen = look(fine_angles + 1, posterior);
      if (seen.separating >= enough_angles - 1) break;
      fine = around(fine[seen.best], fine.spacing / 4);
    }
    return posterior.weight > least_weight;
  }

  void find_jump(PixelStep& step) const {
    std::array<std::array<double, 4>, 2> mean{};  // channels, then luminance
    for (std::size_t side = 0; side < 2; ++side) {
      for (const std::uint32_t i : of_[side]) {
        for (std::uint32_t c = 0; c < bins_.channels(); ++c) mean[side][c] += double{bins_.value(i)[c]};
        mean[side][3] += double{bins_.luminances()[i]};
      }
      for (double& m : mean[side]) m /= static_cast<double>(of_[side].size());
    }
    for (std::uint32_t c = 0; c < bins_.channels(); ++c) step.jump[c] = static_cast<float>(mean[1][c] - mean[0][c]);
    step.luminance_jump = static_cast<float>(mean[1][3] - mean[0][3]);
  }

  const SampleBins& bins_;
  EdgeOptions options_;
  float least_range_;
  std::vector<std::uint32_t> found_;
  std::vector<float> sorted_;
  std::array<std::vector<float>, 2> x_, y_;  // of the lower and the upper class
  std::array<std::vector<std::uint32_t>, 2> of_;
  Scan scan_;
};

/// Least and largest luminance.
struct Range {
  float least = std::numeric_limits<float>::max();
  float most = std::numeric_limits<float>::lowest();
};

Grid<Range> pixel_ranges(const SampleBins& bins) {
  Grid<Range> ranges(bins.plane());
  for (std::size_t p = 0; p < bins.plane().area(); ++p) {
    for (const float light : bins.luminances().subspan(bins.begin(p), bins.end(p) - bins.begin(p))) {
      ranges[p] = {std::min(ranges[p].least, light), std::max(ranges[p].most, light)};
    }
  }
  return ranges;
}

// Of a pixel and its eight neighbours together: at least that of every window of the pixel, and cheap.
float range_around(const Grid<Range>& ranges, std::uint32_t x, std::uint32_t y) {
  Range all;
  for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, ranges.size().height - 1); ++v) {
    for (std::uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, ranges.size().width - 1); ++u) {
      const Range& range = ranges.at(u, v);
      all = {std::min(all.least, range.least), std::max(all.most, range.most)};
    }
  }
  return all.most > all.least ? all.most - all.least : 0;
}

}  // namespace

Grid<PixelStep> find_steps(const SampleBins& bins, const EdgeOptions& options) {
  assert(options.margin < 1);  // range_around() looks no farther
  const Extent plane = bins.plane();
  Grid<PixelStep> steps(plane);
  const float contrast = least_range(bins.luminance_squares(), static_cast<double>(bins.size()), options.contrast);
  const Grid<Range> ranges = pixel_ranges(bins);
#pragma omp parallel
  {
    StepFinder finder(bins, options, contrast);
#pragma omp for schedule(dynamic, rows_at_once)
    for (std::uint32_t y = 0; y < plane.height; ++y) {
      for (std::uint32_t x = 0; x < plane.width; ++x) {
        if (range_around(ranges, x, y) > contrast) steps.at(x, y) = finder.find(x, y);
      }
    }
  }
  return steps;
}

Developed edge(const Film& film, const EstimatePixels& on_device) {
  if (on_device) return krige(film, on_device(film, true));
  const SampleBins bins(film);
  const Grid<PixelStep> steps = find_steps(bins);
  return krige(film, bins, &steps);
}

}  // namespace abn::harness
