// Filter importance sampling from jittered points.
#pragma once

#include "sampling/fis/filter_sampler.h"
#include "sampling/jitter.h"
#include "sampling/strategy.h"

namespace abn {

/// Jittered points of the unit square (one in each of n cells of equal area, any n), mapped by the inverse of the
/// filter's distribution, so that every cell's image holds the same share of the filter. Every second pixel has its
/// axes exchanged, as in `jitter`.
class FisJitter final : public FilterSampler {
 public:
  static const StrategyInfo info;
  struct Params {};
  static std::vector<Field<Params>> fields() { return {}; }
  FisJitter(const SamplingTask& task, const Params&);

 private:
  void offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float> weight) const override;

  /// The points of a jittered set, by themselves.
  class Square final : public JitterBase {
   public:
    explicit Square(const SamplingTask& task) : JitterBase(task, info.name, Domain::pixel) {}
    using JitterBase::points;
  };
  Square square_;
};

}  // namespace abn
