// The table at the end of an experiment: mean error with its interval, the ratio to a baseline, the time.
#pragma once

#include <string>
#include <vector>

#include "harness/record.h"

namespace abn::harness {

/// Markdown, one table per scene, filter and budget, one line per label: RMSE as mean and 95 % interval over seeds,
/// paired ratio to `baseline` with its bootstrap interval ("better" or "worse" only where the interval excludes 1),
/// median times; the mean of the actual samples per pixel where runs stop at a target error, and of estimated RMSE /
/// true RMSE where errors are estimated. Below it the same errors inside every crop.
std::string summary_table(const std::vector<Json>& rows, const std::string& baseline);

}  // namespace abn::harness
