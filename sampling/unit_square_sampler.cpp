#include "sampling/unit_square_sampler.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <utility>

#include "sampling/permutation.h"
#include "sampling/strategy.h"
#include "sampling/vector_clones.h"

namespace abn {
namespace {

constexpr std::uint64_t kBatch = std::uint64_t{1} << 20;  // most samples of a batch
constexpr std::uint64_t kBlock = 4096;                    // points made at once by one thread: they stay in its cache
constexpr std::uint64_t kMaxSet = std::uint64_t{1} << 31;

constexpr std::uint32_t kOffsets = stream_id("offset");

// out = origin + scale * in, rounded down to float: to nearest could move a point into the next stratum or pixel.
ABN_VECTOR_CLONES
void place(const UnitPoint* in, std::size_t size, double origin_x, double origin_y, double scale_x, double scale_y,
           Vec2f* out) {
  const auto round_down = [](double v) {
    const auto nearest = static_cast<float>(v);
    const auto bits = std::bit_cast<std::uint32_t>(nearest);
    return std::bit_cast<float>(bits - (static_cast<double>(nearest) > v ? 1U : 0U));  // v >= 0
  };
#pragma omp simd
  for (std::size_t i = 0; i < size; ++i) {
    out[i].x = round_down(origin_x + scale_x * in[i].x);
    out[i].y = round_down(origin_y + scale_y * in[i].y);
  }
}

// Moves coordinates that rounding down took below their stratum up by one float, if that is still inside.
// `axis` points to the x or the y of the first point; `size` is the extent of the set along the axis.
ABN_VECTOR_CLONES
void keep_strata(const std::uint32_t* in, std::size_t count, std::uint64_t strata, double origin, double size,
                 float* axis) {
  const auto n = static_cast<double>(strata);
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<double>(static_cast<std::uint32_t>((in[2 * i] * strata) >> 32));
    const float down = axis[2 * i];
    const float up = std::bit_cast<float>(std::bit_cast<std::uint32_t>(down) + 1U);
    const bool lost = static_cast<double>(down) < origin + size * k / n;
    axis[2 * i] = lost && static_cast<double>(up) < origin + size * (k + 1) / n ? up : down;
  }
}

Philox4 offset_block(std::uint64_t key, std::uint64_t block) {
  return philox4x32({{static_cast<std::uint32_t>(block), static_cast<std::uint32_t>(block >> 32), kOffsets, 0}},
                    static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32));
}

// philox4x32 of kLanes blocks in a row, side by side: 2 * kLanes points.
constexpr std::size_t kLanes = 8;
ABN_VECTOR_CLONES
void offset_blocks(std::uint64_t key, std::uint64_t block, UnitPoint* out) {
  std::uint32_t c0[kLanes], c1[kLanes], c2[kLanes], c3[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    c0[l] = static_cast<std::uint32_t>(block + l);
    c1[l] = static_cast<std::uint32_t>((block + l) >> 32);
    c2[l] = kOffsets;
    c3[l] = 0;
  }
  auto key0 = static_cast<std::uint32_t>(key);
  auto key1 = static_cast<std::uint32_t>(key >> 32);
  for (int round = 0; round < 10; ++round) {
#pragma omp simd
    for (std::size_t l = 0; l < kLanes; ++l) {
      const std::uint64_t p0 = std::uint64_t{0xD2511F53U} * c0[l];
      const std::uint64_t p1 = std::uint64_t{0xCD9E8D57U} * c2[l];
      c0[l] = static_cast<std::uint32_t>(p1 >> 32) ^ c1[l] ^ key0;
      c1[l] = static_cast<std::uint32_t>(p1);
      c2[l] = static_cast<std::uint32_t>(p0 >> 32) ^ c3[l] ^ key1;
      c3[l] = static_cast<std::uint32_t>(p0);
    }
    key0 += 0x9E3779B9U;
    key1 += 0xBB67AE85U;
  }
  for (std::size_t l = 0; l < kLanes; ++l) {
    out[2 * l] = {c0[l], c1[l]};
    out[2 * l + 1] = {c2[l], c3[l]};
  }
}

}  // namespace

void random_points(std::uint64_t key, std::uint64_t first, std::span<UnitPoint> out) {
  std::size_t k = 0;
  while (k < out.size()) {
    const std::uint64_t i = first + k;
    if (i % 2 == 0 && out.size() - k >= 2 * kLanes) {
      offset_blocks(key, i / 2, &out[k]);
      k += 2 * kLanes;
      continue;
    }
    const Philox4 block = offset_block(key, i / 2);
    if (i % 2 == 0) out[k++] = {block.word[0], block.word[1]};
    if (k < out.size()) out[k++] = {block.word[2], block.word[3]};
  }
}

