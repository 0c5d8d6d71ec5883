// What finding steps on the host and on a device have in common: classes of luminances, and the lines between them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "sampling/hd.h"
#include "sampling/kriging/pixel_estimates.h"

namespace abn::step_rules {

inline constexpr std::uint32_t angles = 64;        // of the first look
inline constexpr std::uint32_t enough_angles = 5;  // that separate: below, those around the best one are looked at
inline constexpr std::uint32_t fine_angles = 24;   // on either side of none, see fine_angle()
inline constexpr int refinements = 3;
inline constexpr float hopeless = -0.12F;  // gap [px] of the best coarse angle below which no finer one will separate
inline constexpr double least_weight = 1e-9;  // of all families together [px]
inline constexpr float far_away = 1e30F;      // [px]

inline constexpr int windows = 3;
/// The margin of a pixel's windows, the largest first [px].
ABN_HD inline float window_margin(int window, float margin) {
  return (window == 0 ? 1.0F : (window == 1 ? 0.5F : 0.0F)) * margin;
}

/// The range of luminances above which steps are looked for.
ABN_HD inline float least_range(double luminance_squares, double samples, float contrast) {
  return static_cast<float>(static_cast<double>(contrast) *
                            std::sqrt(luminance_squares / (samples > 1 ? samples : 1.0)));
}

ABN_HD inline double coarse_angle(std::uint32_t a) { return std::numbers::pi * static_cast<double>(a) / angles; }

/// Angles 8, then 32, then 128 times as dense around the best one.
struct FineAngles {
  double first, spacing;
  ABN_HD double operator[](std::uint32_t a) const { return first + spacing * static_cast<double>(a); }
};
ABN_HD inline FineAngles around(double centre, double spacing) { return {centre - spacing * fine_angles / 2, spacing}; }
inline constexpr double first_spacing = std::numbers::pi / angles / 8;

/// Two classes of luminances.
struct Split {
  bool good = false;
  float threshold = 0;
};

/// By the threshold that explains most of the luminances' variance, of n > 0 rising values.
ABN_HD inline Split split_classes(const float* sorted, std::size_t n, const EdgeOptions& options) {
  Split split;
  double mean = 0;
  for (std::size_t k = 0; k < n; ++k) mean += static_cast<double>(sorted[k]);
  mean /= static_cast<double>(n);
  double total = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double deviation = static_cast<double>(sorted[k]) - mean;
    total += deviation * deviation;
  }
  // Between-class variance: with values about their mean the two class sums are opposite.
  double sum = 0;
  double best = 0;
  std::size_t at = 0;
  for (std::size_t k = 1; k < n; ++k) {
    sum += static_cast<double>(sorted[k - 1]) - mean;
    if (!(sorted[k] > sorted[k - 1])) continue;
    const double between = sum * sum * (1 / static_cast<double>(k) + 1 / static_cast<double>(n - k));
    if (between > best) {
      best = between;
      at = k;
    }
  }
  if (best < options.explained * total || at < options.class_samples || n - at < options.class_samples) return split;
  const float middle = 0.5F * (sorted[at - 1] + sorted[at]);
  split.threshold = middle > sorted[at - 1] ? middle : sorted[at];
  split.good = true;
  return split;
}

/// Normal x cosine + y sine of a family of separating lines: all offsets in [begin, begin + gap], if gap > 0.
struct Family {
  float gap;
  float begin;
  bool low_first;  // the lower class has the smaller offsets
};

/// From the extent of either class along the normal.
ABN_HD inline Family family_between(float low_min, float low_max, float high_min, float high_max) {
  const float low_first = high_min - low_max;
  const float high_first = low_min - high_max;
  if (low_first >= high_first) return {low_first, low_max, true};
  return {high_first, high_max, false};
}

/// The share of the unit square where cosine * x + sine * y < offset, in closed form.
ABN_HD inline float half_plane_share(float cosine, float sine, float offset) {
  // By symmetry both components may be taken positive, the larger one first.
  offset -= (0.0F < cosine ? 0.0F : cosine) + (0.0F < sine ? 0.0F : sine);
  const float c = std::fabs(cosine);
  const float s = std::fabs(sine);
  const float large = c < s ? s : c;
  const float small = s < c ? s : c;
  if (offset <= 0) return 0;
  if (offset >= large + small) return 1;
  if (small < 1e-6F) {
    const float share = offset / large;
    return share < 1.0F ? share : 1.0F;
  }
  if (offset <= small) return 0.5F * offset * offset / (large * small);
  if (offset <= large) return (offset - 0.5F * small) / large;
  const float rest = large + small - offset;
  return 1 - 0.5F * rest * rest / (large * small);
}

/// The pixel's share below the lines of a family at the nodes of Gauss-Legendre over the offset: the share is a
/// piecewise parabola of it.
struct NodeShares {
  float below[3];
};
ABN_HD inline NodeShares shares_of(float cosine, float sine, const Family& family) {
  return {{half_plane_share(cosine, sine, family.begin + 0.1127017F * family.gap),
           half_plane_share(cosine, sine, family.begin + 0.5F * family.gap),
           half_plane_share(cosine, sine, family.begin + 0.8872983F * family.gap)}};
}

/// Mean and spread of the upper side's share over families of lines.
struct SharePosterior {
  double weight = 0, sum = 0, squares = 0;

  ABN_HD void add(float gap, bool low_first, const NodeShares& shares) {
    for (int k = 0; k < 3; ++k) {
      const auto below = static_cast<double>(shares.below[k]);
      const double upper = low_first ? 1 - below : below;
      const double w = (k == 1 ? 8.0 / 18 : 5.0 / 18) * static_cast<double>(gap);
      weight += w;
      sum += w * upper;
      squares += w * upper * upper;
    }
  }
  /// Precondition: weight > 0.
  ABN_HD void store(PixelStep& step) const {
    const double mean = sum / weight;
    const double variance = squares / weight - mean * mean;
    step.share = static_cast<float>(mean);
    step.share_error = static_cast<float>(std::sqrt(variance < 0 ? 0.0 : variance));
  }
};

/// What a look at all angles gives, in their order.
struct AngleCount {
  std::uint32_t separating = 0, best = 0;
  float widest = -far_away;

  /// Whether lines at this angle separate the classes.
  ABN_HD bool add(std::uint32_t angle, float gap) {
    if (gap > widest) {
      widest = gap;
      best = angle;
    }
    if (!(gap > 0)) return false;
    ++separating;
    return true;
  }
};

}  // namespace abn::step_rules
