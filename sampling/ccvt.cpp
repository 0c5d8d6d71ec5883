#include "sampling/ccvt.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "sampling/relaxation_start.h"
#include "sampling/rng.h"
#include "sampling/sph_blue_noise.h"
#include "sampling/torus_cells.h"
#include "sampling/vector_clones.h"

namespace abn {
namespace {

constexpr std::uint64_t most_samples = std::uint64_t{1} << 31;
constexpr float least_gain = 1e-6F;     // of a swap [spacings^2]: below is rounding
constexpr int settling = 20;            // iterations, at most, before the sites move ...
constexpr double settled_swaps = 0.01;  // ... or until fewer than this share of the samples is exchanged

struct Size {
  float width, height;  // [px]
};

/// Squared distance on the torus.
inline float distance2(Vec2f a, Vec2f b, Size size) {
  const float x = std::abs(a.x - b.x);
  const float y = std::abs(a.y - b.y);
  const float dx = x < size.width - x ? x : size.width - x;
  const float dy = y < size.height - y ? y : size.height - y;
  return dx * dx + dy * dy;
}

struct Range {
  float least, greatest;
};

/// |x - a|^2 - |x - b|^2 of every sample: the less, the rather it belongs to a.
ABN_VECTOR_CLONES Range preferences(const Vec2f* sample, std::size_t count, Vec2f a, Vec2f b, Size size, float* key) {
  float least = std::numeric_limits<float>::max();
  float greatest = -std::numeric_limits<float>::max();
#pragma omp simd reduction(min : least) reduction(max : greatest)
  for (std::size_t k = 0; k < count; ++k) {
    const float value = distance2(sample[k], a, size) - distance2(sample[k], b, size);
    key[k] = value;
    least = value < least ? value : least;
    greatest = value > greatest ? value : greatest;
  }
  return {least, greatest};
}

/// Halves points and samples by the same share across the longer side of their box, and so on, until every point has
/// `capacity` samples: near ones, if the points are spread evenly. `order` [points] holds the points' numbers and ends
/// in the order of the samples. The shares are random between 1/3 and 2/3: equal ones would leave a lattice.
class Halving {
 public:
  Halving(const std::vector<Vec2f>& points, std::size_t capacity, Rng rng)
      : points_(points), capacity_(capacity), rng_(rng) {}

  void halve(std::span<std::uint32_t> order, std::span<Vec2f> samples, float width, float height) {
    while (order.size() > 1) {
      const auto third = static_cast<std::uint32_t>(std::max<std::size_t>(order.size() / 3, 1));
      const std::size_t first = third + rng_.below(static_cast<std::uint32_t>(order.size()) - 2 * third + 1);
      const auto coordinate = width >= height ? &Vec2f::x : &Vec2f::y;
      std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(first), order.end(),
                       [&](std::uint32_t a, std::uint32_t b) {
                         return std::pair(points_[a].*coordinate, a) < std::pair(points_[b].*coordinate, b);
                       });
      std::nth_element(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(first * capacity_), samples.end(),
                       [&](Vec2f a, Vec2f b) { return a.*coordinate < b.*coordinate; });
      const float share = static_cast<float>(first) / static_cast<float>(order.size());
      float& side = width >= height ? width : height;
      const float other = side * (1 - share);
      side *= share;
      halve(order.first(first), samples.first(first * capacity_), width, height);
      side = other;
      order = order.subspan(first);
      samples = samples.subspan(first * capacity_);
    }
  }

 private:
  const std::vector<Vec2f>& points_;
  std::size_t capacity_;
  Rng rng_;
};

/// The samples in the order of the points that they are assigned to, equally many to each.
std::vector<Vec2f> assigned(const std::vector<Vec2f>& points, std::vector<Vec2f> samples, Extent plane, Rng rng) {
  const std::size_t capacity = samples.size() / points.size();
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  Halving(points, capacity, rng)
      .halve(order, samples, static_cast<float>(plane.width), static_cast<float>(plane.height));
  std::vector<Vec2f> by_point(samples.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(k * capacity), capacity,
                by_point.begin() + static_cast<std::ptrdiff_t>(order[k] * capacity));
  }
  return by_point;
}

