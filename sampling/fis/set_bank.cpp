#include "sampling/fis/set_bank.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "sampling/fis/set_bank_field.h"
#include "sampling/rng.h"
#include "sampling/vector_clones.h"

namespace abn {
namespace {

using detail::BankFeatures;
using detail::BankField;
using detail::BankHistogram;
using detail::BankLengths;

// Eight sets lie side by side: coordinate i of set l of a block is element i * kLanes + l.
constexpr std::size_t kLanes = 8;

std::uint32_t rounded_up(std::uint32_t sets) { return (sets + 7) / 8 * 8; }

/// What a block of sets consists of, [set_size * kLanes] each.
struct Block {
  std::vector<float> x, y, speed_x, speed_y, force_x, force_y;
  std::vector<float> weight;  // sums to 1 in every set
  BankHistogram histogram{};
};

struct Forces {
  Forces(const BankLengths& lengths, const SetBankSpec& spec)
      : softening(lengths.softening),
        inverse_support(1 / lengths.support),
        short_factor(8 * static_cast<float>(spec.short_range) * lengths.unit /
                     (lengths.short_support * lengths.short_support)),
        inverse_short_square(1 / (lengths.short_support * lengths.short_support)),
        axis_weight(static_cast<float>(spec.axis_weight)),
        axis_rounding_square(lengths.axis_rounding * lengths.axis_rounding) {}
  float softening, inverse_support, short_factor, inverse_short_square, axis_weight, axis_rounding_square;
};

/// Gradient of detail::pair_potential(), rounded off where it jumps.
template <Repulsion repulsion>
[[gnu::always_inline]] inline Vec2f repulsion_of(float dx, float dy, const Forces& f) {
  const float square = dx * dx + dy * dy;
  const float r = std::sqrt(square);
  float radial = 1 / (r + f.softening);
  if constexpr (repulsion == Repulsion::sph) {
    const float q = r * f.inverse_support;
    const float rest = q < 1 ? 1 - q : 0.0F;
    radial = rest * rest * rest * f.inverse_support * static_cast<float>(1 / detail::kGreatestSphForce);
  }
  const float near = 1 - square * f.inverse_short_square;
  const float rest = near > 0 ? near : 0.0F;
  radial += f.short_factor * rest * rest * rest;
  return {dx * (radial + f.axis_weight / std::sqrt(dx * dx + f.axis_rounding_square)),
          dy * (radial + f.axis_weight / std::sqrt(dy * dy + f.axis_rounding_square))};
}

/// force_i += sum over j of weight_j times the repulsion of i by j, inside every set of a block.
template <Repulsion repulsion>
[[gnu::always_inline]] inline void repel_pairs(const float* x, const float* y, const float* weight, std::size_t size,
                                               const Forces& f, float* force_x, float* force_y) {
  for (std::size_t i = 1; i < size; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
#pragma omp simd
      for (std::size_t l = 0; l < kLanes; ++l) {
        const std::size_t a = i * kLanes + l;
        const std::size_t b = j * kLanes + l;
        const Vec2f force = repulsion_of<repulsion>(x[a] - x[b], y[a] - y[b], f);
        force_x[a] += weight[b] * force.x;
        force_y[a] += weight[b] * force.y;
        force_x[b] -= weight[a] * force.x;
        force_y[b] -= weight[a] * force.y;
      }
    }
  }
}

/// The same between every point and all points of the other sets of its block, `turned` by so many lanes.
template <Repulsion repulsion>
[[gnu::always_inline]] inline void repel_others(const float* x, const float* y, const float* turned_x,
                                                const float* turned_y, const float* turned_weight, std::size_t size,
                                                float factor, const Forces& f, float* force_x, float* force_y) {
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
#pragma omp simd
      for (std::size_t l = 0; l < kLanes; ++l) {
        const std::size_t a = i * kLanes + l;
        const std::size_t b = j * kLanes + l;
        const Vec2f force = repulsion_of<repulsion>(x[a] - turned_x[b], y[a] - turned_y[b], f);
        force_x[a] += factor * turned_weight[b] * force.x;
        force_y[a] += factor * turned_weight[b] * force.y;
      }
    }
  }
}

