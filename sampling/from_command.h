// Anybody's sampler as a strategy: `command:CMD`.
#pragma once

#include <string>

#include "sampling/params.h"
#include "sampling/sampler.h"
#include "sampling/strategy.h"

namespace abn {

/// The points a shell command prints, scaled from the unit square to the plane. In the command {n}, {seed}, {width} and
/// {height} stand for the budget, the seed and the plane [px]; other braces stay. Its standard output is read
/// as by parse_points(): "x y", "x,y" or "(x, y)" lines, psa, csv, utk-bin. It must print exactly {n} points.
/// The command runs through /bin/sh in a process group of its own, which is killed when it takes longer than
/// `timeout_s` or when this process is told to stop.
class FromCommand final : public Sampler {
 public:
  struct Params {
    std::string command;
    double timeout_s = 600;
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError without a command. Nothing runs before the first next().
  FromCommand(const SamplingTask& task, const Params& params);
  /// The first call runs the command. Throws ConfigError for another number of points than the budget, IoError if it
  /// fails (with its exit status and the last line of its standard error), takes too long or prints no points.
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  void run();

  SamplingTask task_;
  std::string command_;
  double timeout_s_;
  bool ran_ = false;
  PointSet points_;  // [px]
  std::string notice_;
  std::size_t emitted_ = 0;
};

}  // namespace abn
