// Independent uniform points: the baseline every strategy is measured against.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// Independent uniform points over the whole plane: pixels get Poisson-like counts.
class Random final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {};
  static std::vector<Field<Params>> fields() { return {}; }
  Random(const SamplingTask& task, const Params&) : UnitSquareSampler(task, info.name, Domain::plane) {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
};

/// Independent uniform points inside every pixel: the same count in all pixels.
class RandomPixel final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {};
  static std::vector<Field<Params>> fields() { return {}; }
  RandomPixel(const SamplingTask& task, const Params&) : UnitSquareSampler(task, info.name, Domain::pixel) {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
};

}  // namespace abn