ABN_VECTOR_CLONES
void repel_energy(const float* x, const float* y, const float* weight, std::size_t size, const Forces& f,
                  float* force_x, float* force_y) {
  repel_pairs<Repulsion::energy>(x, y, weight, size, f, force_x, force_y);
}

ABN_VECTOR_CLONES
void repel_sph(const float* x, const float* y, const float* weight, std::size_t size, const Forces& f, float* force_x,
               float* force_y) {
  repel_pairs<Repulsion::sph>(x, y, weight, size, f, force_x, force_y);
}

ABN_VECTOR_CLONES
void repel_others_energy(const float* x, const float* y, const float* turned_x, const float* turned_y,
                         const float* turned_weight, std::size_t size, float factor, const Forces& f, float* force_x,
                         float* force_y) {
  repel_others<Repulsion::energy>(x, y, turned_x, turned_y, turned_weight, size, factor, f, force_x, force_y);
}

ABN_VECTOR_CLONES
void repel_others_sph(const float* x, const float* y, const float* turned_x, const float* turned_y,
                      const float* turned_weight, std::size_t size, float factor, const Forces& f, float* force_x,
                      float* force_y) {
  repel_others<Repulsion::sph>(x, y, turned_x, turned_y, turned_weight, size, factor, f, force_x, force_y);
}

/// Adds the repulsion between the sets of a block: `factor` / kLanes of that inside a set, from every other set.
void repel_sets(Block& block, const SetBankSpec& spec, float factor, const Forces& forces) {
  const std::size_t points = block.x.size();
  std::vector<float> x(points);
  std::vector<float> y(points);
  std::vector<float> weight(points);
  for (std::size_t turn = 1; turn < kLanes; ++turn) {
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t from = i / kLanes * kLanes + (i + turn) % kLanes;
      x[i] = block.x[from];
      y[i] = block.y[from];
      weight[i] = block.weight[from];
    }
    const auto repel = spec.repulsion == Repulsion::energy ? repel_others_energy : repel_others_sph;
    repel(block.x.data(), block.y.data(), x.data(), y.data(), weight.data(), spec.set_size, factor / kLanes, forces,
          block.force_x.data(), block.force_y.data());
  }
}

/// Solves A x = b in place by elimination with row pivoting; b becomes x. False if A is singular.
bool solve(std::vector<double>& a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t pivot = i;
    for (std::size_t k = i + 1; k < n; ++k) {
      if (std::abs(a[k * n + i]) > std::abs(a[pivot * n + i])) pivot = k;
    }
    if (!(std::abs(a[pivot * n + i]) > 1e-12)) return false;
    if (pivot != i) {
      std::swap_ranges(a.begin() + static_cast<std::ptrdiff_t>(i * n),
                       a.begin() + static_cast<std::ptrdiff_t>((i + 1) * n),
                       a.begin() + static_cast<std::ptrdiff_t>(pivot * n));
      std::swap(b[i], b[pivot]);
    }
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = a[k * n + i] / a[i * n + i];
      for (std::size_t m = i; m < n; ++m) a[k * n + m] -= factor * a[i * n + m];
      b[k] -= factor * b[i];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t m = i + 1; m < n; ++m) b[i] -= a[i * n + m] * b[m];
    b[i] /= a[i * n + i];
  }
  return true;
}

