#include "sampling/jitter.h"

#include <algorithm>
#include <cmath>

#include "sampling/factors.h"

namespace abn {

const StrategyInfo Jitter::info{
    .name = "jitter",
    .family = "stratified",
    .summary = "One uniform point in each of n cells of equal area of every pixel; works for any n.",
    .cite = "Cook, Porter, Carpenter 1984, Distributed ray tracing; Cook 1986",
    .advice = "The plain choice of renderers; multijitter and sobol_owen are better at the same cost.",
};

const StrategyInfo JitterPlane::info{
    .name = "jitter_plane",
    .family = "stratified",
    .summary = "One uniform point in each of N cells of equal area of the whole plane, blind to the pixels.",
    .cite = "Cook, Porter, Carpenter 1984, Distributed ray tracing; Cook 1986",
    .advice = "To separate the effect of stratification from that of equal counts per pixel.",
};

std::uint64_t jitter_rows(std::uint64_t n, Extent area) {
  if (const auto cells = near_square_cells(n, area)) return cells->rows;
  const double rows = std::round(std::sqrt(static_cast<double>(n) * area.height / area.width));
  return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(rows), 1, n);
}

JitterBase::JitterBase(const SamplingTask& task, const std::string& name, Domain domain)
    : UnitSquareSampler(task, name, domain) {
  const Extent area = domain == Domain::plane ? task.plane : Extent{1, 1};
  if (smaller_set() > 0) rows_[0] = jitter_rows(smaller_set(), area);
  rows_[1] = jitter_rows(smaller_set() + 1, area);
}

// A row has floor(n / rows) cells or one more, and the strata of both numbers are unions of those of their product.
Strata JitterBase::strata(std::uint64_t n) const {
  const std::uint64_t rows = rows_[n - smaller_set()];
  const std::uint64_t cells = n / rows;
  return {n % rows == 0 ? cells : cells * (cells + 1), n};
}

// Cells are numbered along the rows. Row r holds the cells from floor(r n / rows) on, so their numbers differ by at
// most one, and reaches from y = (its first cell) / n to the next row's, so every cell has area 1 / n.
void JitterBase::points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const {
  const std::uint64_t rows = rows_[n - smaller_set()];
  std::uint64_t row = ((first + 1) * rows - 1) / n;
  std::uint64_t begin = row * n / rows;
  std::uint64_t end = (row + 1) * n / rows;
  random_points(key, first, out);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::uint64_t i = first + k;
    if (i == end) {
      ++row;
      begin = end;
      end = (row + 1) * n / rows;
    }
    const UnitPoint offset = out[k];
    const std::uint64_t height = end - begin;
    // Offset y as (stratum of 1 / n inside the row, offset in it), so that the place respects the row's border.
    const std::uint64_t y = height * offset.y;
    out[k] = {stratum_place(i - begin, offset.x, height),
              stratum_place(begin + (y >> 32), static_cast<std::uint32_t>(y), n)};
  }
}

}  // namespace abn
