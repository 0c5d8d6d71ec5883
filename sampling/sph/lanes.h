// The two pair loops of the CPU engine, vectorised: eight consecutive particles share one search and sit in eight
// lanes. Plain loops that the compiler vectorises, compiled for two instruction sets; equal bit for bit to each other
// and to bodies.h, because every lane adds the same terms in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampling/sph/bodies.h"

namespace abn::sph {

inline constexpr std::size_t lanes = 8;

enum class InstructionSet {
  baseline,  // what every processor of the architecture has: SSE2 on x86-64
  avx2,      // x86-64-v3
};

/// The better one of this machine.
InstructionSet best_instruction_set();

/// At most eight consecutive particles that are close together, and where they find their neighbours.
struct Block {
  std::uint32_t first = 0;  // sorted particle
  std::uint32_t count = 0;
  std::uint32_t first_run = 0, run_count = 0;
  bool fixed = false;  // all of them: no force is wanted
};

/// The blocks of a range of particles. Found once a step, used by both passes.
struct BlockRuns {
  std::vector<Block> blocks;
  std::vector<Run> runs;
};

/// The largest s of the particles in every tile and in every row of cells of a tile: plain pointers.
template <class Real>
struct LargestSizes {
  const Real* in_tile = nullptr;
  const Real* in_row = nullptr;  // from Tile::first_row on
};

/// Cuts the sorted particles [begin, end) into blocks and searches their neighbours. A particle that would stretch the
/// block's box too far begins the next one: at the end of a row of cells, mostly. `fixed` by id; null = none.
/// `largest`, if sized: what is too far away for the sizes there is left out, which changes no sum, because its terms
/// are 0. Null = nothing is left out.
template <class Real>
void find_blocks(const ParticleView<Real>& view, Terms terms, std::size_t begin, std::size_t end,
                 const std::uint8_t* fixed, const LargestSizes<Real>* largest, BlockRuns& found);

/// The passes for one combination of terms.
template <class Real>
struct LanePasses {
  /// Density sums before kernel_constant() at the blocks' particles; own [n] is written only if classed.
  void (*density)(const ParticleView<Real>& view, const BlockRuns& blocks, Real* all, Real* own);
  /// Forces of all but coincident particles at all but fixed blocks, to x[i - begin], y[i - begin].
  void (*force)(const ParticleView<Real>& view, const BlockRuns& blocks, std::size_t begin, Real* x, Real* y);
};

/// float and double. Asking for avx2 on a machine without it is a bug.
template <class Real>
LanePasses<Real> lane_passes(Terms terms, InstructionSet set);

}  // namespace abn::sph