/// Ordinary kriging of the integral under the background, with the variogram equal to the pair potential.
void weigh(Block& block, const BankField& field, const BankLengths& lengths, const SetBankSpec& spec) {
  const std::size_t size = spec.set_size;
  const std::size_t n = size + 1;
  const double nugget = 0.3 * static_cast<double>(lengths.unit);
  std::vector<double> matrix(n * n);
  std::vector<double> right(n);
  for (std::size_t l = 0; l < kLanes; ++l) {
    for (std::size_t i = 0; i < size; ++i) {
      const float x = block.x[i * kLanes + l];
      const float y = block.y[i * kLanes + l];
      for (std::size_t j = 0; j < size; ++j) {
        const double dx = std::abs(static_cast<double>(x - block.x[j * kLanes + l]));
        const double dy = std::abs(static_cast<double>(y - block.y[j * kLanes + l]));
        matrix[i * n + j] = (i == j ? nugget : 0.0) - detail::pair_potential(dx, dy, lengths, spec);
      }
      matrix[i * n + size] = matrix[size * n + i] = 1;
      right[i] = -static_cast<double>(field.potential(x, y));
    }
    matrix[n * n - 1] = 0;
    right[size] = 1;
    if (!solve(matrix, right)) continue;
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i) sum += right[i] = std::max(0.0, right[i]);
    if (!(sum > 0)) continue;
    for (std::size_t i = 0; i < size; ++i) block.weight[i * kLanes + l] = static_cast<float>(right[i] / sum);
  }
}

Block start(const FilterDensity& filter, const SetBankSpec& spec, std::uint64_t block_index) {
  const std::size_t points = std::size_t{spec.set_size} * kLanes;
  Block block;
  for (auto* values : {&block.x, &block.y, &block.speed_x, &block.speed_y, &block.force_x, &block.force_y}) {
    values->assign(points, 0.0F);
  }
  block.weight.assign(points, 1.0F / static_cast<float>(spec.set_size));
  for (std::size_t l = 0; l < kLanes; ++l) {
    Rng rng(spec.seed, stream_id("set bank"), block_index * kLanes + l);
    for (std::size_t i = 0; i < spec.set_size; ++i) {
      // Single points cannot repel each other: a lattice of rank 1 spreads them.
      const float turns = 0.61803399F * (static_cast<float>(block_index * kLanes + l) + 0.5F);
      const float share =
          (static_cast<float>(block_index * kLanes + l) + 0.5F) / static_cast<float>(rounded_up(spec.sets));
      const Vec2f unit = spec.set_size > 1 ? rng.uniform2() : Vec2f{share, turns - std::floor(turns)};
      const Vec2f p = filter.offset(unit);
      block.x[i * kLanes + l] = p.x;
      block.y[i * kLanes + l] = p.y;
    }
  }
  return block;
}

/// One step of a block: repulsion inside its sets, attraction by the background, speed with friction and a cap.
void advance(Block& block, const FilterDensity& filter, const BankField& field, const BankLengths& lengths,
             const SetBankSpec& spec, float step) {
  const std::size_t points = block.x.size();
  std::fill(block.force_x.begin(), block.force_x.end(), 0.0F);
  std::fill(block.force_y.begin(), block.force_y.end(), 0.0F);
  const Forces forces(lengths, spec);
  const auto repel = spec.repulsion == Repulsion::energy ? repel_energy : repel_sph;
  repel(block.x.data(), block.y.data(), block.weight.data(), spec.set_size, forces, block.force_x.data(),
        block.force_y.data());
  const double wanted = spec.union_weight >= 0 ? spec.union_weight : spec.set_size <= 5 ? 1 : 0;
  const auto together = static_cast<float>(wanted);
  if (together > 0) repel_sets(block, spec, together, forces);
  const float attraction = 1 + together * (static_cast<float>(kLanes) - 1) / static_cast<float>(kLanes);
  const float factor = step * static_cast<float>(spec.set_size);
  const float cap = 0.1F * lengths.unit;
  const float radius = filter.radius();
  for (std::size_t i = 0; i < points; ++i) {
    const Vec2f pull = field.gradient(block.x[i], block.y[i]);
    float vx = 0.5F * block.speed_x[i] + factor * (block.force_x[i] - attraction * pull.x);
    float vy = 0.5F * block.speed_y[i] + factor * (block.force_y[i] - attraction * pull.y);
    const float speed = std::sqrt(vx * vx + vy * vy);
    if (speed > cap) {
      vx *= cap / speed;
      vy *= cap / speed;
    }
    block.speed_x[i] = vx;
    block.speed_y[i] = vy;
    block.x[i] = std::clamp(block.x[i] + vx, -radius, radius);
    block.y[i] = std::clamp(block.y[i] + vy, -radius, radius);
    if (!filter.disc()) continue;
    const float r = std::sqrt(block.x[i] * block.x[i] + block.y[i] * block.y[i]);
    if (r > radius) {
      block.x[i] *= radius / r;
      block.y[i] *= radius / r;
    }
  }
}

