#include "sampling/fis/fis_jitter.h"

#include <utility>
#include <vector>

namespace abn {

const StrategyInfo FisJitter::info{
    .name = "fis_jitter",
    .family = "filter importance",
    .summary = "Jittered points mapped by the inverse of the filter's distribution, in every pixel.",
    .cite = "Ernst, Stamminger, Greiner 2006, Filter importance sampling; Cook 1986",
    .advice = "The plain choice of renderers that draw samples from the filter; fis_sph has less error.",
    .filter = true,
};

FisJitter::FisJitter(const SamplingTask& task, const Params&) : FilterSampler(task, info.name), square_(task) {}

void FisJitter::offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float>) const {
  const std::uint32_t width = task().plane.width;
  const bool exchanged = (pixel % width + pixel / width) % 2 == 1;
  std::vector<UnitPoint> points(out.size());
  square_.points(pixel_key(pixel), 0, out.size(), points);
  for (std::size_t i = 0; i < out.size(); ++i) {
    UnitPoint p = points[i];
    if (exchanged) std::swap(p.x, p.y);
    out[i] = density().offset({unit_float(p.x), unit_float(p.y)});
  }
}

}  // namespace abn