/// Sites and the samples they own.
class Tessellation {
 public:
  /// Site i owns samples [i*c, (i+1)*c).
  Tessellation(std::vector<Vec2f>& sites, std::vector<Vec2f>& samples, Extent plane)
      : sites_(sites),
        samples_(samples),
        plane_(plane),
        size_{static_cast<float>(plane.width), static_cast<float>(plane.height)},
        capacity_(samples.size() / sites.size()),
        spacing_(std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(sites.size()))),
        gain_(least_gain * static_cast<float>(spacing_ * spacing_)),
        cells_(size_.width, size_.height, static_cast<float>(spacing_), static_cast<float>(spacing_), sites.size()),
        radius_(sites.size()),
        changed_(sites.size(), 1),
        changed_before_(sites.size(), 1),
        place_(sites.size()),
        sorted_(sites.size()),
        key_a_(capacity_),
        key_b_(capacity_) {
    update_radii();
    sort_sites();
  }

  /// Exchanges samples between all pairs of near sites once; returns the number of swaps.
  std::uint64_t exchange() {
    std::swap(changed_before_, changed_);
    std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
    const float farthest = *std::max_element(radius_.begin(), radius_.end());
    std::uint64_t swaps = 0;
    for (const std::uint32_t i : sorted_) {
      const Vec2f s = sites_[i];
      const float reach = radius_[i] + farthest;
      const float reach_x = std::min(reach, size_.width / 2) + cells_.rounding(reach);
      const float reach_y = std::min(reach, size_.height / 2) + cells_.rounding(reach);
      cells_.for_each_run(s.x - reach_x, s.x + reach_x, s.y - reach_y, s.y + reach_y,
                          [&](std::size_t begin, std::size_t end, float, float) {
                            for (std::size_t k = begin; k < end; ++k) {
                              const std::uint32_t j = sorted_[k];
                              if (i < j) swaps += exchange(i, j);
                            }
                          });
    }
    return swaps;
  }

  /// Moves every site the given share of the way to its centroid; returns their mean move [spacings].
  double move(double relaxation) {
    double moved = 0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      const Vec2f s = sites_[i];
      double x = 0, y = 0;
      for (const Vec2f sample : samples_of(i)) {
        x += offset_on_torus(sample.x, s.x, plane_.width);
        y += offset_on_torus(sample.y, s.y, plane_.height);
      }
      x *= relaxation / static_cast<double>(capacity_);
      y *= relaxation / static_cast<double>(capacity_);
      const Vec2f centroid{wrap_to_plane(double{s.x} + x, plane_.width), wrap_to_plane(double{s.y} + y, plane_.height)};
      if (centroid == s) continue;
      sites_[i] = centroid;
      changed_[i] = 1;
      moved += std::sqrt(x * x + y * y) / spacing_;
    }
    update_radii();
    sort_sites();
    return moved / static_cast<double>(sites_.size());
  }

  /// Mean of the squared distances over area/N.
  double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      for (const Vec2f sample : samples_of(i)) sum += double{distance2(sample, sites_[i], size_)};
    }
    return sum / (static_cast<double>(samples_.size()) * spacing_ * spacing_);
  }

 private:
  std::span<Vec2f> samples_of(std::size_t site) { return std::span(samples_).subspan(site * capacity_, capacity_); }
  std::span<const Vec2f> samples_of(std::size_t site) const {
    return std::span<const Vec2f>(samples_).subspan(site * capacity_, capacity_);
  }

  static double offset_on_torus(float to, float from, std::uint32_t length) {
    const double d = double{to} - double{from};
    return d > 0.5 * length ? d - length : d < -0.5 * length ? d + length : d;
  }

  void update_radii() {
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      float greatest = 0;
      for (const Vec2f sample : samples_of(i)) greatest = std::max(greatest, distance2(sample, sites_[i], size_));
      radius_[i] = std::sqrt(greatest);
    }
  }

  void sort_sites() {
    std::vector<float> x(sites_.size()), y(sites_.size());
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      x[i] = sites_[i].x;
      y[i] = sites_[i].y;
    }
    cells_.sort(x, y, place_);
    for (std::size_t i = 0; i < sites_.size(); ++i) sorted_[place_[i]] = static_cast<std::uint32_t>(i);
  }

  std::uint64_t exchange(std::uint32_t i, std::uint32_t j) {
    // A pair that could not gain when it was met last cannot gain now if neither site has changed since.
    if ((changed_before_[i] | changed_before_[j] | changed_[i] | changed_[j]) == 0) return 0;
    const Vec2f a = sites_[i];
    const Vec2f b = sites_[j];
    // A sample of i gains by going to j only beyond the middle; so sets that do not reach each other have nothing to
    // exchange.
    const float reach = radius_[i] + radius_[j];
    if (distance2(a, b, size_) > reach * reach) return 0;
    const std::span<Vec2f> of_a = samples_of(i);
    const std::span<Vec2f> of_b = samples_of(j);
    const Range range_a = preferences(of_a.data(), capacity_, a, b, size_, key_a_.data());
    const Range range_b = preferences(of_b.data(), capacity_, a, b, size_, key_b_.data());
    if (!(range_a.greatest > range_b.least + gain_)) return 0;

    const auto collect = [&](std::vector<std::pair<float, std::uint32_t>>& list, const std::vector<float>& key,
                             auto&& gains) {
      list.clear();
      for (std::size_t k = 0; k < capacity_; ++k) {
        if (gains(key[k])) list.emplace_back(key[k], static_cast<std::uint32_t>(k));
      }
    };
    collect(leaving_a_, key_a_, [&](float key) { return key > range_b.least + gain_; });
    collect(leaving_b_, key_b_, [&](float key) { return key + gain_ < range_a.greatest; });
    std::sort(leaving_a_.begin(), leaving_a_.end(), [](const auto& p, const auto& q) {
      return p.first > q.first || (p.first == q.first && p.second < q.second);
    });
    std::sort(leaving_b_.begin(), leaving_b_.end());
    std::uint64_t swaps = 0;
    for (; swaps < std::min(leaving_a_.size(), leaving_b_.size()); ++swaps) {
      if (!(leaving_a_[swaps].first > leaving_b_[swaps].first + gain_)) break;
      Vec2f& to_b = of_a[leaving_a_[swaps].second];
      Vec2f& to_a = of_b[leaving_b_[swaps].second];
      std::swap(to_a, to_b);
      radius_[i] = std::max(radius_[i], std::sqrt(distance2(to_b, a, size_)));  // now of site i
      radius_[j] = std::max(radius_[j], std::sqrt(distance2(to_a, b, size_)));
    }
    changed_[i] = changed_[j] = 1;
    return swaps;
  }

  std::vector<Vec2f>& sites_;    // [px]
  std::vector<Vec2f>& samples_;  // [px], capacity_ of every site together
  Extent plane_;
  Size size_;
  std::size_t capacity_;
  double spacing_;  // [px]
  float gain_;      // [px^2]
  TorusCells cells_;
  std::vector<float> radius_;                           // no sample of the site is farther away [px]
  std::vector<std::uint8_t> changed_, changed_before_;  // place or samples, in this iteration and the one before
  std::vector<std::uint32_t> place_, sorted_;           // sites by cell
  std::vector<float> key_a_, key_b_;                    // scratch of exchange()
  std::vector<std::pair<float, std::uint32_t>> leaving_a_, leaving_b_;
};

