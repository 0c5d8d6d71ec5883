#include "sampling/adaptive/rank_order.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "sampling/rng.h"
#include "sampling/torus_cells.h"
#include "sampling/vector_clones.h"

namespace abn {
namespace {

// How many points ahead their distances are called for.
constexpr std::size_t prefetched = 16;

// Fewer points than this per cell cost empty cells, more cost distances.
constexpr float points_per_cell = 2;

/// Points in the order of cells, with the squared distance of each to the nearest point chosen so far [px^2].
struct Points {
  std::vector<float> x, y, squared;
  float width = 0, height = 0;  // of the torus [px]
};

/// Lowers the distances of points [begin, end) to that from (x, y).
ABN_VECTOR_CLONES
void lower(Points& points, std::uint32_t begin, std::uint32_t end, float x, float y) {
  const float* px = points.x.data();
  const float* py = points.y.data();
  float* squared = points.squared.data();
  const float width = points.width;
  const float height = points.height;
#pragma omp simd
  for (std::uint32_t i = begin; i < end; ++i) {
    const float direct_x = std::abs(px[i] - x);
    const float direct_y = std::abs(py[i] - y);
    const float dx = std::min(direct_x, width - direct_x);
    const float dy = std::min(direct_y, height - direct_y);
    squared[i] = std::min(squared[i], dx * dx + dy * dy);
  }
}

/// The cells of one axis within a reach, at most each once: [first, first + count), to be taken modulo `cells`.
struct Range {
  std::int32_t first, count;
};
Range range_of(double at, double reach, double per_length, std::int32_t cells) {
  // Around the torus once, so that truncation rounds down; a little wider, against rounding.
  const double first = (at - reach) * per_length - 1e-3 + cells;
  const double last = (at + reach) * per_length + 1e-3 + cells;
  if (!(last - first + 1 < cells)) return {0, cells};
  const auto begin = static_cast<std::int32_t>(first);
  const std::int32_t count = static_cast<std::int32_t>(last) - begin + 1;
  return {begin < cells ? begin : begin - cells, count};
}

/// Classes of squared distances, 32 per octave: a float's leading bits.
std::uint32_t class_of(float squared) { return std::bit_cast<std::uint32_t>(squared) >> 18; }
constexpr std::uint32_t classes = (0x7F800000U >> 18) + 1;
/// A bound of the squared distances of a class; infinite for the last one.
float above(std::uint32_t c) { return std::bit_cast<float>(std::min((c + 1) << 18, 0x7F800000U)); }

}  // namespace

std::vector<std::uint32_t> farthest_first_order(std::span<const Vec2f> position, Extent plane, std::uint64_t seed) {
  const std::size_t n = position.size();
  assert(plane.area() > 0 && n < 0xFFFFFFFFU);
  std::vector<std::uint32_t> order;
  if (n == 0) return order;
  order.reserve(n);

  Points points;
  points.width = static_cast<float>(plane.width);
  points.height = static_cast<float>(plane.height);
  const float side =
      std::sqrt(points_per_cell * static_cast<float>(static_cast<double>(plane.area()) / static_cast<double>(n)));
  TorusCells cells(points.width, points.height, side, side, n);
  std::vector<std::uint32_t> index(n);
  {
    std::vector<float> x(n);
    std::vector<float> y(n);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = position[i].x;
      y[i] = position[i].y;
    }
    std::vector<std::uint32_t> place(n);
    cells.sort(x, y, place);
    points.x.resize(n);
    points.y.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      index[place[i]] = static_cast<std::uint32_t>(i);
      points.x[place[i]] = x[i];
      points.y[place[i]] = y[i];
    }
    points.squared.assign(n, std::numeric_limits<float>::infinity());
  }
  const auto columns = static_cast<std::int32_t>(cells.columns());
  const auto rows = static_cast<std::int32_t>(cells.size() / cells.columns());
  const double columns_per_length = static_cast<double>(columns) / plane.width;
  const double rows_per_length = static_cast<double>(rows) / plane.height;

  // Every point not yet taken is in one of them; where its distance has shrunk, in one too high.
  std::vector<std::vector<std::uint32_t>> waiting(classes);
  {
    std::vector<std::uint32_t>& first = waiting.back();
    first.resize(n);
    std::iota(first.begin(), first.end(), 0U);
    Rng rng(seed, stream_id("farthest_first_order"));
    for (std::size_t i = n; i > 1; --i) std::swap(first[i - 1], first[rng.below(static_cast<std::uint32_t>(i))]);
  }
  const auto begin = cells.begin();
  for (std::uint32_t c = classes; c-- > 0;) {
    const float reach = std::sqrt(above(c));
    std::vector<std::uint32_t>& members = waiting[c];
    while (!members.empty()) {
      const std::uint32_t point = members.back();
      members.pop_back();
      if (members.size() >= prefetched) __builtin_prefetch(&points.squared[members[members.size() - prefetched]]);
      if (const std::uint32_t now = class_of(points.squared[point]); now < c) {
        waiting[now].push_back(point);
        continue;
      }
      order.push_back(index[point]);
      const float x = points.x[point];
      const float y = points.y[point];
      const Range across = range_of(double{x}, double{reach}, columns_per_length, columns);
      const Range down = range_of(double{y}, double{reach}, rows_per_length, rows);
      const std::int32_t before_edge = std::min(across.count, columns - across.first);
      for (std::int32_t k = 0; k < down.count; ++k) {
        const std::int32_t row = down.first + k < rows ? down.first + k : down.first + k - rows;
        const std::size_t left = static_cast<std::size_t>(row) * cells.columns();
        const std::size_t from = left + static_cast<std::size_t>(across.first);
        lower(points, begin[from], begin[from + static_cast<std::size_t>(before_edge)], x, y);
        if (before_edge == across.count) continue;
        lower(points, begin[left], begin[left + static_cast<std::size_t>(across.count - before_edge)], x, y);
      }
    }
  }
  return order;
}

}  // namespace abn
