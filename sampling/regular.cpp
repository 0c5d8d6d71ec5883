#include "sampling/regular.h"

namespace abn {

const StrategyInfo Regular::info{
    .name = "regular",
    .family = "baseline",
    .summary = "Centres of the cells of a regular grid, aligned with the pixels where the budget allows it.",
    .cite = "thesis section 2.3; Mitchell and Netravali 1988, Reconstruction filters in computer graphics",
    .advice = "To see aliasing: all its error is structured. The seed has no effect.",
    .random = false,
};

std::optional<Regular::Layout> Regular::layout_of(Extent plane, std::uint64_t budget) {
  const std::uint64_t pixels = plane.area();
  if (budget % pixels == 0) {
    if (const auto cells = near_square_cells(budget / pixels, {1, 1})) return Layout{Domain::pixel, *cells};
  }
  if (budget >= std::uint64_t{1} << 31) return std::nullopt;  // more than one set may hold
  if (const auto cells = near_square_cells(budget, plane)) return Layout{Domain::plane, *cells};
  // A plane much longer than wide: one line of cells is then the squarest grid if its cells are still longer than wide.
  if (plane.width >= plane.height * budget) return Layout{Domain::plane, {budget, 1}};
  if (plane.height >= plane.width * budget) return Layout{Domain::plane, {1, budget}};
  return std::nullopt;
}

Regular::Layout Regular::checked_layout(const SamplingTask& task) {
  // An empty task is refused by the base class.
  if (task.plane.area() == 0 || task.budget == 0) return {Domain::plane, {}};
  if (const auto layout = layout_of(task.plane, task.budget)) return *layout;
  std::uint64_t below = task.budget - 1;  // ends at 1 at the latest: ...
  while (below > 1 && !layout_of(task.plane, below)) --below;
  std::uint64_t above = task.budget + 1;  // ... and here at the next square number of near-square cells
  while (!layout_of(task.plane, above)) ++above;
  throw ConfigError("strategy 'regular' has no grid of " + std::to_string(task.budget) + " near-square cells on " +
                    std::to_string(task.plane.width) + "x" + std::to_string(task.plane.height) +
                    " pixels; the nearest budgets are " + std::to_string(below) + " and " + std::to_string(above));
}

Regular::Regular(const SamplingTask& task, const Params&) : Regular(task, checked_layout(task)) {}

void Regular::points(std::uint64_t, std::uint64_t first, std::uint64_t, std::span<UnitPoint> out) const {
  constexpr std::uint32_t middle = 0x80000000U;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = {stratum_place((first + i) % cells_.columns, middle, cells_.columns),
              stratum_place((first + i) / cells_.columns, middle, cells_.rows)};
  }
}

}  // namespace abn