/// Jittered samples that stand for the area, `count` of them; their numbers are not those of the start.
std::vector<Vec2f> area_samples(Extent plane, std::uint64_t count, std::uint64_t seed) {
  Rng rng(seed, stream_id("ccvt area"), count);
  const std::uint64_t high = rng.next();
  return coarse_cell_positions(plane, count, high << 32 | rng.next(), 1);
}

/// The capacities to go through: a fine set of samples starts from a coarser one's result, four times faster.
std::vector<int> levels(int capacity) {
  std::vector<int> levels{capacity};
  while (levels.back() > 16 && levels.back() % 4 == 0) levels.push_back(levels.back() / 4);
  std::reverse(levels.begin(), levels.end());
  return levels;
}

}  // namespace

CcvtReport relax_ccvt(std::vector<Vec2f>& sites, std::vector<Vec2f>& samples, Extent plane, const CcvtDescent& descent,
                      std::uint64_t seed) {
  CcvtReport report;
  samples.clear();
  if (sites.empty()) return report;
  for (const int capacity : levels(descent.capacity)) {
    // Every level's samples follow those of the level before, which are more of the same plane.
    const bool first = samples.empty();
    samples = assigned(first ? sites : samples,
                       area_samples(plane, sites.size() * static_cast<std::uint64_t>(capacity), seed), plane,
                       Rng(seed, stream_id("ccvt assignment"), static_cast<std::uint64_t>(capacity)));
    Tessellation state(sites, samples, plane);
    if (first) report.first_energy = state.energy();
    for (int i = 0; first && i < settling && descent.iterations > 0; ++i) {
      const std::uint64_t swaps = state.exchange();
      if (static_cast<double>(swaps) < settled_swaps * static_cast<double>(samples.size())) break;
    }
    report.converged = false;
    for (int i = 0; i < descent.iterations && !report.converged; ++i) {
      report.mean_displacement = state.move(descent.relaxation);
      const std::uint64_t swaps = state.exchange();
      report.swaps = static_cast<double>(swaps) / static_cast<double>(sites.size());
      ++report.iterations;
      report.converged = swaps == 0;
    }
    if (descent.iterations > 0) state.move(1);
    report.energy = state.energy();
  }
  return report;
}

