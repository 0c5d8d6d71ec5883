#include "sampling/pmj02.h"

#include <array>
#include <utility>

#include "sampling/hash.h"
#include "sampling/sobol2d.h"

namespace abn {
namespace {

// Solves for the m lowest bits of u, bit m being 1: parity(equation[r] & u) = value bit r for m equations.
constexpr std::uint32_t solve(std::array<std::uint32_t, 32> equation, std::uint32_t values, unsigned m) {
  std::array<std::uint32_t, 32> value{};
  for (unsigned r = 0; r < m; ++r) value[r] = ((values >> r) ^ (equation[r] >> m)) & 1U;
  for (unsigned column = 0; column < m; ++column) {  // Gauss-Jordan; the (0,2) property makes the matrix regular
    unsigned pivot = column;
    while (((equation[pivot] >> column) & 1U) == 0) ++pivot;
    std::swap(equation[pivot], equation[column]);
    std::swap(value[pivot], value[column]);
    for (unsigned r = 0; r < m; ++r) {
      if (r != column && ((equation[r] >> column) & 1U) != 0) {
        equation[r] ^= equation[column];
        value[r] ^= value[column];
      }
    }
  }
  std::uint32_t u = std::uint32_t{1} << m;
  for (unsigned r = 0; r < m; ++r) u |= value[r] << r;
  return u;
}

// Column m of the matrix U for which Sobol point U i takes the place i of the progressive order: with k = m / 2, adding
// it must leave the first k binary digits of x and of y as they are (the new point stays in the old one's cell) and,
// for odd m, flip digit k of x only (for even m both flip then, by the net property).
constexpr std::array<std::uint32_t, 32> pmj_order_matrix() {
  std::array<std::uint32_t, 32> matrix{};
  for (unsigned m = 0; m < 32; ++m) {
    const unsigned k = m / 2;
    std::array<std::uint32_t, 32> equation{};
    std::uint32_t values = 0;
    unsigned r = 0;
    for (unsigned digit = 0; digit < k; ++digit) {
      equation[r++] = std::uint32_t{1} << digit;  // digit of x
      for (unsigned j = 0; j < 32; ++j) {         // digit of y: row of Pascal's triangle mod 2
        if ((j & digit) == digit) equation[r] |= std::uint32_t{1} << j;
      }
      ++r;
    }
    if (m % 2 == 1) {
      values |= std::uint32_t{1} << r;
      equation[r++] = std::uint32_t{1} << k;
    }
    matrix[m] = solve(equation, values, m);
  }
  return matrix;
}

// U times a vector by bytes.
constexpr auto kOrder = [] {
  constexpr std::array<std::uint32_t, 32> matrix = pmj_order_matrix();
  std::array<std::array<std::uint32_t, 256>, 4> table{};
  for (unsigned byte = 0; byte < 4; ++byte) {
    for (unsigned value = 0; value < 256; ++value) {
      for (unsigned bit = 0; bit < 8; ++bit) {
        if (((value >> bit) & 1U) != 0) table[byte][value] ^= matrix[8 * byte + bit];
      }
    }
  }
  return table;
}();

constexpr std::uint32_t sobol_index(std::uint32_t i) {
  return kOrder[0][i & 255U] ^ kOrder[1][(i >> 8) & 255U] ^ kOrder[2][(i >> 16) & 255U] ^ kOrder[3][i >> 24];
}

// Exchanges the last two subquadrants of a cell at every level by the coin of that cell, which is named by the point
// of the coarser level that lies in it.
constexpr std::uint32_t with_random_order(std::uint32_t i, std::uint64_t key) {
  std::uint32_t exchanged = i;
  for (unsigned bit = 0; bit < 32 && (i >> bit) >= 2; bit += 2) {
    if (((i >> bit) & 2U) == 0) continue;
    const std::uint64_t cell = (std::uint64_t{bit} << 32) | (i & ((std::uint32_t{1} << bit) - 1));
    exchanged ^= static_cast<std::uint32_t>(mix64(key ^ cell) & 1U) << bit;
  }
  return exchanged;
}

}  // namespace

const StrategyInfo Pmj02::info{
    .name = "pmj02",
    .family = "low discrepancy",
    .summary = "Progressive multi-jittered (0,2) points; made by scrambling a linear sequence in progressive order.",
    .cite = "Christensen, Kensler, Kilpatrick 2018, Progressive multi-jittered sample sequences; hash: Vegdahl 2021",
    .advice = "When a set is used before it is complete: good at powers of two and fair between them.",
};

void Pmj02::points(std::uint64_t key, std::uint64_t first, std::uint64_t, std::span<UnitPoint> out) const {
  const auto seed_x = static_cast<std::uint32_t>(key);
  const auto seed_y = static_cast<std::uint32_t>(key >> 32);
  const std::uint64_t coins = mix64(key);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::uint32_t i = sobol_index(with_random_order(static_cast<std::uint32_t>(first + k), coins));
    out[k] = {reverse_bits(owen_hash(i, seed_x)), reverse_bits(owen_hash(pascal_bits(i), seed_y))};
  }
}

}  // namespace abn
