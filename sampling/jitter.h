// Jittered sampling: one uniform point in every cell of a partition into cells of equal area.
#pragma once

#include <array>

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// Rows of the partition of `area` into n cells of equal area: those of the near-square grid if there is one, else
/// about sqrt(n) rows whose cells differ by at most one in number and whose heights follow their number.
std::uint64_t jitter_rows(std::uint64_t n, Extent area);

/// Jittered points with a partition for every count, primes too.
class JitterBase : public UnitSquareSampler {
 protected:
  JitterBase(const SamplingTask& task, const std::string& name, Domain domain);
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const final;
  Strata strata(std::uint64_t n) const final;
  bool alternates_axes() const final { return true; }

 private:
  std::array<std::uint64_t, 2> rows_{};  // of the smaller sets and of those with one point more
};

/// Jittered points in every pixel: 6 = 2 x 3 cells in one pixel, 3 x 2 in its neighbours.
class Jitter final : public JitterBase {
 public:
  static const StrategyInfo info;
  struct Params {};
  static std::vector<Field<Params>> fields() { return {}; }
  Jitter(const SamplingTask& task, const Params&) : JitterBase(task, info.name, Domain::pixel) {}
};

/// Jittered points over the plane, whose cells ignore the pixels.
class JitterPlane final : public JitterBase {
 public:
  static const StrategyInfo info;
  struct Params {};
  static std::vector<Field<Params>> fields() { return {}; }
  JitterPlane(const SamplingTask& task, const Params&) : JitterBase(task, info.name, Domain::plane) {}
};

}  // namespace abn
