// Integer hashing where a keyed value, not a random sequence, is wanted.
#pragma once

#include <cstdint>

#include "sampling/hd.h"

namespace abn {

/// A bijection of 64-bit words in which every input bit reaches every output bit: the finaliser of SplitMix64 (Steele,
/// Lea, Flood 2014; constants "Mix13" of Stafford 2011).
ABN_HD constexpr std::uint64_t mix64(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

}  // namespace abn