UnitSquareSampler::UnitSquareSampler(const SamplingTask& task, const std::string& name, Domain domain)
    : plane_(task.plane),
      budget_(task.budget),
      seed_(task.seed),
      stream_(stream_id(name.c_str())),
      domain_(domain),
      sets_(domain == Domain::plane ? 1 : std::max<std::uint64_t>(1, task.plane.area())),
      per_set_(task.budget / sets_),
      remainder_(task.budget % sets_) {
  require_task(name, task);
  if (per_set_ >= kMaxSet || sets_ >= kMaxSet) {
    throw ConfigError("strategy '" + name + "' makes at most " + std::to_string(kMaxSet - 1) +
                      " points per set and as many sets; budget " + std::to_string(budget_) + " on " +
                      std::to_string(plane_.width) + "x" + std::to_string(plane_.height) +
                      " pixels is more; lower the budget");
  }
}

std::uint64_t UnitSquareSampler::set_size(std::uint64_t set) const {
  if (remainder_ == 0) return per_set_;
  const Permutation order(static_cast<std::uint32_t>(sets_), mix64(seed_ ^ stream_id("one sample more")));
  return per_set_ + (order(static_cast<std::uint32_t>(set)) < remainder_ ? 1 : 0);
}

void UnitSquareSampler::emit(std::uint64_t set, std::uint64_t first, std::uint64_t n, std::span<Vec2f> out) const {
  Rng rng(seed_, stream_, set);
  const std::uint64_t high = rng.next();
  const std::uint64_t key = high << 32 | rng.next();
  const bool whole = domain_ == Domain::plane;
  const std::uint64_t column = set % plane_.width;
  const std::uint64_t row = set / plane_.width;
  const double origin_x = whole ? 0 : static_cast<double>(column);
  const double origin_y = whole ? 0 : static_cast<double>(row);
  const double size_x = whole ? plane_.width : 1U;
  const double size_y = whole ? plane_.height : 1U;
  Strata kept = strata(n);
  const bool exchanged = !whole && (column + row) % 2 == 1 && alternates_axes();
  if (exchanged) std::swap(kept.x, kept.y);

  std::array<UnitPoint, kBlock> block;
  for (std::uint64_t start = 0; start < out.size(); start += kBlock) {
    const std::size_t size = std::min<std::uint64_t>(kBlock, out.size() - start);
    points(key, first + start, n, std::span(block.data(), size));
    if (exchanged) {
      for (auto& point : std::span(block.data(), size)) std::swap(point.x, point.y);
    }
    place(block.data(), size, origin_x, origin_y, 0x1p-32 * size_x, 0x1p-32 * size_y, &out[start]);
    if (kept.x > 0) keep_strata(&block[0].x, size, kept.x, origin_x, size_x, &out[start].x);
    if (kept.y > 0) keep_strata(&block[0].y, size, kept.y, origin_y, size_y, &out[start].y);
  }
}

// A batch from inside one large set.
void UnitSquareSampler::emit_part_of_set() {
  const std::uint64_t n = set_size(set_);
  const std::uint64_t size = std::min(kBatch, n - first_);
  positions_.resize(size);
  const auto blocks = static_cast<std::int64_t>((size + kBlock - 1) / kBlock);
#pragma omp parallel for schedule(static) if (blocks > 1)
  for (std::int64_t b = 0; b < blocks; ++b) {
    const std::uint64_t start = static_cast<std::uint64_t>(b) * kBlock;
    emit(set_, first_ + start, n, std::span(positions_).subspan(start, std::min(kBlock, size - start)));
  }
  first_ += size;
  if (first_ == n) {
    ++set_;
    first_ = 0;
  }
}

// A batch of several small sets.
void UnitSquareSampler::emit_whole_sets() {
  const std::uint64_t sets = std::min(sets_ - set_, kBatch / (per_set_ + 1));
  const auto count = static_cast<std::int64_t>(sets);
  const bool worth_threads = sets > 1 && sets * (per_set_ + 1) > kBlock;
  starts_.resize(sets + 1);
  starts_[0] = 0;
#pragma omp parallel for schedule(static) if (worth_threads)
  for (std::int64_t s = 0; s < count; ++s) {
    starts_[static_cast<std::size_t>(s) + 1] =
        static_cast<std::uint32_t>(set_size(set_ + static_cast<std::uint64_t>(s)));
  }
  for (std::size_t s = 0; s < sets; ++s) starts_[s + 1] += starts_[s];
  positions_.resize(starts_[sets]);
#pragma omp parallel for schedule(static) if (worth_threads)
  for (std::int64_t s = 0; s < count; ++s) {
    const auto i = static_cast<std::size_t>(s);
    const std::uint32_t n = starts_[i + 1] - starts_[i];
    if (n > 0) emit(set_ + i, 0, n, std::span(positions_).subspan(starts_[i], n));
  }
  set_ += sets;
}

SampleBatch UnitSquareSampler::next(const Feedback&) {
  positions_.clear();
  while (positions_.empty() && emitted_ < budget_) {  // with a budget below the pixels, a run of sets can be empty
    if (per_set_ + 1 > kBatch || domain_ == Domain::plane) {
      emit_part_of_set();
    } else {
      emit_whole_sets();
    }
    emitted_ += positions_.size();
  }
  assert(emitted_ <= budget_);
  return {positions_};
}

}  // namespace abn
