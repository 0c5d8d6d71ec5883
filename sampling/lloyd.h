// Lloyd's relaxation: every point moves to the centroid of its Voronoi cell.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sampling/emit_by_pixel.h"
#include "sampling/sampler.h"
#include "sampling/strategy.h"

namespace abn {

struct LloydDescent {
  double relaxation = 1;  // share of the way to the centroid, in (0,2)
  int iterations = 50;
  double tolerance = 0;  // mean move [spacings] below which to stop
};

struct LloydReport {
  int iterations = 0;
  double first_energy = 0;       // before the first iteration
  double energy = 0;             // at the end
  double mean_displacement = 0;  // of the last iteration [spacings]
  bool converged = false;
};

/// Lloyd's iteration on the torus of `plane`, all points at once. It descends the quantisation energy sum_i integral
/// over cell i of |x - x_i|^2 dA, reported here over area^2/N: at `relaxation` <= 1 the energy never rises (a centroid
/// is the best place for a fixed cell, the Voronoi cells are the best for fixed places), and no point set has less than
/// the hexagonal lattice, 5/(18 sqrt 3) = .16038 (Fejes Toth). Above 1 it overshoots on purpose: faster, mostly
/// falling. Positions [px] inside the plane, changed in place; of coincident points all but one have no cell and stay
/// until they are left alone. The result is the same for any number of threads.
LloydReport relax_lloyd(std::vector<Vec2f>& positions, Extent plane, const LloydDescent& descent);

/// Lloyd 1982, "Least squares quantization in PCM"; centroidal Voronoi tessellations: Du, Faber, Gunzburger 1999,
/// "Centroidal Voronoi tessellations: applications and algorithms". Exact cells on a torus. A long run crystallises: it
/// grows patches of hexagonal lattice, whose power spectrum oscillates strongly and which alias like a lattice, so the
/// number of iterations is a choice, not a matter of convergence.
class Lloyd final : public Sampler {
 public:
  struct Params {
    int iterations = 50;
    double relaxation = 1;
    double tolerance = 0;
    std::string start = "coarse_cells";
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a budget of 0 or above 2^32-1. Nothing is computed before the first next().
  Lloyd(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  SamplingTask task_;
  Params params_;
  EmitByPixel samples_;
  LloydReport report_;
};

}  // namespace abn
