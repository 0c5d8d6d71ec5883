#include "sampling/fis/fis_metropolis.h"

#include <cmath>

#include "sampling/rng.h"

namespace abn {

const StrategyInfo FisMetropolis::info{
    .name = "fis_metropolis",
    .family = "filter importance",
    .summary = "The states of a Metropolis chain over the filter, one chain per pixel; they are correlated.",
    .cite = "Metropolis et al. 1953; Ernst, Stamminger, Greiner 2006, Filter importance sampling",
    .advice = "Only for filters known by their values alone; correlation costs more error than fis_rejection.",
    .filter = true,
};

std::vector<Field<FisMetropolis::Params>> FisMetropolis::fields() {
  return {
      {"burn_in", &Params::burn_in, "states dropped before the first sample", 0, 1e6, {}},
      {"step", &Params::step, "half the side of the square of proposals [filter radii]", 0.01, 2, {}},
      {"thinning", &Params::thinning, "states from one sample to the next", 1, 1000, {}},
  };
}

FisMetropolis::FisMetropolis(const SamplingTask& task, const Params& params)
    : FilterSampler(task, info.name), params_(params) {}

void FisMetropolis::offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float>) const {
  Rng rng(pixel_key(pixel), stream_id("metropolis"));
  const float radius = density().radius();
  const float reach = static_cast<float>(params_.step) * radius;
  const PixelFilter& filter = density().filter();
  const auto height_at = [&](Vec2f p) {
    return static_cast<float>(filter.value(static_cast<double>(p.x), static_cast<double>(p.y)));
  };
  const auto around = [&](Vec2f centre, float distance) {
    const Vec2f unit = rng.uniform2();
    return Vec2f{centre.x + (2 * unit.x - 1) * distance, centre.y + (2 * unit.y - 1) * distance};
  };
  Vec2f at;
  float height = 0;
  while (!(height > 0)) {
    at = around({}, radius);
    height = height_at(at);
  }
  const auto advance = [&] {
    const Vec2f to = around(at, reach);
    const float height_there = height_at(to);
    if (rng.uniform() * height < height_there) {
      at = to;
      height = height_there;
    }
  };
  for (int i = 0; i < params_.burn_in; ++i) advance();
  for (Vec2f& offset : out) {
    for (int i = 0; i < params_.thinning; ++i) advance();
    offset = at;
  }
}

std::vector<Diagnostic> FisMetropolis::diagnostics() const {
  auto list = FilterSampler::diagnostics();
  if (!list.empty()) {
    list.push_back({"correlated", 1, "neighbouring samples of a pixel are states of one chain, not independent"});
  }
  return list;
}

}  // namespace abn
