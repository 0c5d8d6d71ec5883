#include "sampling/adaptive/nearest_samples.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "sampling/vector_clones.h"

namespace abn {
namespace {

constexpr int lanes = NearestSamples::lanes;

/// Samples that may be near eight places.
struct Run {
  const float* x;
  const float* y;
  const std::uint32_t* index;
  std::uint32_t count;
};

/// The box around the eight places, and the squared distance from it beyond which nobody looks.
struct Near {
  float left, right, top, bottom, limit;
};

// Explicit vectors of 16 bytes, which every processor has: what the compiler makes of a loop over all lanes stores 16
// bytes and loads 32, which stalls.
using Two __attribute__((vector_size(16))) = double;

inline Two load(const double* from) {
  Two two;
  std::memcpy(&two, from, sizeof two);
  return two;
}

/// Leaves the smaller of every pair in `held` and the larger in `carry`.
inline void sort_pair(double* held, Two& carry) {
  const Two before = load(held);
  const Two least = before < carry ? before : carry;
  carry = before < carry ? carry : before;
  std::memcpy(held, &least, sizeof least);
}

/// Offers samples to eight places; `candidate` [wanted * lanes] stays sorted in every lane. `most` is `wanted` where
/// the compiler shall know it, or 0.
template <int most>
[[gnu::always_inline]] inline void offer(const Run& run, const Near& near, const float* place_x, const float* place_y,
                                         std::uint32_t normal, int wanted, double* candidate) {
  const int stages = most > 0 ? most : wanted;
  for (std::uint32_t i = 0; i < run.count; ++i) {
    const float x = run.x[i];
    const float y = run.y[i];
    const float out_x = std::max(std::max(near.left - x, x - near.right), 0.0F);
    const float out_y = std::max(std::max(near.top - y, y - near.bottom), 0.0F);
    if (out_x * out_x + out_y * out_y > near.limit) continue;
    const std::uint64_t index = run.index[i];
    alignas(64) double carry[lanes];
#pragma omp simd
    for (int lane = 0; lane < lanes; ++lane) {
      const float dx = x - place_x[lane];
      const float dy = y - place_y[lane];
      carry[lane] =
          std::bit_cast<double>(std::uint64_t{std::bit_cast<std::uint32_t>(dx * dx + dy * dy) + normal} << 32 | index);
    }
    Two c0 = load(carry);
    Two c1 = load(carry + 2);
    Two c2 = load(carry + 4);
    Two c3 = load(carry + 6);
    for (int k = 0; k < stages; ++k) {
      double* held = candidate + static_cast<std::ptrdiff_t>(k) * lanes;
      sort_pair(held, c0);
      sort_pair(held + 2, c1);
      sort_pair(held + 4, c2);
      sort_pair(held + 6, c3);
    }
  }
}

ABN_VECTOR_CLONES
void insert(const Run& run, const Near& near, const float* place_x, const float* place_y, std::uint32_t normal,
            int wanted, double* candidate) {
  if (wanted == 10) {
    offer<10>(run, near, place_x, place_y, normal, wanted, candidate);
  } else if (wanted == 8) {
    offer<8>(run, near, place_x, place_y, normal, wanted, candidate);
  } else {
    offer<0>(run, near, place_x, place_y, normal, wanted, candidate);
  }
}

std::int32_t fit(double cells) { return static_cast<std::int32_t>(std::max(1.0, std::ceil(cells))); }

}  // namespace

NearestSamples::NearestSamples(std::span<const Vec2f> position, Extent plane, double per_cell) {
  assert(plane.area() > 0 && per_cell > 0 && position.size() < 0xFFFFFFFFU);
  const double width = plane.width;
  const double height = plane.height;
  const double cells = std::clamp(static_cast<double>(position.size()) / per_cell, 1.0, 0x1p28);
  const double side = std::sqrt(width * height / cells);
  columns_ = fit(std::min(width / side, cells));
  rows_ = fit(std::min(height / side, cells));
  per_width_ = static_cast<float>(columns_ / width);
  per_height_ = static_cast<float>(rows_ / height);
  rounding_ = 8 * std::numeric_limits<float>::epsilon() * static_cast<float>(std::max(width, height));
  spacing_ = static_cast<float>(side * std::sqrt(1 / per_cell));
  sort(position);
}

std::int32_t NearestSamples::bounded(float cell, std::int32_t cells) {
  return static_cast<std::int32_t>(std::clamp(cell, 0.0F, static_cast<float>(cells - 1)));
}

std::vector<std::uint32_t> NearestSamples::row_begins() const {
  std::vector<std::uint32_t> begins;
  for (std::size_t c = 0; c < begin_.size(); c += static_cast<std::size_t>(columns_)) begins.push_back(begin_[c]);
  return begins;
}

double NearestSamples::crowd() const {
  if (index_.empty()) return 0;
  double sum = 0;
  for (std::size_t c = 0; c + 1 < begin_.size(); ++c) {
    const double n = begin_[c + 1] - begin_[c];
    sum += n * n;
  }
  return sum / static_cast<double>(index_.size());
}

// Stable: the samples of a cell keep their order.
void NearestSamples::sort(std::span<const Vec2f> position) {
  begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  std::vector<std::uint32_t> cell_of(position.size());
  for (std::size_t i = 0; i < position.size(); ++i) {
    assert(std::isfinite(position[i].x) && std::isfinite(position[i].y));
    cell_of[i] = static_cast<std::uint32_t>(cell(row_of(position[i].y), column_of(position[i].x)));
    ++begin_[cell_of[i]];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& b : begin_) b = sum += b;
  x_.resize(position.size());
  y_.resize(position.size());
  index_.resize(position.size());
  for (std::size_t i = position.size(); i-- > 0;) {
    const std::uint32_t at = --begin_[cell_of[i]];
    x_[at] = position[i].x;
    y_[at] = position[i].y;
    index_[at] = static_cast<std::uint32_t>(i);
  }
}

NearestSamples::Block NearestSamples::around(const Places& places, float radius) const {
  return {column_of(places.left - radius), column_of(places.right + radius), row_of(places.top - radius),
          row_of(places.bottom + radius)};
}

bool NearestSamples::whole(const Block& block) const {
  return block.left == 0 && block.top == 0 && block.right == columns_ - 1 && block.bottom == rows_ - 1;
}

void NearestSamples::scan(const Block& block, const Block& seen, const Places& places, int wanted,
                          Search& search) const {
  Near near{places.left, places.right, places.top, places.bottom, std::numeric_limits<float>::infinity()};
  const auto look = [&](std::int32_t row, std::int32_t first, std::int32_t last) {
    if (first > last) return;
    const std::uint32_t begin = begin_[cell(row, first)];
    const Run run{x_.data() + begin, y_.data() + begin, index_.data() + begin, begin_[cell(row, last) + 1] - begin};
    if (run.count == 0) return;
    near.limit = search.farthest(wanted) * (1 + 0x1p-20F);
    insert(run, near, search.x.data(), search.y.data(), Search::normal, wanted, search.candidate_.data());
  };
  const auto look_at_row = [&](std::int32_t row) {
    if (row < block.top || row > block.bottom) return;
    if (row < seen.top || row > seen.bottom) {
      look(row, block.left, block.right);
    } else {
      look(row, block.left, seen.left - 1);
      look(row, seen.right + 1, block.right);
    }
  };
  look_at_row(places.row);
  const std::int32_t farthest = std::max(places.row - block.top, block.bottom - places.row);
  for (std::int32_t away = 1; away <= farthest; ++away) {
    look_at_row(places.row - away);
    look_at_row(places.row + away);
  }
}

void NearestSamples::find(int wanted, Search& search) const {
  assert(wanted >= 1 && wanted <= most_neighbours);
  search.count_ = static_cast<int>(std::min(static_cast<std::size_t>(wanted), index_.size()));
  if (search.count_ == 0) return;
  wanted = search.count_;
  std::fill_n(search.candidate_.begin(), wanted * lanes, Search::nothing);
  Places places{
      *std::min_element(search.x.begin(), search.x.end()), *std::max_element(search.x.begin(), search.x.end()),
      *std::min_element(search.y.begin(), search.y.end()), *std::max_element(search.y.begin(), search.y.end()), 0};
  places.row = row_of(0.5F * (places.top + places.bottom));

  // The radius that was enough for the last places, which usually lie beside these; more until every place has found
  // enough samples; then all that may be nearer than the last of them.
  float radius = search.radius_ > 0 ? search.radius_ : spacing_;
  Block seen{0, -1, 0, -1};
  for (;;) {
    const Block block = around(places, radius);
    scan(block, seen, places, wanted, search);
    seen = block;
    const float farthest = std::sqrt(search.farthest(wanted));
    if (farthest < std::numeric_limits<float>::infinity()) {
      const float needed = farthest * (1 + 0x1p-20F) + rounding_;
      search.radius_ = needed;
      if (needed <= radius) return;
      radius = needed;
    } else {
      radius *= 2;
    }
    if (whole(block)) return;
  }
}

}  // namespace abn
