// Random permutations that need no memory: element i is computed, not looked up.
#pragma once

#include <bit>
#include <cassert>
#include <cstdint>

#include "sampling/hash.h"
#include "sampling/hd.h"

namespace abn {

/// The permutation of [0, n) named by a key; 1 <= n <= 2^32 - 1.
///
/// Up to 16 elements it is drawn exactly, by shuffling the digits of one word (Fisher and Yates). Above, steps that are
/// each a bijection of the next power of two (add, multiply by an odd number, xor-shift) are repeated until the result
/// falls below n: the idea of Kensler 2013 ("Correlated multi-jittered sampling") with our own steps, whose every
/// constant comes from the key. For few elements such steps would prefer some permutations visibly.
class Permutation {
 public:
  ABN_HD constexpr Permutation(std::uint32_t n, std::uint64_t key) : n_(n) {
    assert(n >= 1);
    if (n <= kSmall) {
      shuffle_digits(key);
      return;
    }
    const int bits = std::bit_width(n - 1);
    mask_ = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    shift_ = (bits + 1) / 2;
    for (auto& word : round_) word = mix64(key += 0x9E3779B97F4A7C15U);
  }

  /// Element i of the permutation, i < n.
  ABN_HD constexpr std::uint32_t operator()(std::uint32_t i) const {
    assert(i < n_);
    if (n_ <= kSmall) return static_cast<std::uint32_t>(round_[0] >> (4 * i)) & 15U;
    do {
      for (const std::uint64_t word : round_) {
        i = ((i + static_cast<std::uint32_t>(word)) * (static_cast<std::uint32_t>(word >> 32) | 1U)) & mask_;
        i ^= i >> shift_;
        i = (i * (static_cast<std::uint32_t>(word >> 20) | 1U)) & mask_;
        i ^= i >> 1;
      }
    } while (i >= n_);
    return i;
  }

 private:
  static constexpr std::uint32_t kSmall = 16;

  ABN_HD constexpr void shuffle_digits(std::uint64_t key) {
    std::uint64_t digits = 0xFEDCBA9876543210U;
    std::uint64_t random = 0;
    for (std::uint32_t last = n_ - 1, draw = 0; last > 0; --last, ++draw) {
      if (draw % 3 == 0) random = mix64(key += 0x9E3779B97F4A7C15U);
      const std::uint64_t other = ((random & 0x1FFFFFU) * (last + 1)) >> 21;  // 21 bits a draw: bias below 1e-5
      random >>= 21;
      const std::uint64_t difference = ((digits >> (4 * last)) ^ (digits >> (4 * other))) & 15U;
      digits ^= (difference << (4 * last)) | (difference << (4 * other));  // if other = last, difference is 0
    }
    round_[0] = digits;
  }

  std::uint32_t n_;
  std::uint32_t mask_ = 0;
  int shift_ = 0;
  std::uint64_t round_[4] = {};
};

}  // namespace abn