void take_histogram(Block& block, const FilterDensity& filter) {
  block.histogram = {};
  for (std::size_t i = 0; i < block.x.size(); ++i) {
    const BankFeatures features(filter, block.x[i], block.y[i]);
    for (std::size_t k = 0; k < features.bin.size(); ++k) {
      block.histogram[features.bin[k]] += static_cast<double>(features.weight[k] * block.weight[i]);
    }
  }
}

}  // namespace

SetBank relax_set_bank(const FilterDensity& filter, const SetBankSpec& spec) {
  assert(spec.set_size >= 1 && spec.sets >= 1);
  const BankLengths lengths(filter);
  BankField field(filter, lengths, spec);
  const std::uint32_t sets = rounded_up(spec.sets);
  std::vector<Block> blocks(sets / kLanes);
  const auto count = static_cast<std::int64_t>(blocks.size());
  for (std::int64_t b = 0; b < count; ++b) {
    blocks[static_cast<std::size_t>(b)] = start(filter, spec, static_cast<std::uint64_t>(b));
  }
  // The stiffness of a set grows with its density of points, as sqrt(K).
  const float first_step = 0.03F * lengths.unit * std::min(1.0F, std::sqrt(10.0F / static_cast<float>(spec.set_size)));
  constexpr int warm_up = 30;
  const int iterations = spec.set_size > 1 ? spec.iterations : 0;
  for (int first = 0; first < iterations; first += 2) {  // the controller acts after every second iteration
    const int last = std::min(first + 2, iterations);
#pragma omp parallel for schedule(static)
    for (std::int64_t b = 0; b < count; ++b) {
      Block& block = blocks[static_cast<std::size_t>(b)];
      if (spec.kriging && first >= 10 && first % 4 == 0) weigh(block, field, lengths, spec);
      for (int iteration = first; iteration < last; ++iteration) {
        const float decay = 1 + 2 * static_cast<float>(iteration) / static_cast<float>(iterations);
        advance(block, filter, field, lengths, spec, first_step / decay);
      }
      if (first >= warm_up) take_histogram(block, filter);
    }
    if (first < warm_up) continue;
    BankHistogram mean{};
    for (const Block& block : blocks) {
      for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += block.histogram[k] / sets;
    }
    field.control(mean);
  }

  SetBank bank{.set_size = spec.set_size, .sets = sets, .offset = {}, .weight = {}};
  bank.offset.resize(std::size_t{sets} * spec.set_size);
  if (spec.kriging) bank.weight.resize(bank.offset.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t b = 0; b < count; ++b) {
    Block& block = blocks[static_cast<std::size_t>(b)];
    if (spec.kriging) weigh(block, field, lengths, spec);
    for (std::size_t l = 0; l < kLanes; ++l) {
      const std::size_t set = static_cast<std::size_t>(b) * kLanes + l;
      for (std::size_t i = 0; i < spec.set_size; ++i) {
        const std::size_t to = set * spec.set_size + i;
        bank.offset[to] = {block.x[i * kLanes + l], block.y[i * kLanes + l]};
        if (spec.kriging) bank.weight[to] = block.weight[i * kLanes + l] * static_cast<float>(spec.set_size);
      }
    }
  }
  return bank;
}

