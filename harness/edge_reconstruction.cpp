#include "harness/edge_reconstruction.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "sampling/vector_clones.h"

namespace abn::harness {
namespace {

constexpr std::size_t angles = 64;
constexpr std::size_t enough_angles = 5;  // that separate: below, the angles around the best one are looked at closely
constexpr std::size_t fine_angles = 24;   // on either side of none, see refine()
constexpr int refinements = 3;
constexpr float hopeless = -0.12F;  // gap [px] of the best coarse angle below which no finer one will separate
constexpr std::size_t rows_at_once = 4;

/// Directions and, for each, how far apart the two classes are along it.
struct Scan {
  std::array<float, angles> cosine{}, sine{};
  std::array<float, angles> low_min, low_max, high_min, high_max;
};

/// Normal x cosine + y sine of a family of separating lines: all offsets in [begin, begin + gap], if gap > 0.
struct Family {
  float gap;
  float begin;
  bool low_first;  // the lower class has the smaller offsets
};

Scan half_turn() {
  Scan scan;
  for (std::size_t a = 0; a < angles; ++a) {
    const double angle = std::numbers::pi * static_cast<double>(a) / angles;
    scan.cosine[a] = static_cast<float>(std::cos(angle));
    scan.sine[a] = static_cast<float>(std::sin(angle));
  }
  return scan;
}

/// The extent of the given points along every direction.
ABN_VECTOR_CLONES void extents(const Scan& scan, const float* x, const float* y, std::size_t count, float* least,
                               float* most) {
  for (std::size_t a = 0; a < angles; ++a) {
    least[a] = 1e30F;
    most[a] = -1e30F;
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

/// Mean and spread of the upper side's share over families of lines.
struct SharePosterior {
  double weight = 0, sum = 0, squares = 0;

  void add(float cosine, float sine, const Family& family) {
    // Gauss-Legendre over the offset: the share is a piecewise parabola of it.
    constexpr std::array<float, 3> node{0.1127017F, 0.5F, 0.8872983F};
    constexpr std::array<double, 3> share_of{5.0 / 18, 8.0 / 18, 5.0 / 18};
    for (std::size_t k = 0; k < node.size(); ++k) {
      const auto below = double{detail::half_plane_share(cosine, sine, family.begin + node[k] * family.gap)};
      const double upper = family.low_first ? 1 - below : below;
      const double w = share_of[k] * double{family.gap};
      weight += w;
      sum += w * upper;
      squares += w * upper * upper;
    }
  }
};

class StepFinder {
 public:
  StepFinder(const SampleBins& bins, const EdgeOptions& options, float least_range)
      : bins_(bins), options_(options), least_range_(least_range) {}

  PixelStep find(std::uint32_t px, std::uint32_t py) {
    PixelStep step;
    for (const float share : {1.0F, 0.5F, 0.0F}) {
      bins_.gather(px, py, share * options_.margin, false, found_);
      if (found_.size() < options_.samples) break;
      const Split split = split_classes();
      if (split.flat) break;
      if (!split.good) continue;
      divide(split.threshold, static_cast<float>(px), static_cast<float>(py));
      SharePosterior posterior;
      if (!separate(posterior)) continue;
      step.found = true;
      step.threshold = split.threshold;
      step.share = static_cast<float>(posterior.sum / posterior.weight);
      const double mean = posterior.sum / posterior.weight;
      step.share_error =
          static_cast<float>(std::sqrt(std::max(posterior.squares / posterior.weight - mean * mean, 0.0)));
      find_jump(step);
      break;
    }
    return step;
  }

 private:
  struct Split {
    bool flat = false;  // and smaller windows are too
    bool good = false;
    float threshold = 0;
  };

  Split split_classes() {
    Split split;
    sorted_.resize(found_.size());
    float least = bins_.luminances()[found_[0]];
    float most = least;
    for (std::size_t k = 0; k < found_.size(); ++k) {
      const float light = bins_.luminances()[found_[k]];
      sorted_[k] = light;
      least = std::min(least, light);
      most = std::max(most, light);
    }
    split.flat = !(most - least > least_range_);
    if (split.flat) return split;
    std::sort(sorted_.begin(), sorted_.end());
    const std::size_t n = sorted_.size();
    double mean = 0;
    for (const float light : sorted_) mean += double{light};
    mean /= static_cast<double>(n);
    double total = 0;
    for (const float light : sorted_) total += (double{light} - mean) * (double{light} - mean);
    // Between-class variance: with values about their mean the two class sums are opposite.
    double sum = 0;
    double best = 0;
    std::size_t at = 0;
    for (std::size_t k = 1; k < n; ++k) {
      sum += double{sorted_[k - 1]} - mean;
      if (!(sorted_[k] > sorted_[k - 1])) continue;
      const double between = sum * sum * (1 / static_cast<double>(k) + 1 / static_cast<double>(n - k));
      if (between > best) {
        best = between;
        at = k;
      }
    }
    if (best < options_.explained * total || at < options_.class_samples || n - at < options_.class_samples)
      return split;
    const float middle = 0.5F * (sorted_[at - 1] + sorted_[at]);
    split.threshold = middle > sorted_[at - 1] ? middle : sorted_[at];
    split.good = true;
    return split;
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

  static Family family(const Scan& scan, std::size_t a) {
    const float low_first = scan.high_min[a] - scan.low_max[a];
    const float high_first = scan.low_min[a] - scan.high_max[a];
    if (low_first >= high_first) return {low_first, scan.low_max[a], true};
    return {high_first, scan.high_max[a], false};
  }

  // Whether lines separate the classes; then all of them are in `posterior`.
  bool separate(SharePosterior& posterior) {
    static const Scan coarse = half_turn();
    scan_.cosine = coarse.cosine;
    scan_.sine = coarse.sine;
    measure(scan_);
    std::size_t separating = 0;
    std::size_t best = 0;
    float widest = -1e30F;
    for (std::size_t a = 0; a < angles; ++a) {
      const Family lines = family(scan_, a);
      if (lines.gap > 0) {
        ++separating;
        posterior.add(scan_.cosine[a], scan_.sine[a], lines);
      }
      if (lines.gap > widest) {
        widest = lines.gap;
        best = a;
      }
    }
    if (separating >= enough_angles) return true;
    if (widest < hopeless) return false;
    return refine(std::numbers::pi * static_cast<double>(best) / angles, posterior);
  }

  // Looks at angles 8, then 32, then 128 times as dense around the best one, until enough of them separate.
  bool refine(double centre, SharePosterior& posterior) {
    double spacing = std::numbers::pi / angles / 8;
    for (int level = 0; level < refinements; ++level) {
      posterior = {};
      const double first = centre - spacing * fine_angles / 2;
      for (std::size_t a = 0; a <= fine_angles; ++a) {  // what the scan has beyond is not looked at
        const double angle = first + spacing * static_cast<double>(a);
        scan_.cosine[a] = static_cast<float>(std::cos(angle));
        scan_.sine[a] = static_cast<float>(std::sin(angle));
      }
      measure(scan_);
      std::size_t separating = 0;
      float widest = -1e30F;
      for (std::size_t a = 0; a <= fine_angles; ++a) {
        const Family lines = family(scan_, a);
        if (lines.gap > 0) {
          ++separating;
          posterior.add(scan_.cosine[a], scan_.sine[a], lines);
        }
        if (lines.gap > widest) {
          widest = lines.gap;
          centre = first + spacing * static_cast<double>(a);
        }
      }
      if (separating >= enough_angles - 1) break;
      spacing /= 4;
    }
    return posterior.weight > 1e-9;
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

namespace detail {

float half_plane_share(float cosine, float sine, float offset) {
  // By symmetry both components may be taken positive, the larger one first.
  offset -= std::min(cosine, 0.0F) + std::min(sine, 0.0F);
  const float large = std::max(std::abs(cosine), std::abs(sine));
  const float small = std::min(std::abs(cosine), std::abs(sine));
  if (offset <= 0) return 0;
  if (offset >= large + small) return 1;
  if (small < 1e-6F) return std::min(offset / large, 1.0F);
  if (offset <= small) return 0.5F * offset * offset / (large * small);
  if (offset <= large) return (offset - 0.5F * small) / large;
  const float rest = large + small - offset;
  return 1 - 0.5F * rest * rest / (large * small);
}

}  // namespace detail

Grid<PixelStep> find_steps(const SampleBins& bins, const EdgeOptions& options) {
  assert(options.margin < 1);  // range_around() looks no farther
  const Extent plane = bins.plane();
  Grid<PixelStep> steps(plane);
  const double variance = bins.luminance_squares() / static_cast<double>(std::max<std::size_t>(bins.size(), 1));
  const auto least_range = static_cast<float>(double{options.contrast} * std::sqrt(variance));
  const Grid<Range> ranges = pixel_ranges(bins);
#pragma omp parallel
  {
    StepFinder finder(bins, options, least_range);
#pragma omp for schedule(dynamic, rows_at_once)
    for (std::uint32_t y = 0; y < plane.height; ++y) {
      for (std::uint32_t x = 0; x < plane.width; ++x) {
        if (range_around(ranges, x, y) > least_range) steps.at(x, y) = finder.find(x, y);
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
