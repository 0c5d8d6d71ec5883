#include "sampling/voronoi.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

#include "sampling/error.h"

namespace abn {
namespace {

constexpr double points_per_bucket = 1.6;

/// position modulo length, in [0, length). Rounding may reach either border, which are one. What is all but 0 becomes
/// 0, so that the squared distance of two different points never underflows.
double wrapped(double position, double length) {
  const double rest = position >= 0 && position < length ? position : position - std::floor(position / length) * length;
  return rest >= 1e-100 * length && rest < length ? rest : 0.0;
}

double largest_squared(const VoronoiCell& cell) {
  double largest = 0;
  for (std::size_t k = 0; k < cell.size(); ++k) {
    largest = std::max(largest, cell.x[k] * cell.x[k] + cell.y[k] * cell.y[k]);
  }
  return largest;
}

/// Removes the part of the cell nearer to the point at (dx, dy) than to the origin; tells whether there was one.
/// The vertices removed are one run around the one farthest beyond the bisector: of nearly equal vertices on the
/// bisector, rounding must not make several runs.
bool clip(VoronoiCell& cell, double dx, double dy, std::uint32_t neighbour) {
  const std::size_t count = cell.size();
  const double half = 0.5 * (dx * dx + dy * dy);
  const auto beyond = [&](std::size_t k) { return cell.x[k] * dx + cell.y[k] * dy - half; };
  std::size_t farthest = 0;
  double most = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double value = beyond(k);
    farthest = value > most ? k : farthest;
    most = std::max(most, value);
  }
  if (!(most > 0)) return false;

  const auto after = [&](std::size_t k) { return k + 1 == count ? 0 : k + 1; };
  const auto before = [&](std::size_t k) { return k == 0 ? count - 1 : k - 1; };
  std::size_t last = farthest;
  while (beyond(after(last)) > 0) {
    last = after(last);
    if (last == farthest) {  // nothing is left, see the class on points closer than the rounding
      cell.x.clear();
      cell.y.clear();
      cell.neighbour.clear();
      return true;
    }
  }
  std::size_t first = farthest;
  while (beyond(before(first)) > 0) first = before(first);

  const auto crossing = [&](std::size_t kept, std::size_t removed) {
    const double at_kept = beyond(kept);
    const double t = at_kept / (at_kept - beyond(removed));
    return Vec2d{cell.x[kept] + t * (cell.x[removed] - cell.x[kept]),
                 cell.y[kept] + t * (cell.y[removed] - cell.y[kept])};
  };
  const Vec2d enter = crossing(before(first), first);
  const Vec2d leave = crossing(after(last), last);
  const std::uint32_t leaving = cell.neighbour[last];

  // Vertices first..last (around the end of the list if first > last) become enter, leave.
  const auto replace = [&](auto& list, auto one, auto two) {
    const auto at = [&](std::size_t k) { return list.begin() + static_cast<std::ptrdiff_t>(k); };
    if (first > last) {
      list.erase(at(first), list.end());
      list.erase(list.begin(), at(last + 1));
      list.push_back(one);
      list.push_back(two);
    } else if (first == last) {
      list[first] = one;
      list.insert(at(first + 1), two);
    } else {
      list[first] = one;
      list[first + 1] = two;
      list.erase(at(first + 2), at(last + 1));
    }
  };
  replace(cell.x, enter.x, leave.x);
  replace(cell.y, enter.y, leave.y);
  replace(cell.neighbour, neighbour, leaving);
  return true;
}

}  // namespace

double VoronoiCell::area() const {
  double twice = 0;
  for (std::size_t k = 0; k < size(); ++k) {
    const std::size_t next = k + 1 == size() ? 0 : k + 1;
    twice += x[k] * y[next] - x[next] * y[k];
  }
  return 0.5 * twice;
}

Vec2d VoronoiCell::centroid() const {
  double twice = 0;
  Vec2d moment;
  for (std::size_t k = 0; k < size(); ++k) {
    const std::size_t next = k + 1 == size() ? 0 : k + 1;
    const double triangle = x[k] * y[next] - x[next] * y[k];
    twice += triangle;
    moment.x += triangle * (x[k] + x[next]);
    moment.y += triangle * (y[k] + y[next]);
  }
  return twice > 0 ? Vec2d{moment.x / (3 * twice), moment.y / (3 * twice)} : Vec2d{};
}

double VoronoiCell::farthest_vertex() const { return std::sqrt(largest_squared(*this)); }

std::int32_t PeriodicVoronoi::Axis::bucket_of(double position) const {
  return std::min(static_cast<std::int32_t>(position / bucket), count - 1);
}

