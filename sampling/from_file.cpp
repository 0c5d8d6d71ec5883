#include "sampling/from_file.h"

#include <algorithm>
#include <utility>

#include "sampling/error.h"

namespace abn {
namespace {

constexpr std::size_t max_batch = 1U << 20;

}  // namespace

PointSet scale_to_plane(FilePoints points, Extent plane, const std::string& source) {
  PointSet scaled;
  scaled.position.reserve(points.position.size());
  const bool owned = !points.pixel.empty();
  const auto coordinate = [&](double unit, std::uint32_t side) {
    // In double: a set written by write_points comes back as the same floats.
    const auto position = static_cast<float>(unit * static_cast<double>(side));
    return owned ? position : std::min(position, just_below(static_cast<float>(side)));
  };
  for (const auto& [x, y] : points.position) {
    scaled.position.push_back({coordinate(x, plane.width), coordinate(y, plane.height)});
  }
  for (std::size_t i = 0; i < points.pixel.size(); ++i) {
    if (points.pixel[i] >= plane.area()) {
      throw ConfigError(source + ": point " + std::to_string(i) + " belongs to pixel " +
                        std::to_string(points.pixel[i]) + ", but the plane has " + std::to_string(plane.area()) +
                        "; use the --to the file was written for");
    }
  }
  scaled.weight = std::move(points.weight);
  scaled.pixel = std::move(points.pixel);
  return scaled;
}

SampleBatch next_chunk(const PointSet& points, std::size_t& emitted) {
  const std::size_t count = std::min(points.position.size() - emitted, max_batch);
  SampleBatch batch{.position = std::span(points.position).subspan(emitted, count)};
  if (!points.weight.empty()) batch.weight = std::span(points.weight).subspan(emitted, count);
  if (!points.pixel.empty()) batch.pixel = std::span(points.pixel).subspan(emitted, count);
  emitted += count;
  return batch;
}

const StrategyInfo FromFile::info = {
    .name = "file",
    .family = "outside",
    .summary = "the points of a file (utk, utk-bin, psa, rps, csv), scaled to the plane: file:PATH",
    .cite = "whoever made the points",
    .advice = "to compare a point set made elsewhere",
    .random = false,
};

std::vector<Field<FromFile::Params>> FromFile::fields() {
  return {{"path", &Params::path, "the file of points; the name file:PATH sets it"}};
}

FromFile::FromFile(const SamplingTask& task, const Params& params) {
  if (params.path.empty()) throw ConfigError("strategy file needs a path; write file:PATH");
  FilePoints points = read_points(params.path);
  if (points.position.size() != task.budget) {
    throw ConfigError("'" + params.path + "' holds " + std::to_string(points.position.size()) + " points, but " +
                      std::to_string(task.budget) + " samples are asked for; give --samples " +
                      std::to_string(points.position.size()));
  }
  notice_ = std::exchange(points.notice, {});
  points_ = scale_to_plane(std::move(points), task.plane, "'" + params.path + "'");
}

SampleBatch FromFile::next(const Feedback&) { return next_chunk(points_, emitted_); }

std::vector<Diagnostic> FromFile::diagnostics() const {
  if (notice_.empty()) return {};
  return {{"more_realisations", 1, notice_, true}};
}

}  // namespace abn
