// Progressive multi-jittered (0,2) sequences.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// A progressive multi-jittered (0,2) sequence: every 2^m first points are a (0,m,2)-net, and from 4^k points on each
/// old point's cell of the 2^k by 2^k grid receives three more: first in the subquadrant diagonally opposite, then in
/// the two others in random order (Christensen, Kensler, Kilpatrick 2018).
///
/// Made without their search. When the first 2^m points are a net whose every point carries random further digits,
/// the strata of the next 2^m points are forced, all but the order of the last two subquadrants; so the sequence is
/// equal in law to a linear one in that order (see pmj_order_matrix), Owen-scrambled, with a coin per cell for the
/// last two. Hence its first 2^m points are, as a set, those of sobol_owen in law; what differs is the order.
/// Nothing is stored. Compare Helmer, Christensen, Kensler 2021, "Stochastic generation of (t,s) sample sequences".
class Pmj02 final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "pixel";
  };
  static std::vector<Field<Params>> fields() { return {domain_field<Params>()}; }
  Pmj02(const SamplingTask& task, const Params& parameters)
      : UnitSquareSampler(task, info.name, domain_of(parameters.domain)) {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
};

}  // namespace abn
