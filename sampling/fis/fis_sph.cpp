#include "sampling/fis/fis_sph.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "sampling/disk_cache.h"
#include "sampling/error.h"
#include "sampling/permutation.h"
#include "sampling/rng.h"

namespace abn {
namespace {

constexpr std::size_t kLargestSet = 256;
constexpr std::size_t kLargestWeightedSet = 64;
constexpr Extent kTile{32, 16};  // [px]

/// One of the eight symmetries of the square.
Vec2f mirrored(Vec2f p, std::uint32_t symmetry) {
  if ((symmetry & 1U) != 0) p.x = -p.x;
  if ((symmetry & 2U) != 0) p.y = -p.y;
  return (symmetry & 4U) != 0 ? Vec2f{p.y, p.x} : p;
}

}  // namespace

const StrategyInfo FisSph::info{
    .name = "fis_sph",
    .family = "filter importance",
    .summary = "Small sets relaxed under the pixel filter by SPH with a density controller, one at random per pixel.",
    .cite = "Russell 2017, thesis 4.2; Jiang et al. 2015; Szekely, Rizzo 2013 (energy distance)",
    .advice =
        "The best of the family from about six samples per pixel on; its error is independent from pixel to pixel.",
    .filter = true,
};

std::vector<Field<FisSph::Params>> FisSph::fields() {
  return {
      {"kernel",
       &Params::kernel,
       "repulsion inside a set: of the energy distance, or the SPH force",
       0,
       0,
       {"energy", "sph"}},
      {"weights",
       &Params::weights,
       "of the samples: all equal, or by kriging in the relaxation",
       0,
       0,
       {"equal", "kriging"}},
      {"symmetry",
       &Params::symmetry,
       "of a pixel's set: one of eight, any rotation (filters on a disc), none",
       0,
       0,
       {"dihedral", "rotation", "none"}},
      {"assignment",
       &Params::assignment,
       "random: any set for any pixel; tiles: no set twice in a tile of 32x16 pixels, as far as there are sets",
       0,
       0,
       {"random", "tiles"}},
      {"sets", &Params::sets, "sets in the bank, at most; fewer of more than 16 samples", 8, 65536, {}},
      {"iterations", &Params::iterations, "steps of the relaxation", 0, 100000, {}},
      {"axis_weight",
       &Params::axis_weight,
       "share of |dx| + |dy| in the repulsion, for edges along the axes",
       0,
       0.05,
       {}},
      {"short_range", &Params::short_range, "weight of the repulsion inside .62 rms radii, for fine detail", 0, 1, {}},
      {"bank", &Params::bank, "seed of the bank; that of the task only assigns its sets", 0, 1e9, {}},
  };
}

FisSph::FisSph(const SamplingTask& task, const Params& params) : FilterSampler(task, info.name), params_(params) {
  if (params.symmetry == "rotation" && !density().disc()) {
    throw ConfigError(info.name + ": symmetry=rotation would turn samples out of the square of filter '" +
                      density().filter().words() + "'; take symmetry=dihedral or the filter gaussian:support=disc");
  }
}

SetBankSpec FisSph::spec_of(std::size_t set_size) const {
  SetBankSpec spec;
  spec.set_size = static_cast<std::uint32_t>(set_size);
  // 8192 points suffice for the controller; at least 32 sets with 8 symmetries keep neighbours from looking alike.
  const std::size_t enough = std::max<std::size_t>(32, 8192 / set_size);
  spec.sets = static_cast<std::uint32_t>(std::min(enough, static_cast<std::size_t>(params_.sets)));
  spec.iterations = params_.iterations;
  spec.repulsion = params_.kernel == "sph" ? Repulsion::sph : Repulsion::energy;
  spec.axis_weight = params_.axis_weight;
  spec.short_range = params_.short_range;
  spec.kriging = weighted();
  spec.seed = static_cast<std::uint64_t>(params_.bank);
  return spec;
}

void FisSph::add_bank(std::size_t set_size) {
  if (set_size == 0 || banks_.contains(set_size)) return;
  const SetBankSpec spec = spec_of(set_size);
  const std::string key = "set bank 1 " + density().filter().words() + " size=" + std::to_string(spec.set_size) +
                          " sets=" + std::to_string(spec.sets) + " iterations=" + std::to_string(spec.iterations) +
                          " kernel=" + params_.kernel + " weights=" + params_.weights +
                          " axis_weight=" + std::to_string(spec.axis_weight) +
                          " short_range=" + std::to_string(spec.short_range) + " seed=" + std::to_string(spec.seed);
  if (task().cache) {
    if (const auto bytes = load_cached(key)) {
      if (auto bank = from_bytes(*bytes, spec)) {
        banks_.emplace(set_size, std::move(*bank));
        cached_ = true;
        return;
      }
    }
  }
  SetBank bank = relax_set_bank(density(), spec);
  if (task().cache) store_cached(key, to_bytes(bank));
  banks_.emplace(set_size, std::move(bank));
}

/// A pixel of n samples takes this many sets, whose sizes differ by at most one.
std::size_t FisSph::sets_of(std::size_t n) const {
  const std::size_t largest = weighted() ? kLargestWeightedSet : kLargestSet;
  return (n + largest - 1) / largest;
}

void FisSph::prepare() {
  const auto start = std::chrono::steady_clock::now();
  for (const std::size_t n : {smaller_set(), smaller_set() + (two_sizes() ? 1 : 0)}) {
    if (n == 0) continue;
    const std::size_t sets = sets_of(n);
    add_bank(n / sets);
    if (n % sets != 0) add_bank(n / sets + 1);
  }
  bank_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// In a tile every set comes once before any comes twice: a permutation of the tile's pixels, keyed by the tile.
std::uint32_t FisSph::set_in_tile(std::uint32_t pixel, std::uint32_t sets) const {
  const std::uint32_t width = task().plane.width;
  const std::uint32_t x = pixel % width;
  const std::uint32_t y = pixel / width;
  const std::uint64_t tile = std::uint64_t{y / kTile.height} << 32 | x / kTile.width;
  const auto cells = static_cast<std::uint32_t>(kTile.area());
  const Permutation order(std::max(cells, sets), mix64(task().seed ^ mix64(tile ^ stream_id("tile of sets"))));
  return order(y % kTile.height * kTile.width + x % kTile.width) % sets;
}

void FisSph::offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float> weight) const {
  Rng rng(pixel_key(pixel), stream_id("set"));
  const std::size_t sets = sets_of(out.size());
  std::size_t at = 0;
  for (std::size_t s = 0; s < sets; ++s) {
    const std::size_t size = out.size() / sets + (s < out.size() % sets ? 1 : 0);
    const SetBank& bank = banks_.at(size);
    const bool tiled = params_.assignment == "tiles" && s == 0;
    const std::size_t first = std::size_t{tiled ? set_in_tile(pixel, bank.sets) : rng.below(bank.sets)} * size;
    const std::uint32_t symmetry = params_.symmetry == "none" ? 0 : rng.below(8);
    float cosine = 1;
    float sine = 0;
    if (params_.symmetry == "rotation") {
      const float angle = 2 * std::numbers::pi_v<float> * rng.uniform();
      cosine = std::cos(angle);
      sine = std::sin(angle);
    }
    for (std::size_t i = 0; i < size; ++i) {
      const Vec2f p = mirrored(bank.offset[first + i], symmetry);
      out[at + i] = {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y};
      if (!weight.empty()) weight[at + i] = bank.weight[first + i];
    }
    at += size;
  }
}

std::vector<Diagnostic> FisSph::diagnostics() const {
  auto list = FilterSampler::diagnostics();
  if (list.empty()) return list;
  for (const auto& [size, bank] : banks_) {
    const SetBankQuality quality = measure(bank, density());
    const std::string name = "bank_" + std::to_string(size);
    list.push_back({name + "_second_moment_error", quality.second_moment_error});
    list.push_back({name + "_ks", quality.radial_ks});
  }
  list.push_back({"bank_s", bank_s_});
  return list;
}

}  // namespace abn
