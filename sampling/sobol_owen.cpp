#include "sampling/sobol_owen.h"

#include "sampling/sobol2d.h"
#include "sampling/vector_clones.h"

namespace abn {

const StrategyInfo SobolOwen::info{
    .name = "sobol_owen",
    .family = "low discrepancy",
    .summary = "The first two Sobol dimensions, Owen-scrambled by a hash with a new seed for every set.",
    .cite = "Sobol 1967; Owen 1995; hash: Laine and Karras 2011, Burley 2020, Vegdahl 2021",
    .advice = "The default for quality and speed: variance falls like n^-3 on smooth and n^-1.5 at edges.",
};

// The multiplications of 32-bit words are what baseline x86-64 lacks in vectors.
ABN_VECTOR_CLONES
void sobol_owen_points(std::uint32_t first, std::uint32_t seed_x, std::uint32_t seed_y, std::span<UnitPoint> out) {
  UnitPoint* const point = out.data();
  const auto size = static_cast<std::uint32_t>(out.size());
#pragma omp simd
  for (std::uint32_t k = 0; k < size; ++k) {
    const std::uint32_t i = first + k;
    point[k].x = reverse_bits(owen_hash(i, seed_x));
    point[k].y = reverse_bits(owen_hash(pascal_bits(i), seed_y));
  }
}

void SobolOwen::points(std::uint64_t key, std::uint64_t first, std::uint64_t, std::span<UnitPoint> out) const {
  sobol_owen_points(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(key),
                    static_cast<std::uint32_t>(key >> 32), out);
}

}  // namespace abn
