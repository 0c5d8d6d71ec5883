#include "sampling/sobol.h"

#include <bit>
#include <boost/random/sobol.hpp>

namespace abn {
namespace {

constexpr int kDimensions = 3667;  // of Boost's table

}  // namespace

const StrategyInfo Sobol::info{
    .name = "sobol",
    .family = "low discrepancy",
    .summary = "Two dimensions of the unscrambled Sobol sequence, origin included.",
    .cite = "Sobol 1967; directions: Joe and Kuo 2008; order: Antonov and Saleev 1979; table of Boost.Random",
    .advice = "To see the sequence itself and its badly stratified pairs (10,11 or 18,19); for pictures sobol_owen.",
    .random = false,
};

std::vector<Field<Sobol::Params>> Sobol::fields() {
  return {domain_field<Params>(),
          {"dim_x", &Params::dim_x, "dimension of the sequence used for x, from 0", 0, kDimensions - 1},
          {"dim_y", &Params::dim_y, "dimension of the sequence used for y, from 0", 0, kDimensions - 1}};
}

SobolDirections sobol_directions(int dimension) {
  boost::random::sobol_engine<std::uint32_t, 32> engine(static_cast<std::size_t>(dimension) + 1);
  SobolDirections directions;
  for (unsigned j = 0; j < 32; ++j) {
    // The point whose Gray code is 2^j is number 2^(j+1) - 1; Boost's seed(s) leads to number s + 1.
    engine.seed(static_cast<std::uint32_t>((std::uint64_t{2} << j) - 2));
    for (int skipped = 0; skipped < dimension; ++skipped) engine();
    directions[j] = engine();
  }
  return directions;
}

Sobol::Sobol(const SamplingTask& task, const Params& parameters)
    : UnitSquareSampler(task, info.name, domain_of(parameters.domain)) {
  if (parameters.dim_x == parameters.dim_y) {
    throw ConfigError("parameters 'dim_x' and 'dim_y' of sobol are both " + std::to_string(parameters.dim_x) +
                      ", which puts all points on the diagonal; give two different dimensions");
  }
  x_ = sobol_directions(parameters.dim_x);
  y_ = sobol_directions(parameters.dim_y);
}

void Sobol::points(std::uint64_t, std::uint64_t first, std::uint64_t, std::span<UnitPoint> out) const {
  const auto start = static_cast<std::uint32_t>(first);
  UnitPoint point{};
  for (std::uint32_t gray = start ^ (start >> 1); gray != 0; gray &= gray - 1) {
    const auto j = static_cast<std::size_t>(std::countr_zero(gray));
    point.x ^= x_[j];
    point.y ^= y_[j];
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = point;
    const auto j = static_cast<std::size_t>(std::countr_zero(first + k + 1));  // the bit in which the next code differs
    point.x ^= x_[j];
    point.y ^= y_[j];
  }
}

}  // namespace abn
