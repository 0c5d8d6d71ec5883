#include "sampling/fis/fis_rejection.h"

#include "sampling/rng.h"

namespace abn {

const StrategyInfo FisRejection::info{
    .name = "fis_rejection",
    .family = "filter importance",
    .summary = "Independent points drawn from the filter by rejection, in every pixel.",
    .cite = "von Neumann 1951; Ernst, Stamminger, Greiner 2006, Filter importance sampling",
    .advice = "To see what evenness is worth; every other strategy of the family has less error.",
    .filter = true,
};

// The filters of the table that can be drawn from fall from their centre outwards.
FisRejection::FisRejection(const SamplingTask& task, const Params&)
    : FilterSampler(task, info.name), highest_(static_cast<float>(density().filter().value(0, 0))) {}

void FisRejection::offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float>) const {
  Rng rng(pixel_key(pixel), stream_id("rejection"));
  const float radius = density().radius();
  for (Vec2f& offset : out) {
    float height = 0;
    do {
      const Vec2f unit = rng.uniform2();
      offset = {(2 * unit.x - 1) * radius, (2 * unit.y - 1) * radius};
      height =
          static_cast<float>(density().filter().value(static_cast<double>(offset.x), static_cast<double>(offset.y)));
    } while (rng.uniform() * highest_ >= height);
  }
}

}  // namespace abn
