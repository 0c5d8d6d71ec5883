// Capacity-constrained Voronoi tessellation: centroids of cells that all have the same area.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sampling/emit_by_pixel.h"
#include "sampling/sampler.h"
#include "sampling/strategy.h"

namespace abn {

struct CcvtDescent {
  int capacity = 64;        // samples of the area per site
  int iterations = 100;     // at each capacity, at most
  double relaxation = 1.9;  // share of the way to the centroid, in (0,2)
};

struct CcvtReport {
  int iterations = 0;            // of all capacities
  double first_energy = 0;       // of the first assignment
  double energy = 0;             // at the end
  double swaps = 0;              // per site in the last iteration
  double mean_displacement = 0;  // of the sites in the last iteration [spacings]
  bool converged = false;        // no swap lowers the energy any more
};

/// Moves `sites` [px], inside the plane, to the centroids of equally large sets of jittered samples on the torus, which
/// stand for the area. On return `samples` [px] holds them: site i owns [i*capacity, (i+1)*capacity), and is their
/// centroid. Descends the energy: the mean of |sample - site|^2 over area/N.
///
/// An iteration moves every site `relaxation` of the way to its centroid and then exchanges samples between all pairs
/// of sites near enough to gain, in a fixed order: of the samples of two sites those go to the first whose |x - s_1|^2
/// - |x - s_2|^2 is least, which is what Balzer's swaps of single pairs end in. Neither step raises the energy. Before
/// the first iteration the sites stay until the assignment has settled, because they would inherit its shape. A
/// capacity above 16 that is a multiple of 4 starts from the result of a quarter of it.
///
/// On one thread. The energy ends where swaps end, above that of exact areas, the nearer the larger the capacity.
CcvtReport relax_ccvt(std::vector<Vec2f>& sites, std::vector<Vec2f>& samples, Extent plane, const CcvtDescent& descent,
                      std::uint64_t seed);

/// Balzer, Schlömer, Deussen 2009, "Capacity-constrained point distributions: a variant of Lloyd's method" (ACM TOG
/// 28(3)). Deviations, for speed: only sites whose sets reach each other are paired, as in Li, Nehab, Wei, Sander,
/// Hoppe 2010, "Fast capacity constrained Voronoi tessellation", whole sets are exchanged in one go, the first
/// assignment is local, sites overshoot their centroids, and capacities grow. The samples of the area are jittered, so
/// that neither a lattice nor white noise comes in.
///
/// The time grows a little faster than the number of sites and than the capacity: 4096 sites of 64 samples take .4 s of
/// one core, 240 000 take 36 s and half a GB, 4096 of 1024 samples 10 s.
class Ccvt final : public Sampler {
 public:
  struct Params {
    int capacity = 64;
    int iterations = 100;
    double relaxation = 1.9;
    std::string start = "coarse_cells";
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a budget of 0, or if budget * capacity is above 2^31 (16 GiB). Nothing is computed before
  /// the first next().
  Ccvt(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  SamplingTask task_;
  Params params_;
  EmitByPixel samples_;
  CcvtReport report_;
};

}  // namespace abn
