// Anybody's point set as a strategy: `file:PATH`.
#pragma once

#include <string>

#include "sampling/params.h"
#include "sampling/points_io.h"
#include "sampling/sampler.h"
#include "sampling/strategy.h"

namespace abn {

/// A point set scaled from the unit square to a plane, floats on its far border moved below it [px].
/// Throws ConfigError naming `source` if an owner pixel lies outside the plane.
PointSet scale_to_plane(FilePoints points, Extent plane, const std::string& source);

/// The points of a file in any format of points_io.h, scaled to the plane, in the order of the file, with its weights
/// and pixels if it has them. The file must hold exactly `budget` points: a part of a set has not its properties.
class FromFile final : public Sampler {
 public:
  struct Params {
    std::string path;
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Reads the file. Throws IoError if it cannot, ConfigError without a path or if its number of points is not the
  /// budget (naming the number and the flag).
  FromFile(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  PointSet points_;  // [px]
  std::string notice_;
  std::size_t emitted_ = 0;
};

/// The next part of `points` from `emitted` on, at most 2^20; moves `emitted` on.
SampleBatch next_chunk(const PointSet& points, std::size_t& emitted);

}  // namespace abn
