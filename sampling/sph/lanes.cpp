#include "sampling/sph/lanes.h"

#include <cassert>

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

}  // namespace

template <class Real>
void find_blocks(const ParticleView<Real>& view, Terms terms, std::size_t begin, std::size_t end,
                 const std::uint8_t* fixed, BlockRuns& found) {
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
    for_each_run(view.cells, view.cell_start, x0 - radius, x1 + radius, y0 - radius, y1 + radius,
                 [&](const Run& run) { found.runs.push_back(run); });
    block.run_count = static_cast<std::uint32_t>(found.runs.size()) - block.first_run;
    for (std::size_t k = 0; k < count && block.fixed; ++k) block.fixed = fixed[view.id[i + k]] != 0;
    found.blocks.push_back(block);
    i += count;
  }
}

template void find_blocks(const ParticleView<float>&, Terms, std::size_t, std::size_t, const std::uint8_t*, BlockRuns&);
template void find_blocks(const ParticleView<double>&, Terms, std::size_t, std::size_t, const std::uint8_t*,
                          BlockRuns&);

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
