// The aligned grid: no randomness at all.
#pragma once

#include "sampling/factors.h"
#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// Centres of a grid of cells whose sides differ by at most a factor of 2.
///
/// If the budget is a multiple of the pixels and the multiple has such a grid (6 = 2 columns by 3 rows), the grid is
/// aligned with the pixels; else the grid spans the plane, and pixels may differ in their counts. The constructor
/// throws ConfigError with the nearest possible budgets if there is no grid of exactly that many cells.
class Regular final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {};
  static std::vector<Field<Params>> fields() { return {}; }
  Regular(const SamplingTask& task, const Params&);

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;

 private:
  struct Layout {
    Domain domain;
    CellCounts cells;
  };
  static std::optional<Layout> layout_of(Extent plane, std::uint64_t budget);
  static Layout checked_layout(const SamplingTask& task);
  Regular(const SamplingTask& task, const Layout& layout)
      : UnitSquareSampler(task, info.name, layout.domain), cells_(layout.cells) {}

  CellCounts cells_;
};

}  // namespace abn