PeriodicVoronoi::PeriodicVoronoi(std::span<const Vec2f> positions, Extent plane) {
  x_.length = plane.width;
  y_.length = plane.height;
  position_.reserve(positions.size());
  for (const Vec2f p : positions) position_.push_back({p.x, p.y});
  build();
}

PeriodicVoronoi::PeriodicVoronoi(std::span<const Vec2d> positions, double width, double height)
    : position_(positions.begin(), positions.end()) {
  x_.length = width;
  y_.length = height;
  build();
}

void PeriodicVoronoi::build() {
  if (!(x_.length > 0 && y_.length > 0 && std::isfinite(x_.length) && std::isfinite(y_.length))) {
    throw ConfigError("the Voronoi cells need a plane of positive size, not " + std::to_string(x_.length) + " x " +
                      std::to_string(y_.length));
  }
  if (position_.size() >= std::numeric_limits<std::uint32_t>::max()) {
    throw ConfigError("the Voronoi cells of " + std::to_string(position_.size()) +
                      " points: use fewer than 4294967295 points");
  }
  for (Vec2d& p : position_) {
    if (!(std::isfinite(p.x) && std::isfinite(p.y))) {
      throw ConfigError("the Voronoi cells need finite positions; point " + std::to_string(&p - position_.data()) +
                        " is (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ")");
    }
    p = {wrapped(p.x, x_.length), wrapped(p.y, y_.length)};
  }

  // Square buckets, unless the plane is narrower than one of them.
  const double buckets = std::max(1.0, static_cast<double>(position_.size()) / points_per_bucket);
  const double columns = std::clamp(std::round(std::sqrt(buckets * x_.length / y_.length)), 1.0, std::ceil(buckets));
  const double rows = std::clamp(std::round(buckets / columns), 1.0, std::ceil(buckets));
  x_.count = static_cast<std::int32_t>(std::min(columns, 1e9));
  y_.count = static_cast<std::int32_t>(std::min(rows, 1e9));
  x_.bucket = x_.length / x_.count;
  y_.bucket = y_.length / y_.count;

  const auto bucket_of = [&](Vec2d p) {
    return static_cast<std::size_t>(y_.bucket_of(p.y)) * static_cast<std::size_t>(x_.count) +
           static_cast<std::size_t>(x_.bucket_of(p.x));
  };
  bucket_begin_.assign(static_cast<std::size_t>(x_.count) * static_cast<std::size_t>(y_.count) + 1, 0);
  for (const Vec2d p : position_) ++bucket_begin_[bucket_of(p) + 1];
  for (std::size_t b = 1; b < bucket_begin_.size(); ++b) bucket_begin_[b] += bucket_begin_[b - 1];
  std::vector<std::uint32_t> next(bucket_begin_.begin(), bucket_begin_.end() - 1);
  index_.resize(position_.size());
  for (std::size_t i = 0; i < position_.size(); ++i)
    index_[next[bucket_of(position_[i])]++] = static_cast<std::uint32_t>(i);

  // By position inside a bucket, so that coincident points follow each other, the owner of their cell first. The others
  // go behind the last bucket, where no search finds them.
  std::vector<std::uint32_t> hidden;
  std::uint32_t kept = 0;
  std::uint32_t begin = 0;
  for (std::size_t b = 0; b + 1 < bucket_begin_.size(); ++b) {
    const std::uint32_t end = bucket_begin_[b + 1];
    std::sort(index_.begin() + begin, index_.begin() + end, [&](std::uint32_t i, std::uint32_t j) {
      const Vec2d p = position_[i];
      const Vec2d q = position_[j];
      return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : i < j;
    });
    bucket_begin_[b] = kept;
    for (std::uint32_t slot = begin; slot < end; ++slot) {
      const std::uint32_t i = index_[slot];
      if (kept > bucket_begin_[b] && position_[index_[kept - 1]] == position_[i]) {
        hidden.push_back(i);
      } else {
        index_[kept++] = i;
      }
    }
    begin = end;
  }
  bucket_begin_.back() = kept;
  std::copy(hidden.begin(), hidden.end(), index_.begin() + kept);
  owner_.assign(position_.size(), true);
  for (const std::uint32_t i : hidden) owner_[i] = false;
  sorted_.reserve(position_.size());
  for (const std::uint32_t i : index_) sorted_.push_back(position_[i]);
}

