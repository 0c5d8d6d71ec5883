#include "harness/voronoi_reconstruction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "harness/sample_bins.h"
#include "sampling/voronoi.h"

namespace abn::harness {
namespace {

constexpr float first_margin = 0.75F;  // [px]
constexpr float growth = 1.6F;
constexpr float last_margin = 6.7F;
constexpr std::size_t few = 16;  // candidates that are clipped against each other without further division
constexpr int deepest = 12;
constexpr int dedupe_level = 3;  // by here a crowd is either divided or coincident
constexpr int rows_at_once = 4;

struct Rectangle {
  double left, top, right, bottom;
};

double square(double x) { return x * x; }

double nearest_squared(const Rectangle& r, Vec2d p) {
  return square(std::max({r.left - p.x, p.x - r.right, 0.0})) + square(std::max({r.top - p.y, p.y - r.bottom, 0.0}));
}

double farthest_squared(const Rectangle& r, Vec2d p) {
  return square(std::max(p.x - r.left, r.right - p.x)) + square(std::max(p.y - r.top, r.bottom - p.y));
}

/// A convex polygon about a site, in coordinates relative to it.
class Cell {
 public:
  void start(const Rectangle& r, Vec2d site) {
    at_ = {{r.left - site.x, r.top - site.y},
           {r.right - site.x, r.top - site.y},
           {r.right - site.x, r.bottom - site.y},
           {r.left - site.x, r.bottom - site.y}};
    measure();
  }

  /// Keeps what is nearer to the site than to `other`, given relative to it.
  void clip(Vec2d other) {
    const double half = 0.5 * (other.x * other.x + other.y * other.y);
    const auto beyond = [&](Vec2d p) { return p.x * other.x + p.y * other.y - half; };
    if (std::none_of(at_.begin(), at_.end(), [&](Vec2d p) { return beyond(p) > 0; })) return;
    next_.clear();
    Vec2d from = at_.back();
    double from_beyond = beyond(from);
    for (const Vec2d to : at_) {
      const double to_beyond = beyond(to);
      if ((from_beyond > 0) != (to_beyond > 0)) {
        const double t = from_beyond / (from_beyond - to_beyond);
        next_.push_back({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)});
      }
      if (!(to_beyond > 0)) next_.push_back(to);
      from = to;
      from_beyond = to_beyond;
    }
    at_.swap(next_);
    measure();
  }

  void clear() { at_.clear(); }
  bool empty() const { return at_.empty(); }
  /// Squared distance of the farthest vertex from the site.
  double reach_squared() const { return reach_squared_; }

  double area() const {
    double twice = 0;
    for (std::size_t k = 2; k < at_.size(); ++k) {
      twice += (at_[k - 1].x - at_[0].x) * (at_[k].y - at_[0].y) - (at_[k].x - at_[0].x) * (at_[k - 1].y - at_[0].y);
    }
    return std::max(0.5 * twice, 0.0);
  }

 private:
  void measure() {
    reach_squared_ = 0;
    for (const Vec2d p : at_) reach_squared_ = std::max(reach_squared_, p.x * p.x + p.y * p.y);
  }

  std::vector<Vec2d> at_, next_;
  double reach_squared_ = 0;
};

/// The cells' areas within one pixel at a time.
class PixelCells {
 public:
  explicit PixelCells(const SampleBins& bins) : bins_(bins), levels_(deepest + 1) {}

  /// Finds the samples that own a part of pixel (x, y) and their areas; false if none is in reach.
  bool measure(std::uint32_t x, std::uint32_t y) {
    const Rectangle pixel{0, 0, 1, 1};
    for (float margin = first_margin;; margin *= growth) {
      bins_.gather(x, y, margin, true, found_);
      site_.clear();
      double enough = std::numeric_limits<double>::max();
      for (const std::uint32_t i : found_) {
        site_.push_back({double{bins_.x()[i]} - x, double{bins_.y()[i]} - y});
        enough = std::min(enough, farthest_squared(pixel, site_.back()));
      }
      // Every point of the pixel has a sample within sqrt(enough): none from beyond the margin can be nearer.
      if (enough <= square(double{margin})) break;
      if (margin > last_margin) {
        if (found_.empty()) return false;
        break;
      }
    }
    area_.assign(found_.size(), 0.0);
    std::vector<std::uint32_t>& all = levels_[0];
    all.resize(found_.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) all[k] = k;
    divide(pixel, 0);
    return true;
  }

  const std::vector<std::uint32_t>& found() const { return found_; }  // sample numbers
  const std::vector<double>& areas() const { return area_; }          // of each of them [px^2]

