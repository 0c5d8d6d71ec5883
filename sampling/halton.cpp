#include "sampling/halton.h"

#include <array>

#include "sampling/hash.h"
#include "sampling/sobol2d.h"

namespace abn {
namespace {

constexpr unsigned kMaxDigits = 20;  // 3^20 is the largest power of 3 below 2^32 and more than the points of a set

constexpr std::array<std::uint64_t, kMaxDigits + 1> kPowerOf3 = [] {
  std::array<std::uint64_t, kMaxDigits + 1> power{1};
  for (unsigned k = 1; k <= kMaxDigits; ++k) power[k] = 3 * power[k - 1];
  return power;
}();

// The six permutations of {0, 1, 2}: all are affine, (a d + b) mod 3 with a = 1, 2 and b = 0, 1, 2.
constexpr std::uint8_t kPermutation3[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};

constexpr unsigned one_of_six(std::uint64_t hash) { return static_cast<unsigned>(((hash >> 32) * 6) >> 32); }

std::uint32_t inverse3(std::uint32_t i) {
  std::uint64_t digits = 0;
  for (unsigned k = 0; k < kMaxDigits; ++k, i /= 3) digits = 3 * digits + i % 3;
  return stratum_place(digits, 0, kPowerOf3[kMaxDigits]);
}

std::uint32_t inverse3_digit_scrambled(std::uint32_t i, const std::array<unsigned, kMaxDigits>& permutation) {
  std::uint64_t digits = 0;
  for (unsigned k = 0; k < kMaxDigits; ++k, i /= 3) digits = 3 * digits + kPermutation3[permutation[k]][i % 3];
  return stratum_place(digits, 0, kPowerOf3[kMaxDigits]);
}

// Digits in base 3 that tell n points apart.
unsigned digits_of(std::uint64_t n) {
  unsigned count = 0;
  while (kPowerOf3[count] < n) ++count;
  return count;
}

// The hash runs along the digits read so far, so each digit's permutation is that of its node in the ternary tree.
// After `count` digits every index of the set has a node of its own: from there on the digits are just random.
std::uint32_t inverse3_owen_scrambled(std::uint32_t i, unsigned count, std::uint64_t key, std::uint32_t random) {
  std::uint64_t digits = 0;
  std::uint64_t node = key;
  for (unsigned k = 0; k < count; ++k, i /= 3) {
    const std::uint32_t digit = i % 3;
    digits = 3 * digits + kPermutation3[one_of_six(node)][digit];
    node = (node ^ (digit + 1)) * 0xD1342543DE82EF95U;
    node ^= node >> 32;
  }
  return stratum_place(digits, random, kPowerOf3[count]);
}

}  // namespace

const StrategyInfo Halton::info{
    .name = "halton",
    .family = "low discrepancy",
    .summary = "The Halton sequence in bases 2 and 3, by default with nested uniform (Owen) scrambling.",
    .cite = "Halton 1960; scrambling: Owen 1995, Matousek 1998; hash in base 2: Vegdahl 2021",
    .advice = "A sequence without powers of two in its strata; sobol_owen is faster and converges faster.",
};

std::vector<Field<Halton::Params>> Halton::fields() {
  Field<Params> scramble{"scramble", &Params::scramble, "owen (nested), digit (one permutation per digit) or none"};
  scramble.choices = {"owen", "digit", "none"};
  return {domain_field<Params>(), scramble};
}

Halton::Halton(const SamplingTask& task, const Params& parameters)
    : UnitSquareSampler(task, info.name, domain_of(parameters.domain)),
      scramble_(parameters.scramble == "owen"    ? Scramble::owen
                : parameters.scramble == "digit" ? Scramble::digit
                                                 : Scramble::none) {}

// The finest elementary intervals that n points fill; the coarser ones are unions of them.
Strata Halton::strata(std::uint64_t n) const { return {0, kPowerOf3[digits_of(n)]}; }

void Halton::points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const {
  const auto start = static_cast<std::uint32_t>(first);
  const auto size = static_cast<std::uint32_t>(out.size());
  const auto seed2 = static_cast<std::uint32_t>(mix64(key ^ 2));
  const std::uint64_t seed3 = mix64(key ^ 3);
  switch (scramble_) {
    case Scramble::owen: {
      const unsigned count = digits_of(n);
      for (std::uint32_t k = 0; k < size; ++k) {
        const std::uint32_t i = start + k;
        out[k] = {reverse_bits(owen_hash(i, seed2)),
                  inverse3_owen_scrambled(i, count, seed3, static_cast<std::uint32_t>(mix64(seed3 + i)))};
      }
      break;
    }
    case Scramble::digit: {
      std::array<unsigned, kMaxDigits> permutation;
      for (unsigned k = 0; k < kMaxDigits; ++k) permutation[k] = one_of_six(mix64(seed3 + k));
      for (std::uint32_t k = 0; k < size; ++k) {
        out[k] = {reverse_bits(start + k) ^ seed2, inverse3_digit_scrambled(start + k, permutation)};
      }
      break;
    }
    case Scramble::none:
      for (std::uint32_t k = 0; k < size; ++k) out[k] = {reverse_bits(start + k), inverse3(start + k)};
      break;
  }
}

}  // namespace abn
