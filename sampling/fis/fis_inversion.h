// Filter importance sampling from even points of the square by inversion.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sampling/fis/filter_sampler.h"
#include "sampling/strategy.h"

namespace abn {

/// Points of the unit square, mapped by the inverse of the filter's distribution: the way of the literature, with which
/// thesis 4.2 compares. The default takes small tori of SPH blue noise (made once, 256 sets of up to 256 points, fewer
/// of more), for every pixel one of them at random, shifted on the torus by a random vector (Cranley and Patterson
/// 1976). Inversion distorts distances: what was blue noise on the square is not under the filter.
class FisInversion final : public FilterSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string set = "blue_noise";
    std::string method = "auto";
  };
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a method that the filter's support does not allow.
  FisInversion(const SamplingTask& task, const Params& params);
  std::vector<Diagnostic> diagnostics() const override;

 private:
  void prepare() override;
  void offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float> weight) const override;
  void unit_points(std::uint64_t key, std::span<Vec2f> out) const;

  Params params_;
  std::map<std::size_t, std::vector<Vec2f>> tori_;  // by set size: the sets one after the other, [0,1)^2
  double bank_s_ = 0;
};

}  // namespace abn
