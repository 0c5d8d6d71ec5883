// THE TABLE: one row per strategy, in the order of `abn list`, and the look-up by name.
#include <algorithm>

#include "sampling/adaptive/adaptive_jitter.h"
#include "sampling/adaptive/sph_adaptive.h"
#include "sampling/adaptive/sph_adaptive_thesis.h"
#include "sampling/ccvt.h"
#include "sampling/cmj.h"
#include "sampling/dart.h"
#include "sampling/fis/fis_inversion.h"
#include "sampling/fis/fis_jitter.h"
#include "sampling/fis/fis_metropolis.h"
#include "sampling/fis/fis_rejection.h"
#include "sampling/fis/fis_sph.h"
#include "sampling/from_command.h"
#include "sampling/from_file.h"
#include "sampling/gbn.h"
#include "sampling/halton.h"
#include "sampling/hammersley.h"
#include "sampling/jitter.h"
#include "sampling/lloyd.h"
#include "sampling/multijitter.h"
#include "sampling/nrooks.h"
#include "sampling/pmj02.h"
#include "sampling/poisson_disk.h"
#include "sampling/random.h"
#include "sampling/regular.h"
#include "sampling/sobol.h"
#include "sampling/sobol_owen.h"
#include "sampling/sph_blue_noise.h"
#include "sampling/strategy.h"
#include "sampling/zero_two.h"

namespace abn {

void require_task(std::string_view strategy, const SamplingTask& task) {
  if (task.budget == 0) throw ConfigError(std::string(strategy) + ": a budget of 0 samples; ask for at least 1");
  if (task.plane.area() == 0)
    throw ConfigError(std::string(strategy) + ": the plane has no pixels; both sides must be at least 1");
}

const std::vector<Strategy>& strategies() {
  static const std::vector<Strategy> table = {
      row<Random>(),
      row<RandomPixel>(),
      row<Regular>(),
      row<Jitter>(),
      row<JitterPlane>(),
      row<NRooks>(),
      row<MultiJitter>(),
      row<Cmj>(),
      row<Hammersley>(),
      row<Halton>(),
      row<Sobol>(),
      row<SobolOwen>(),
      row<ZeroTwo>(),
      row<Pmj02>(),
      row<Dart>(),
      row<PoissonDisk>(),
      row<Lloyd>(),
      row<Ccvt>(),
      row<Gbn>(),
      row<SphBlueNoise>(),
      row<SphAdaptive>(),
      row<SphAdaptiveThesis>(),
      row<AdaptiveJitter>(),
      row<FisJitter>(),
      row<FisInversion>(),
      row<FisRejection>(),
      row<FisMetropolis>(),
      row<FisSph>(),
      row<FromFile>(),
      row<FromCommand>(),
  };
  return table;
}

const Strategy& find_strategy(std::string_view name, ParameterWords& words) {
  const auto colon = name.find(':');
  const std::string_view row_name = name.substr(0, colon);
  std::string known;
  for (const auto& strategy : strategies()) {
    const auto& info = strategy.info;
    const bool outside = info.family == "outside";
    const bool named =
        info.name == row_name || std::find(info.aliases.begin(), info.aliases.end(), row_name) != info.aliases.end();
    if (named && outside == (colon != std::string_view::npos)) {
      if (outside) words[strategy.parameters.front().name] = std::string(name.substr(colon + 1));
      return strategy;
    }
    known.append(" ").append(info.name).append(outside ? ":…" : "");
  }
  throw ConfigError("unknown strategy '" + std::string(name) + "'; known:" + known);
}

}  // namespace abn