void PeriodicVoronoi::cell(std::size_t i, VoronoiCell& out) const {
  assert(i < position_.size());
  if (!owner_[i]) {
    out.x.clear();
    out.y.clear();
    out.neighbour.clear();
    return;
  }
  const Vec2d centre = position_[i];
  const auto self = static_cast<std::uint32_t>(i);
  const double half_width = 0.5 * x_.length;
  const double half_height = 0.5 * y_.length;
  // The rectangle is the cell among the point's own images. Inside it every other point has its nearest image at most
  // one plane away on each axis, so that buckets farther away than their number need no visit.
  out.x = {-half_width, half_width, half_width, -half_width};
  out.y = {-half_height, -half_height, half_height, half_height};
  out.neighbour.assign(4, self);
  double reach = 4 * largest_squared(out);  // squared distance beyond which no point touches the cell

  const std::int32_t column = x_.bucket_of(centre.x);
  const std::int32_t row = y_.bucket_of(centre.y);
  const double left = centre.x - column * x_.bucket;  // distances to the borders of the own bucket
  const double right = x_.bucket - left;
  const double up = centre.y - row * y_.bucket;
  const double down = y_.bucket - up;
  // A bucket's number and border are rounded, so that a point may be nearer than its bucket by this much.
  const double slack = 1e-12 * (x_.length + y_.length);
  const auto distance_to = [slack](std::int32_t offset, double below, double above, double bucket) {
    if (offset == 0) return 0.0;
    return std::max(0.0, (offset < 0 ? below - (offset + 1) * bucket : above + (offset - 1) * bucket) - slack);
  };

  const auto visit = [&](std::int32_t offset_x, std::int32_t offset_y) {
    const double away_x = distance_to(offset_x, left, right, x_.bucket);
    const double away_y = distance_to(offset_y, up, down, y_.bucket);
    if (away_x * away_x + away_y * away_y >= reach) return true;
    std::int32_t bucket_x = column + offset_x;
    std::int32_t bucket_y = row + offset_y;
    double shift_x = 0;
    double shift_y = 0;
    for (; bucket_x < 0; bucket_x += x_.count) shift_x -= x_.length;
    for (; bucket_x >= x_.count; bucket_x -= x_.count) shift_x += x_.length;
    for (; bucket_y < 0; bucket_y += y_.count) shift_y -= y_.length;
    for (; bucket_y >= y_.count; bucket_y -= y_.count) shift_y += y_.length;
    const std::size_t bucket =
        static_cast<std::size_t>(bucket_y) * static_cast<std::size_t>(x_.count) + static_cast<std::size_t>(bucket_x);
    // By growing distance in x, in which the bucket is sorted: of many points in one bucket few are looked at.
    const double x = centre.x - shift_x;
    const Vec2d* const begin = sorted_.data() + bucket_begin_[bucket];
    const Vec2d* const end = sorted_.data() + bucket_begin_[bucket + 1];
    const Vec2d* above = std::lower_bound(begin, end, x, [](Vec2d p, double value) { return p.x < value; });
    const Vec2d* below = above;
    while (below != begin || above != end) {
      const bool upwards = below == begin || (above != end && above->x - x < x - (below - 1)->x);
      const Vec2d* const candidate = upwards ? above++ : --below;
      const double dx = candidate->x - x;
      const double dy = candidate->y + shift_y - centre.y;
      if (dx * dx >= reach) break;
      const std::uint32_t other = index_[static_cast<std::size_t>(candidate - sorted_.data())];
      if (dx * dx + dy * dy >= reach || other == self) continue;
      if (clip(out, dx, dy, other)) {
        if (out.empty()) return false;
        reach = 4 * largest_squared(out);
      }
    }
    return true;
  };

  const std::int32_t rings = std::max(x_.count, y_.count);
  bool alive = visit(0, 0);
  for (std::int32_t ring = 1; alive && ring <= rings; ++ring) {
    const double away_x = std::min(left, right) + (ring - 1) * x_.bucket - slack;
    const double away_y = std::min(up, down) + (ring - 1) * y_.bucket - slack;
    const bool columns_left = ring <= x_.count && (away_x <= 0 || away_x * away_x < reach);
    const bool rows_left = ring <= y_.count && (away_y <= 0 || away_y * away_y < reach);
    if (!columns_left && !rows_left) break;
    // The four sides from their middles outwards: nearest buckets first.
    for (std::int32_t along = 0; alive && along <= ring; ++along) {
      for (const std::int32_t step : {along, -along}) {
        if (alive && rows_left && std::abs(step) <= x_.count) alive = visit(step, -ring) && visit(step, ring);
        if (alive && columns_left && along < ring && std::abs(step) <= y_.count) {
          alive = visit(-ring, step) && visit(ring, step);
        }
        if (along == 0) break;
      }
    }
  }
}

}  // namespace abn
