#include "sampling/sph/lanes.h"

#include <cassert>
#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define ABN_AVX2 [[gnu::target("arch=x86-64-v3"), gnu::flatten]]
#define ABN_BASELINE [[gnu::flatten]]
#else
#define ABN_AVX2
#define ABN_BASELINE
#endif

namespace abn::sph {
namespace {

/// One value in each lane.
template <class Real>
struct alignas(lanes * sizeof(Real)) Pack {
  Real lane[lanes];
};

/// What eight particles bring into a pair loop.
template <class Real>
struct LaneValues {
  Pack<Real> x{}, y{}, size{}, label{}, pressure{}, class_pressure{};
};

template <Terms terms, class Real>
inline void load(const ParticleView<Real>& view, std::size_t i, bool pressures, LaneValues<Real>& own) {
  for (std::size_t k = 0; k < lanes; ++k) {
    own.x.lane[k] = view.x[i + k];
    own.y.lane[k] = view.y[i + k];
    if constexpr (terms.sized) own.size.lane[k] = view.size[i + k];
    if constexpr (terms.classed) own.label.lane[k] = view.label[i + k];
    if (pressures) own.pressure.lane[k] = view.pressure[i + k];
    if (pressures && terms.classed) own.class_pressure.lane[k] = view.class_pressure[i + k];
  }
}

template <Terms terms, class Real>
inline void density_pass(const ParticleView<Real>& view, const BlockRuns& found, Real* all, Real* own) {
  const Real inverse_support = Real(1) / view.support;
  const Real inverse_class_support = Real(1) / view.class_support;
  LaneValues<Real> self;
  for (const Block& block : found.blocks) {
    load<terms>(view, block.first, false, self);
    Pack<Real> sum_all{};
    Pack<Real> sum_own{};
    for (std::uint32_t r = 0; r < block.run_count; ++r) {
      const Run run = found.runs[block.first_run + r];
      const Real shift_x = static_cast<Real>(run.image_x) * view.cells.length_x;
      const Real shift_y = static_cast<Real>(run.image_y) * view.cells.length_y;
      Pack<Real> x, y;
      for (std::size_t k = 0; k < lanes; ++k) {
        x.lane[k] = self.x.lane[k] - shift_x;
        y.lane[k] = self.y.lane[k] - shift_y;
      }
      for (std::uint32_t j = run.begin; j < run.end; ++j) {
        const Real xj = view.x[j];
        const Real yj = view.y[j];
        const Real size_j = terms.sized ? view.size[j] : Real(1);
        const Real label_j = terms.classed ? view.label[j] : Real(0);
#pragma omp simd
        for (std::size_t k = 0; k < lanes; ++k) {
          DensitySum<Real> sum{sum_all.lane[k], sum_own.lane[k]};
          add_density<terms>(sum, x.lane[k] - xj, y.lane[k] - yj, inverse_support, inverse_class_support,
                             self.size.lane[k], size_j, self.label.lane[k], label_j);
          sum_all.lane[k] = sum.all;
          if constexpr (terms.classed) sum_own.lane[k] = sum.own;
        }
      }
    }
    for (std::size_t k = 0; k < block.count; ++k) {
      all[block.first + k] = sum_all.lane[k];
      if constexpr (terms.classed) own[block.first + k] = sum_own.lane[k];
    }
  }
}

template <Terms terms, class Real>
inline void force_pass(const ParticleView<Real>& view, const BlockRuns& found, std::size_t begin, Real* force_x,
                       Real* force_y) {
  const Real inverse_support = Real(1) / view.support;
  const Real inverse_class_support = Real(1) / view.class_support;
  LaneValues<Real> self;
  for (const Block& block : found.blocks) {
    if (block.fixed) continue;
    load<terms>(view, block.first, true, self);
    Pack<Real> sum_x{};
    Pack<Real> sum_y{};
    for (std::uint32_t r = 0; r < block.run_count; ++r) {
      const Run run = found.runs[block.first_run + r];
      const Real shift_x = static_cast<Real>(run.image_x) * view.cells.length_x;
      const Real shift_y = static_cast<Real>(run.image_y) * view.cells.length_y;
      Pack<Real> x, y;
      for (std::size_t k = 0; k < lanes; ++k) {
        x.lane[k] = self.x.lane[k] - shift_x;
        y.lane[k] = self.y.lane[k] - shift_y;
      }
      for (std::uint32_t j = run.begin; j < run.end; ++j) {
        const Real xj = view.x[j];
        const Real yj = view.y[j];
        const Real size_j = terms.sized ? view.size[j] : Real(1);
        const Real label_j = terms.classed ? view.label[j] : Real(0);
        const Real pressure_j = view.pressure[j];
        const Real class_pressure_j = terms.classed ? view.class_pressure[j] : Real(0);
#pragma omp simd
        for (std::size_t k = 0; k < lanes; ++k) {
          const Real dx = x.lane[k] - xj;
          const Real dy = y.lane[k] - yj;
          const Real weight = force_weight<terms>(
              dx * dx + dy * dy, inverse_support, inverse_class_support, self.size.lane[k], size_j, self.label.lane[k],
              label_j, self.pressure.lane[k], pressure_j, self.class_pressure.lane[k], class_pressure_j);
          sum_x.lane[k] += weight * dx;
          sum_y.lane[k] += weight * dy;
        }
      }
    }
    for (std::size_t k = 0; k < block.count; ++k) {
      force_x[block.first + k - begin] = sum_x.lane[k];
      force_y[block.first + k - begin] = sum_y.lane[k];
    }
  }
}

template <Terms terms, class Real>
ABN_BASELINE void density_baseline(const ParticleView<Real>& view, const BlockRuns& blocks, Real* all, Real* own) {
  density_pass<terms>(view, blocks, all, own);
}
template <Terms terms, class Real>
ABN_BASELINE void force_baseline(const ParticleView<Real>& view, const BlockRuns& blocks, std::size_t begin, Real* x,
                                 Real* y) {
  force_pass<terms>(view, blocks, begin, x, y);
}
template <Terms terms, class Real>
ABN_AVX2 void density_avx2(const ParticleView<Real>& view, const BlockRuns& blocks, Real* all, Real* own) {
  density_pass<terms>(view, blocks, all, own);
}
template <Terms terms, class Real>
ABN_AVX2 void force_avx2(const ParticleView<Real>& view, const BlockRuns& blocks, std::size_t begin, Real* x, Real* y) {
  force_pass<terms>(view, blocks, begin, x, y);
}

template <Terms terms, class Real>
LanePasses<Real> passes(InstructionSet set) {
  if (set == InstructionSet::avx2) return {density_avx2<terms, Real>, force_avx2<terms, Real>};
  return {density_baseline<terms, Real>, force_baseline<terms, Real>};
}

template <class Real>
struct Box {
  Real x0, x1, y0, y1;  // [d]
};

/// The runs of cells in which a particle may interact with one in the box, whose sizes are at most `size`: what
/// for_each_run() gives for the box and the radius, less rows and cells at their ends that are too far away for the
/// sizes in them.
template <class Real>
void find_near_runs(const ParticleView<Real>& view, Real support, const Box<Real>& box, Real size, Real radius,
                    const LargestSizes<Real>& largest, std::vector<Run>& runs) {
  const CellView<Real>& grid = view.cells;
  const Real rounding = grid.rounding(radius);
  const Real half_support = Real(0.5) * support;
  const auto gap = [rounding](Real first, Real last, Real from, Real to) {
    const Real before = first - to - rounding;
    const Real after = from - last - rounding;
    const Real outside = before > after ? before : after;
    return outside > Real(0) ? outside : Real(0);
  };
  for_each_tile(
      grid, box.x0 - radius, box.x1 + radius, box.y0 - radius, box.y1 + radius,
      [&](std::size_t index, std::int16_t image_x, std::int16_t image_y) {
        const Tile<Real>& tile = grid.tiles[index];
        const Real shift_x = static_cast<Real>(image_x) * grid.length_x;
        const Real shift_y = static_cast<Real>(image_y) * grid.length_y;
        const Real y = tile.y + shift_y;
        const Real in_tile = half_support * (size + largest.in_tile[index]) + rounding;
        const Real height = tile.height;
        if (gap(box.y0, box.y1, y, y + static_cast<Real>(tile.rows) * height) > in_tile) return;
        const std::int32_t last_row = grid.row_in(tile, box.y1 + in_tile - shift_y);
        for (std::int32_t row = grid.row_in(tile, box.y0 - in_tile - shift_y); row <= last_row; ++row) {
          const Real in_row = half_support * (size + largest.in_row[tile.first_row + static_cast<std::uint32_t>(row)]);
          const Real gap_y =
              gap(box.y0, box.y1, y + static_cast<Real>(row) * height, y + static_cast<Real>(row + 1) * height);
          const Real rest = in_row * in_row - gap_y * gap_y;
          if (!(rest > Real(0))) continue;
          const Real half_width = std::sqrt(rest) + rounding;
          const std::int32_t column0 = grid.column_in(tile, box.x0 - half_width - shift_x);
          const std::int32_t column1 = grid.column_in(tile, box.x1 + half_width - shift_x);
          const std::uint32_t* start = view.cell_start + tile.first + static_cast<std::uint32_t>(row * tile.columns);
          if (start[column0] < start[column1 + 1])
            runs.push_back({start[column0], start[column1 + 1], image_x, image_y});
        }
      });
}

}  // namespace

template <class Real>
void find_blocks(const ParticleView<Real>& view, Terms terms, std::size_t begin, std::size_t end,
                 const std::uint8_t* fixed, const LargestSizes<Real>* largest, BlockRuns& found) {
  found.blocks.clear();
  found.runs.clear();
  for (std::size_t i = begin; i < end;) {
    Real x0 = view.x[i];
    Real x1 = x0;
    Real y0 = view.y[i];
    Real y1 = y0;
    Real size = terms.sized ? view.size[i] : Real(1);
    Real reach = terms.sized ? view.reach[i] : Real(1);
    const Real longest = Real(4) * view.support * size;
    std::size_t count = 1;
    for (; count < lanes && i + count < end; ++count) {
      const Real x = view.x[i + count];
      const Real y = view.y[i + count];
      const Real left = x < x0 ? x : x0;
      const Real right = x > x1 ? x : x1;
      const Real top = y < y0 ? y : y0;
      const Real bottom = y > y1 ? y : y1;
      if (right - left + (bottom - top) > longest) break;
      x0 = left;
      x1 = right;
      y0 = top;
      y1 = bottom;
      if (terms.sized) {
        size = view.size[i + count] > size ? view.size[i + count] : size;
        reach = view.reach[i + count] > reach ? view.reach[i + count] : reach;
      }
    }
    const Real radius = search_radius(view, terms, size, reach);
    Block block{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(count),
                static_cast<std::uint32_t>(found.runs.size()), 0, fixed != nullptr};
    if (terms.sized && largest != nullptr) {
      find_near_runs(view, terms.classed ? view.class_support : view.support, {x0, x1, y0, y1}, size, radius, *largest,
                     found.runs);
    } else {
      for_each_run(view.cells, view.cell_start, x0 - radius, x1 + radius, y0 - radius, y1 + radius,
                   [&](const Run& run) { found.runs.push_back(run); });
    }
    block.run_count = static_cast<std::uint32_t>(found.runs.size()) - block.first_run;
    for (std::size_t k = 0; k < count && block.fixed; ++k) block.fixed = fixed[view.id[i + k]] != 0;
    found.blocks.push_back(block);
    i += count;
  }
}

template void find_blocks(const ParticleView<float>&, Terms, std::size_t, std::size_t, const std::uint8_t*,
                          const LargestSizes<float>*, BlockRuns&);
template void find_blocks(const ParticleView<double>&, Terms, std::size_t, std::size_t, const std::uint8_t*,
                          const LargestSizes<double>*, BlockRuns&);

InstructionSet best_instruction_set() {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  return __builtin_cpu_supports("x86-64-v3") ? InstructionSet::avx2 : InstructionSet::baseline;
#else
  return InstructionSet::baseline;
#endif
}

template <class Real>
LanePasses<Real> lane_passes(Terms terms, InstructionSet set) {
  assert(set == InstructionSet::baseline || best_instruction_set() == InstructionSet::avx2);
  return with_terms(terms, [set]<Terms with>() { return passes<with, Real>(set); });
}

template LanePasses<float> lane_passes(Terms, InstructionSet);
template LanePasses<double> lane_passes(Terms, InstructionSet);

}  // namespace abn::sph
