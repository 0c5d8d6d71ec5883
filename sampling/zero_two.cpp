#include "sampling/zero_two.h"

#include "sampling/sobol2d.h"
#include "sampling/vector_clones.h"

namespace abn {

const StrategyInfo ZeroTwo::info{
    .name = "zero_two",
    .family = "low discrepancy",
    .summary = "The (0,2)-sequence of van der Corput and Sobol with random digit (xor) scrambling.",
    .cite = "Kollig and Keller 2002, Efficient multidimensional sampling; Friedel and Keller 2002",
    .advice = "The cheapest randomised net; sobol_owen has far less error on smooth integrands.",
};

namespace {

ABN_VECTOR_CLONES
void scrambled_points(std::uint32_t first, std::uint32_t scramble_x, std::uint32_t scramble_y, std::uint32_t size,
                      UnitPoint* out) {
#pragma omp simd
  for (std::uint32_t k = 0; k < size; ++k) {
    out[k].x = reverse_bits(first + k) ^ scramble_x;
    out[k].y = reverse_bits(pascal_bits(first + k)) ^ scramble_y;
  }
}

}  // namespace

void ZeroTwo::points(std::uint64_t key, std::uint64_t first, std::uint64_t, std::span<UnitPoint> out) const {
  scrambled_points(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(key),
                   static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(out.size()), out.data());
}

}  // namespace abn