const StrategyInfo Ccvt::info = {
    .name = "ccvt",
    .family = "blue noise",
    .summary = "Capacity-constrained Voronoi tessellation: centroids of cells that all have the same area.",
    .cite = "Balzer, Schlömer, Deussen 2009, Capacity-constrained point distributions: a variant of Lloyd's method",
    .advice = "Few long waves and no lattice, at any size; takes minutes where gbn and sph_blue_noise take seconds.",
};

std::vector<Field<Ccvt::Params>> Ccvt::fields() {
  return {
      {"capacity", &Params::capacity, "samples of the area per site; more make equal areas more exact", 1, 65536},
      {"iterations", &Params::iterations,
       "iterations at each capacity on the way, at most; ends early when no swap gains", 0, 1000000},
      {"relaxation", &Params::relaxation, "share of the way to the centroid; above 1 overshoots and gets farther", 0.01,
       1.99},
      start_field<Params>(),
  };
}

Ccvt::Ccvt(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  require_budget(info.name, task.budget, most_samples / static_cast<std::uint64_t>(params.capacity));
}

SampleBatch Ccvt::next(const Feedback&) {
  if (samples_.empty()) {
    std::vector<Vec2f> sites = relaxation_start(params_.start, task_.plane, task_.budget, task_.seed);
    std::vector<Vec2f> area;
    report_ = relax_ccvt(
        sites, area, task_.plane,
        {.capacity = params_.capacity, .iterations = params_.iterations, .relaxation = params_.relaxation}, task_.seed);
    samples_.assign(sites, task_.plane);
  }
  return samples_.next();
}

std::vector<Diagnostic> Ccvt::diagnostics() const {
  if (samples_.empty()) return {};
  return {
      {"iterations", static_cast<double>(report_.iterations)},
      {"mean_displacement", report_.mean_displacement},
      {"swaps_per_site", report_.swaps},
      {"first_energy", report_.first_energy},
      {"energy", report_.energy},
      {"converged", report_.converged ? 1.0 : 0.0},
      {"backend", 0, "cpu, one thread"},
  };
}

}  // namespace abn
