#include "sampling/analysis/spacing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <string>

#include "sampling/error.h"

namespace abn::analysis {
namespace {

constexpr double points_per_bucket = 2;
constexpr std::size_t points_per_task = 4096;

/// A square grid of buckets over the unit torus, each sorted by x.
struct Buckets {
  struct Entry {
    double x, y;
    double local;  // its local spacing
    std::uint32_t index;
  };

  std::int32_t side;                 // buckets per axis
  double width;                      // of a bucket
  std::vector<std::uint32_t> begin;  // [side^2 + 1]
  std::vector<Entry> entries;        // [count], bucket by bucket
  std::vector<double> most_local;    // [side^2] largest local spacing in the bucket
  double most = 0;                   // and of all

  Buckets(Points points, std::span<const double> local)
      : side(std::max(1, static_cast<std::int32_t>(
                             std::min(30'000.0, std::sqrt(static_cast<double>(points.size()) / points_per_bucket))))),
        width(1.0 / side) {
    const std::size_t buckets = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    const auto bucket_of = [&](const Point& p) { return index(axis(p.x), axis(p.y)); };
    begin.assign(buckets + 1, 0);
    for (const Point& p : points) ++begin[bucket_of(p) + 1];
    for (std::size_t b = 1; b <= buckets; ++b) begin[b] += begin[b - 1];
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    entries.resize(points.size());
    most_local.assign(buckets, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t b = bucket_of(points[i]);
      const double own = local.empty() ? 1.0 : local[i];
      entries[next[b]++] = {points[i].x, points[i].y, own, static_cast<std::uint32_t>(i)};
      most_local[b] = std::max(most_local[b], own);
      most = std::max(most, own);
    }
    for (std::size_t b = 0; b < buckets; ++b) {
      std::sort(entries.begin() + begin[b], entries.begin() + begin[b + 1],
                [](const Entry& p, const Entry& q) { return p.x != q.x ? p.x < q.x : p.index < q.index; });
    }
  }

  std::int32_t axis(double position) const {
    return std::clamp(static_cast<std::int32_t>(position * side), 0, side - 1);
  }
  std::size_t index(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side) + static_cast<std::size_t>(column);
  }
};

double square(double value) { return value * value; }

/// Squared distance of `from` to the nearest other entry in units of the pair's spacing. Rings of buckets are searched
/// until none can hold a nearer one.
double nearest_squared(const Buckets& buckets, const Buckets::Entry& from) {
  // The whole torus away is the point's own image.
  double best = 1.0 / square(from.local);
  const std::int32_t column = buckets.axis(from.x);
  const std::int32_t row = buckets.axis(from.y);
  const double left = from.x - column * buckets.width;
  const double up = from.y - row * buckets.width;
  // A bucket's number and border are rounded, so that a point may be nearer than its bucket by this much.
  constexpr double slack = 1e-12;
  const auto gap = [&](std::int32_t offset, double below) {
    if (offset == 0) return 0.0;
    const double distance = offset < 0 ? below - (offset + 1) * buckets.width : offset * buckets.width - below;
    return std::max(0.0, distance - slack);
  };

  const auto visit = [&](std::int32_t offset_x, std::int32_t offset_y) {
    std::int32_t bucket_x = column + offset_x;
    std::int32_t bucket_y = row + offset_y;
    double shift_x = 0;
    double shift_y = 0;
    for (; bucket_x < 0; bucket_x += buckets.side) shift_x -= 1;
    for (; bucket_x >= buckets.side; bucket_x -= buckets.side) shift_x += 1;
    for (; bucket_y < 0; bucket_y += buckets.side) shift_y -= 1;
    for (; bucket_y >= buckets.side; bucket_y -= buckets.side) shift_y += 1;
    const std::size_t bucket = buckets.index(bucket_x, bucket_y);
    const auto* const first = buckets.entries.data() + buckets.begin[bucket];
    const auto* const end = buckets.entries.data() + buckets.begin[bucket + 1];
    const double widest = square(0.5 * (from.local + buckets.most_local[bucket]));
    if (first == end || square(gap(offset_x, left)) + square(gap(offset_y, up)) >= best * widest) return;
    const double x = from.x - shift_x;
    const double y = from.y - shift_y;
    const auto try_entry = [&](const Buckets::Entry& to) {
      if (to.index == from.index) return;
      const double pair = square(0.5 * (from.local + to.local));
      best = std::min(best, (square(to.x - x) + square(to.y - y)) / pair);
    };
    const auto* const middle =
        std::lower_bound(first, end, x, [](const Buckets::Entry& entry, double value) { return entry.x < value; });
    for (const auto* to = middle; to != end && square(to->x - x) < best * widest; ++to) try_entry(*to);
    for (const auto* to = middle; to != first && square((to - 1)->x - x) < best * widest; --to) try_entry(*(to - 1));
  };

  const double closest_border = std::min({left, buckets.width - left, up, buckets.width - up});
  const double widest = square(0.5 * (from.local + buckets.most));
  visit(0, 0);
  for (std::int32_t ring = 1; ring <= buckets.side; ++ring) {
    if (square(std::max(0.0, closest_border + (ring - 1) * buckets.width - slack)) >= best * widest) break;
    for (std::int32_t along = -ring; along <= ring; ++along) {
      visit(along, -ring);
      visit(along, ring);
      if (std::abs(along) < ring) {
        visit(-ring, along);
        visit(ring, along);
      }
    }
  }
  return best;
}

/// The local spacings scaled to a mean square of 1; empty if `local` is.
std::vector<double> scaled(std::span<const double> local, std::size_t count) {
  if (local.empty()) return {};
  if (local.size() != count) {
    throw ConfigError("spacing: " + std::to_string(local.size()) + " local spacings for " + std::to_string(count) +
                      " points; give one for each");
  }
  double sum = 0;
  for (const double s : local) {
    if (!(s > 0 && std::isfinite(s))) {
      throw ConfigError("spacing: a local spacing is " + std::to_string(s) + "; all must be positive");
    }
    sum += s * s;
  }
  const double scale = std::sqrt(static_cast<double>(count) / sum);
  std::vector<double> result(local.begin(), local.end());
  for (double& s : result) s *= scale;
  return result;
}

}  // namespace

double hexagonal_spacing(std::size_t count) {
  return std::sqrt(2.0 / (std::numbers::sqrt3 * static_cast<double>(count)));
}

Spacing spacing(Points points, std::span<const double> local_spacing) {
  if (points.empty()) throw ConfigError("spacing: the point set is empty; give at least one point");
  const Buckets buckets(points, scaled(local_spacing, points.size()));
  const double unit = hexagonal_spacing(points.size());
  Spacing result;
  result.nearest.resize(points.size());
  const auto tasks = static_cast<std::ptrdiff_t>((points.size() + points_per_task - 1) / points_per_task);
#pragma omp parallel for schedule(dynamic, 1) if (tasks > 1)
  for (std::ptrdiff_t task = 0; task < tasks; ++task) {
    const std::size_t first = static_cast<std::size_t>(task) * points_per_task;
    const std::size_t end = std::min(points.size(), first + points_per_task);
    for (std::size_t slot = first; slot < end; ++slot) {
      const Buckets::Entry& entry = buckets.entries[slot];
      result.nearest[entry.index] = std::sqrt(nearest_squared(buckets, entry)) / unit;
    }
  }

  std::vector<double> sorted = result.nearest;
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](std::size_t percent) { return sorted[(sorted.size() * percent + 99) / 100 - 1]; };
  result.smallest = sorted.front();
  result.mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
  result.quantile_01 = quantile(1);
  result.median = quantile(50);
  return result;
}

}  // namespace abn::analysis