SetBankQuality measure(const SetBank& bank, const FilterDensity& filter) {
  // (share under the filter, weight), sorted: the greatest distance of the steps from the diagonal.
  const auto distance = [](std::vector<std::pair<float, double>> shares) {
    std::sort(shares.begin(), shares.end());
    double total = 0;
    for (const auto& s : shares) total += s.second;
    double below = 0;
    double greatest = 0;
    for (const auto& s : shares) {
      greatest = std::max(greatest, std::abs(static_cast<double>(s.first) - below / total));
      below += s.second;
      greatest = std::max(greatest, std::abs(static_cast<double>(s.first) - below / total));
    }
    return greatest;
  };
  std::vector<std::pair<float, double>> radial;
  std::vector<std::pair<float, double>> marginal;
  double squares = 0;
  double total = 0;
  for (std::size_t i = 0; i < bank.offset.size(); ++i) {
    const Vec2f p = bank.offset[i];
    const double w = bank.weight.empty() ? 1.0 : static_cast<double>(bank.weight[i]);
    const float r_squared = p.x * p.x + p.y * p.y;
    radial.emplace_back(filter.radial(std::sqrt(r_squared)), w);
    for (const float x : {p.x, p.y, -p.x, -p.y}) marginal.emplace_back(filter.marginal(x), w);
    squares += w * static_cast<double>(r_squared);
    total += w;
  }
  return {squares / total / filter.second_moment() - 1, distance(std::move(radial)), distance(std::move(marginal))};
}

// The layout: set size, sets, offsets, weights if any.
std::vector<std::byte> to_bytes(const SetBank& bank) {
  const std::size_t offsets = bank.offset.size() * sizeof(Vec2f);
  const std::size_t weights = bank.weight.size() * sizeof(float);
  std::vector<std::byte> bytes(2 * sizeof(std::uint32_t) + offsets + weights);
  std::byte* to = bytes.data();
  std::memcpy(to, &bank.set_size, sizeof(std::uint32_t));
  std::memcpy(to + sizeof(std::uint32_t), &bank.sets, sizeof(std::uint32_t));
  std::memcpy(to + 2 * sizeof(std::uint32_t), bank.offset.data(), offsets);
  if (weights > 0) std::memcpy(to + 2 * sizeof(std::uint32_t) + offsets, bank.weight.data(), weights);
  return bytes;
}

std::optional<SetBank> from_bytes(std::span<const std::byte> bytes, const SetBankSpec& spec) {
  SetBank bank{.set_size = spec.set_size, .sets = rounded_up(spec.sets), .offset = {}, .weight = {}};
  const std::size_t points = std::size_t{bank.set_size} * bank.sets;
  const std::size_t header = 2 * sizeof(std::uint32_t);
  const std::size_t weights = spec.kriging ? points * sizeof(float) : 0;
  std::array<std::uint32_t, 2> sizes{};
  if (bytes.size() != header + points * sizeof(Vec2f) + weights) return std::nullopt;
  std::memcpy(sizes.data(), bytes.data(), header);
  if (sizes[0] != bank.set_size || sizes[1] != bank.sets) return std::nullopt;
  bank.offset.resize(points);
  std::memcpy(bank.offset.data(), bytes.data() + header, points * sizeof(Vec2f));
  if (weights > 0) {
    bank.weight.resize(points);
    std::memcpy(bank.weight.data(), bytes.data() + header + points * sizeof(Vec2f), weights);
  }
  const auto finite = [](float v) { return std::isfinite(v); };
  const bool sound =
      std::all_of(bank.offset.begin(), bank.offset.end(), [&](Vec2f p) { return finite(p.x) && finite(p.y); }) &&
      std::all_of(bank.weight.begin(), bank.weight.end(), finite);
  return sound ? std::optional(std::move(bank)) : std::nullopt;
}

}  // namespace abn
