// Multi-jittered sampling with independent shuffles, in two dimensions a randomised orthogonal array of strength 2.
#pragma once

#include <array>

#include "sampling/factors.h"
#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// n = columns * rows points (the most square factorisation, 6 = 2 x 3 in one pixel, 3 x 2 in its neighbours): one in
/// every cell of that grid, and at once one in each of n columns and one in each of n rows. Every column of cells
/// shuffles its x strata, every row its y strata, independently (cmj uses one shuffle for all, which costs half an
/// order of convergence). A prime n leaves one column of cells: a Latin hypercube.
class MultiJitter final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "pixel";
  };
  static std::vector<Field<Params>> fields() { return {domain_field<Params>()}; }
  MultiJitter(const SamplingTask& task, const Params& parameters);

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
  Strata strata(std::uint64_t n) const override { return {n, n}; }
  bool alternates_axes() const override { return true; }

 private:
  std::array<CellCounts, 2> cells_{};  // of the smaller sets and of those with one point more
};

}  // namespace abn
