// Sums and extremes of as many values as a block of threads has to look at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "sampling/hd.h"

namespace abn::sph_cuda {

/// Every block adds up its values one after the other, as a loop on the host does: all threads find values, one adds
/// them. A source has count(block), value(block, i) and store(block, sum).
template <class Source>
struct SumInTurn {
  static constexpr std::uint32_t threads = 256;
  static constexpr std::uint32_t segment = 1024;  // values at a time

  Source source;

  ABN_HD int phases(std::uint32_t block) const {
    const std::uint32_t count = source.count(block);
    return count == 0 ? 2 : 2 * static_cast<int>((count - 1) / segment + 1);
  }
  std::size_t shared_bytes() const { return (segment + 1) * sizeof(double); }
  ABN_HD void operator()(int phase, std::uint32_t block, std::uint32_t thread, void* memory) const {
    auto* value = static_cast<double*>(memory);
    double& sum = value[segment];
    const std::uint32_t begin = static_cast<std::uint32_t>(phase / 2) * segment;
    const std::uint32_t left = source.count(block) - begin;
    const std::uint32_t here = left < segment ? left : segment;
    if (phase % 2 == 0) {
      for (std::uint32_t k = thread; k < here; k += threads) value[k] = source.value(block, begin + k);
    } else if (thread == 0) {
      double total = begin == 0 ? 0 : sum;
      for (std::uint32_t k = 0; k < here; ++k) total += value[k];
      sum = total;
      if (left <= segment) source.store(block, total);
    }
  }
};

struct Extremes {
  float smallest = std::numeric_limits<float>::infinity();
  float largest = -std::numeric_limits<float>::infinity();
  ABN_HD void include(const Extremes& other) {
    smallest = other.smallest < smallest ? other.smallest : smallest;
    largest = other.largest > largest ? other.largest : largest;
  }
};

/// The same for the smallest and the largest value; value(block, i) gives Extremes.
template <class Source>
struct FindExtremes {
  static constexpr std::uint32_t threads = 256;
  static constexpr int last_phase = 9;  // all values, then half of 256, 128, …, 2, then the answer

  Source source;

  ABN_HD int phases(std::uint32_t) const { return last_phase + 1; }
  std::size_t shared_bytes() const { return threads * sizeof(Extremes); }
  ABN_HD void operator()(int phase, std::uint32_t block, std::uint32_t thread, void* memory) const {
    auto* shared = static_cast<Extremes*>(memory);
    if (phase == 0) {
      Extremes extremes;
      const std::uint32_t count = source.count(block);
      for (std::uint64_t i = thread; i < count; i += threads) {
        extremes.include(source.value(block, static_cast<std::uint32_t>(i)));
      }
      shared[thread] = extremes;
    } else if (phase < last_phase) {
      const std::uint32_t half = threads >> static_cast<unsigned>(phase);
      if (thread < half) shared[thread].include(shared[thread + half]);
    } else if (thread == 0) {
      source.store(block, shared[0]);
    }
  }
};

}  // namespace abn::sph_cuda