 private:
  // The candidates of `r` are levels_[level].
  void divide(const Rectangle& r, int level) {
    keep_possible(r, levels_[static_cast<std::size_t>(level)]);
    std::vector<std::uint32_t>& candidates = levels_[static_cast<std::size_t>(level)];
    if (candidates.size() == 1) {
      area_[candidates[0]] += (r.right - r.left) * (r.bottom - r.top);
      return;
    }
    if (level == dedupe_level && candidates.size() > few) keep_first_of_coincident(candidates);
    if (candidates.size() <= few || level == deepest || crowded_elsewhere(r, candidates)) {
      clip_all(r, candidates);
      return;
    }
    const double x = 0.5 * (r.left + r.right);
    const double y = 0.5 * (r.top + r.bottom);
    const std::array<Rectangle, 4> quadrants{
        {{r.left, r.top, x, y}, {x, r.top, r.right, y}, {r.left, y, x, r.bottom}, {x, y, r.right, r.bottom}}};
    for (const Rectangle& quadrant : quadrants) {
      levels_[static_cast<std::size_t>(level) + 1] = candidates;
      divide(quadrant, level + 1);
    }
  }

  // Many samples far from a rectangle are all the nearest possible from there and cannot be told apart by dividing it.
  bool crowded_elsewhere(const Rectangle& r, const std::vector<std::uint32_t>& candidates) const {
    if (candidates.size() <= 4 * few) return false;
    const auto inside = std::count_if(candidates.begin(), candidates.end(),
                                      [&](std::uint32_t k) { return nearest_squared(r, site_[k]) == 0; });
    return static_cast<std::size_t>(inside) * 8 < candidates.size();
  }

  // Removes those that cannot be nearest anywhere in `r`.
  void keep_possible(const Rectangle& r, std::vector<std::uint32_t>& candidates) const {
    double limit = std::numeric_limits<double>::max();
    for (const std::uint32_t k : candidates) limit = std::min(limit, farthest_squared(r, site_[k]));
    std::erase_if(candidates, [&](std::uint32_t k) { return nearest_squared(r, site_[k]) > limit; });
  }

  void keep_first_of_coincident(std::vector<std::uint32_t>& candidates) const {
    std::sort(candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(site_[a].x, site_[a].y, a) < std::tie(site_[b].x, site_[b].y, b);
    });
    const auto last = std::unique(candidates.begin(), candidates.end(),
                                  [&](std::uint32_t a, std::uint32_t b) { return site_[a] == site_[b]; });
    candidates.erase(last, candidates.end());
  }

  void clip_all(const Rectangle& r, const std::vector<std::uint32_t>& candidates) {
    // Those near the middle first: they leave nothing of the cells of most others.
    const Vec2d middle{0.5 * (r.left + r.right), 0.5 * (r.top + r.bottom)};
    order_ = candidates;
    distance_.resize(found_.size());
    for (const std::uint32_t k : candidates)
      distance_[k] = square(site_[k].x - middle.x) + square(site_[k].y - middle.y);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return distance_[a] != distance_[b] ? distance_[a] < distance_[b] : a < b;
    });
    for (const std::uint32_t k : order_) {
      cell_.start(r, site_[k]);
      for (const std::uint32_t other : order_) {
        if (other == k) continue;
        const Vec2d offset{site_[other].x - site_[k].x, site_[other].y - site_[k].y};
        const double squared = offset.x * offset.x + offset.y * offset.y;
        if (squared == 0) {
          if (other < k) cell_.clear();
        } else if (squared < 4 * cell_.reach_squared()) {
          cell_.clip(offset);
        }
        if (cell_.empty()) break;
      }
      if (!cell_.empty()) area_[k] += cell_.area();
    }
  }

  const SampleBins& bins_;
  std::vector<std::uint32_t> found_, order_;
  std::vector<Vec2d> site_;  // relative to the pixel's corner
  std::vector<double> area_, distance_;
  std::vector<std::vector<std::uint32_t>> levels_;
  Cell cell_;
};

}  // namespace

Developed voronoi(const Film& film) {
  const SampleBins bins(film);
  const Extent plane = bins.plane();
  const std::uint32_t channels = bins.channels();
  Developed developed = developed_for(film);
  Grid<std::uint8_t> covered(plane);
#pragma omp parallel
  {
    PixelCells cells(bins);
#pragma omp for schedule(dynamic, rows_at_once)
    for (std::uint32_t y = 0; y < plane.height; ++y) {
      for (std::uint32_t x = 0; x < plane.width; ++x) {
        if (!cells.measure(x, y)) continue;
        covered.at(x, y) = 1;
        const float* first = bins.value(cells.found()[0]);  // constants come out exactly
        std::array<double, 3> sum{};
        for (std::size_t k = 0; k < cells.found().size(); ++k) {
          const float* value = bins.value(cells.found()[k]);
          for (std::uint32_t c = 0; c < channels; ++c)
            sum[c] += cells.areas()[k] * (double{value[c]} - double{first[c]});
        }
        for (std::uint32_t c = 0; c < channels; ++c) {
          developed.image.texel(x, y)[c] = static_cast<float>(double{first[c]} + sum[c]);
        }
      }
    }
  }
  for (std::size_t p = 0; p < plane.area(); ++p) {
    developed.empty_pixels += static_cast<std::uint64_t>(bins.begin(p) == bins.end(p));
  }
  fill_empty(developed.image, covered);
  return developed;
}

}  // namespace abn::harness
