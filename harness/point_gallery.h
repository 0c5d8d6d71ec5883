// The pictures of a point-set experiment, drawn from the points and rows on disk, so that a resumed experiment gets all
// of them.
#pragma once

#include <filesystem>
#include <vector>

#include "harness/point_spec.h"
#include "harness/record.h"

namespace abn::harness {

/// Where the points of a run are kept, in the results' folder `out`.
std::filesystem::path points_file(const std::filesystem::path& out, const PointRunSpec& spec);

/// Throws ConfigError if the files of two runs would have the same name.
void require_own_pictures(const PointExperimentSpec& spec);

/// Draws into `out`: images/ with points, spectrum and pair correlation of every strategy; an overview sheet for each
/// density and count with the strategies side by side; and for sweeps of two or three keys a map of every metric.
/// What lacks points or rows (another shard makes them) is left out. Returns the first sheet, or an empty path.
std::filesystem::path draw_gallery(const PointExperimentSpec& spec, const std::filesystem::path& out,
                                   const std::vector<Json>& rows);

}  // namespace abn::harness
