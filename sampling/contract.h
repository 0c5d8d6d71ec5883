// The contract that every strategy keeps, as a check that tests and authors of new strategies can run.
#pragma once

#include <string>
#include <vector>

#include "sampling/strategy.h"

namespace abn {

/// All samples of a task.
PointSet draw_all(const Strategy& strategy, const SamplingTask& task, const ParameterWords& words);

/// Breaches of the contract (architecture: exact budget; finite positions inside the plane, or an owner pixel given;
/// a constant image is reproduced; 1 and 2 threads agree bit for bit; another seed gives other samples where the
/// strategy is random; a strategy that is not adaptive ignores feedback; after the end always empty), one sentence
/// each; empty = kept. Lets exceptions of `make` pass.
std::vector<std::string> contract_breaches(const Strategy& strategy, const SamplingTask& task,
                                           const ParameterWords& words = {});

}  // namespace abn
