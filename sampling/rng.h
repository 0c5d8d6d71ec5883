// Counter-based random numbers: every number is a pure function of (seed, stream, index, draw), so that any thread
// may compute any sample and the result does not depend on the number of threads.
//
// Generator: Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3").
// The standard library's distributions are not used: they differ between implementations.
#pragma once

#include <cstdint>

#include "sampling/hd.h"
#include "sampling/vec.h"

namespace abn {

struct Philox4 {
  std::uint32_t word[4];
};

/// One block of Philox4x32-10: 128 random bits from a 128-bit counter and a 64-bit key.
ABN_HD constexpr Philox4 philox4x32(Philox4 counter, std::uint32_t key0, std::uint32_t key1) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53U} * counter.word[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57U} * counter.word[2];
    counter = {{static_cast<std::uint32_t>(p1 >> 32) ^ counter.word[1] ^ key0, static_cast<std::uint32_t>(p1),
                static_cast<std::uint32_t>(p0 >> 32) ^ counter.word[3] ^ key1, static_cast<std::uint32_t>(p0)}};
    key0 += 0x9E3779B9U;
    key1 += 0xBB67AE85U;
  }
  return counter;
}

/// The number of a named stream (FNV-1a), so that two uses of one seed never share numbers: `Rng(seed,
/// stream_id("jitter"), pixel)`.
constexpr std::uint32_t stream_id(const char* name) {
  std::uint32_t hash = 2166136261U;
  for (; *name != '\0'; ++name) hash = (hash ^ static_cast<unsigned char>(*name)) * 16777619U;
  return hash;
}

/// Uniform in [0,1) with 24 bits: every value is a float, 1 is never reached.
ABN_HD constexpr float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24F; }

/// A sequence of random numbers keyed (seed, stream, index); cheap to make, so make one per sample, cell or pixel.
class Rng {
 public:
  ABN_HD constexpr Rng(std::uint64_t seed, std::uint32_t stream, std::uint64_t index = 0)
      : seed_(seed), index_(index), stream_(stream) {}

  /// 32 random bits.
  ABN_HD constexpr std::uint32_t next() {
    if (used_ == 4) {
      block_ =
          philox4x32({{static_cast<std::uint32_t>(index_), static_cast<std::uint32_t>(index_ >> 32), stream_, draw_++}},
                     static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32));
      used_ = 0;
    }
    return block_.word[used_++];
  }
  /// Uniform in [0,1).
  ABN_HD constexpr float uniform() { return unit_float(next()); }
  /// Uniform in the unit square [0,1)^2.
  ABN_HD constexpr Vec2f uniform2() {
    const float x = uniform();
    return {x, uniform()};
  }
  /// Uniform in [0,n), without bias (Lemire 2019); n >= 1.
  ABN_HD constexpr std::uint32_t below(std::uint32_t n) {
    std::uint64_t product = std::uint64_t{next()} * n;
    if (static_cast<std::uint32_t>(product) < n) {
      const std::uint32_t reject = (0U - n) % n;
      while (static_cast<std::uint32_t>(product) < reject) product = std::uint64_t{next()} * n;
    }
    return static_cast<std::uint32_t>(product >> 32);
  }

 private:
  std::uint64_t seed_;
  std::uint64_t index_;
  std::uint32_t stream_;
  std::uint32_t draw_ = 0;
  Philox4 block_{};
  std::uint32_t used_ = 4;
};

}  // namespace abn
