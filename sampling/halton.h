// The Halton sequence in bases 2 and 3, scrambled.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// Points (radical inverse of i in base 2, in base 3).
///
/// scramble = owen: every digit is permuted at random depending on the digits before it (nested uniform scrambling);
/// digits that n points cannot tell apart are filled at random. digit: one random permutation per digit place. none:
/// the plain sequence from the origin on, the same for every seed and pixel.
class Halton final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "plane";
    std::string scramble = "owen";
  };
  static std::vector<Field<Params>> fields();
  Halton(const SamplingTask& task, const Params& parameters);

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
  Strata strata(std::uint64_t n) const override;

 private:
  enum class Scramble { owen, digit, none };
  Scramble scramble_;
};

}  // namespace abn
