#include "sampling/sph/cells.h"

namespace abn::sph {

void CellSort::sort(std::span<std::uint32_t> cell, std::size_t cells, int parts,
                    std::vector<std::uint32_t>& cell_start) {
  const auto n = static_cast<std::uint64_t>(cell.size());
  const auto part_count = static_cast<std::uint64_t>(parts);
  const auto begin_of = [&](int part) {
    return static_cast<std::size_t>(n * static_cast<std::uint64_t>(part) / part_count);
  };
  count_.assign(cells * part_count, 0);
  cell_start.resize(cells + 1);
#pragma omp parallel for schedule(static, 1) num_threads(parts)
  for (int part = 0; part < parts; ++part) {
    std::uint32_t* count = count_.data() + static_cast<std::size_t>(part) * cells;
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) ++count[cell[i]];
  }
  // A particle's place: all earlier cells, then the same cell in earlier parts, then its rank in its own part.
  std::uint32_t sum = 0;
  for (std::size_t c = 0; c < cells; ++c) {
    cell_start[c] = sum;
    for (std::size_t part = 0; part < part_count; ++part) {
      const std::uint32_t here = count_[part * cells + c];
      count_[part * cells + c] = sum;
      sum += here;
    }
  }
  cell_start[cells] = sum;
#pragma omp parallel for schedule(static, 1) num_threads(parts)
  for (int part = 0; part < parts; ++part) {
    std::uint32_t* next = count_.data() + static_cast<std::size_t>(part) * cells;
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) cell[i] = next[cell[i]]++;
  }
}

}  // namespace abn::sph
