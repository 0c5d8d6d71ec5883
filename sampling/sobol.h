// The Sobol sequence as published: any two of its dimensions, without scrambling.
#pragma once

#include <array>

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// Direction numbers of one dimension: bit j of the Gray code of i selects [j] for coordinate i, in units of 2^-32.
using SobolDirections = std::array<std::uint32_t, 32>;

/// Those of Boost.Random (Joe and Kuo 2008); 0 <= dimension < 3667.
SobolDirections sobol_directions(int dimension);

/// Two dimensions of the Sobol sequence in Gray-code order, that is Boost's with the origin, which Boost skips, put
/// back: without it no power of two of points is a good net (t = m - 1 instead of 0 for dimensions 0 and 1).
/// The same points for every seed and, with domain = pixel, in every pixel.
class Sobol final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "plane";
    int dim_x = 0;
    int dim_y = 1;
  };
  static std::vector<Field<Params>> fields();
  /// Throws ConfigError if both dimensions are the same.
  Sobol(const SamplingTask& task, const Params& parameters);

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;

 private:
  SobolDirections x_, y_;
};

}  // namespace abn
