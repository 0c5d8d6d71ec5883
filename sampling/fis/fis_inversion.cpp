#include "sampling/fis/fis_inversion.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "sampling/cmj.h"
#include "sampling/error.h"
#include "sampling/multijitter.h"
#include "sampling/rng.h"
#include "sampling/sobol_owen.h"
#include "sampling/sph_blue_noise.h"
#include "sampling/unit_square_sampler.h"

namespace abn {
namespace {

constexpr std::size_t kTori = 256;

/// All points of a set that strategy S makes for a single pixel.
template <class S>
void copy_set(std::uint64_t key, std::span<Vec2f> out) {
  S sampler(SamplingTask{.plane = {1, 1}, .budget = out.size(), .seed = key}, {});
  const Grid<PixelStats> none;
  std::size_t at = 0;
  for (SampleBatch batch = sampler.next({none}); !batch.empty(); batch = sampler.next({none})) {
    std::copy(batch.position.begin(), batch.position.end(), out.begin() + static_cast<std::ptrdiff_t>(at));
    at += batch.position.size();
  }
}

/// x + shift on the unit torus.
float shifted(float x, float shift) {
  const float sum = x + shift;
  return std::min(sum < 1 ? sum : sum - 1, just_below(1));
}

}  // namespace

const StrategyInfo FisInversion::info{
    .name = "fis_inversion",
    .family = "filter importance",
    .summary =
        "Even points of the square (blue noise, Sobol, multi-jitter) mapped by the inverse of the filter's "
        "distribution, in every pixel.",
    .cite = "Ernst, Stamminger, Greiner 2006, Filter importance sampling; Box, Muller 1958; thesis 4.2",
    .advice = "With set=sobol_owen good where edges follow the axes; elsewhere fis_sph has less error.",
    .filter = true,
};

std::vector<Field<FisInversion::Params>> FisInversion::fields() {
  return {
      {"set",
       &Params::set,
       "points of the unit square",
       0,
       0,
       {"blue_noise", "sobol_owen", "cmj", "multijitter", "random"}},
      {"method",
       &Params::method,
       "separable: along each axis; box_muller: radius and angle, for filters on a disc; auto: what the filter is",
       0,
       0,
       {"auto", "separable", "box_muller"}},
  };
}

FisInversion::FisInversion(const SamplingTask& task, const Params& params)
    : FilterSampler(task, info.name), params_(params) {
  const bool disc = density().disc();
  if (params.method == "box_muller" && !disc) {
    throw ConfigError(info.name + ": method=box_muller draws from a disc, but filter '" + density().filter().words() +
                      "' covers a square; take method=separable or the filter gaussian:support=disc");
  }
  if (params.method == "separable" && disc) {
    throw ConfigError(info.name + ": method=separable draws from a square, but filter '" + density().filter().words() +
                      "' covers a disc; take method=box_muller or a filter on the square");
  }
}

void FisInversion::prepare() {
  if (params_.set != "blue_noise") return;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t size = std::max<std::size_t>(smaller_set(), 1); size <= smaller_set() + (two_sizes() ? 1 : 0);
       ++size) {
    const std::size_t count = std::clamp<std::size_t>(65536 / size, 1, kTori);
    auto& tori = tori_[size];
    tori.resize(count * size);
    // A large set uses all threads by itself, small ones lie side by side.
#pragma omp parallel for schedule(static) if (size <= 1024)
    for (std::size_t k = 0; k < count; ++k) {
      copy_set<SphBlueNoise>(Rng(k, stream_id("blue-noise tori")).next(), std::span(tori).subspan(k * size, size));
    }
  }
  bank_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void FisInversion::unit_points(std::uint64_t key, std::span<Vec2f> out) const {
  Rng rng(key, stream_id("inversion"));
  if (params_.set == "blue_noise") {
    const std::vector<Vec2f>& tori = tori_.at(out.size());
    const std::size_t set = rng.below(static_cast<std::uint32_t>(tori.size() / out.size()));
    const Vec2f shift = rng.uniform2();
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec2f p = tori[set * out.size() + i];
      out[i] = {shifted(p.x, shift.x), shifted(p.y, shift.y)};
    }
  } else if (params_.set == "sobol_owen") {
    std::vector<UnitPoint> points(out.size());
    const std::uint32_t seed_x = rng.next();
    sobol_owen_points(0, seed_x, rng.next(), points);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {unit_float(points[i].x), unit_float(points[i].y)};
  } else if (params_.set == "cmj") {
    copy_set<Cmj>(key, out);
  } else if (params_.set == "multijitter") {
    copy_set<MultiJitter>(key, out);
  } else {
    for (Vec2f& p : out) p = rng.uniform2();
  }
}

void FisInversion::offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float>) const {
  unit_points(pixel_key(pixel), out);
  // Sets of a x b strata would prefer an orientation.
  const std::uint32_t width = task().plane.width;
  const bool exchanged = (pixel % width + pixel / width) % 2 == 1;
  for (Vec2f& p : out) {
    const Vec2f offset = density().offset(p);
    p = exchanged ? Vec2f{offset.y, offset.x} : offset;
  }
}

std::vector<Diagnostic> FisInversion::diagnostics() const {
  auto list = FilterSampler::diagnostics();
  if (!list.empty() && params_.set == "blue_noise") list.push_back({"bank_s", bank_s_});
  return list;
}

}  // namespace abn
