// The pictures of an experiment: those of every first-seed run while it goes on, and sheets of them at its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/record.h"
#include "harness/run.h"
#include "harness/spec.h"

namespace abn::harness {

class ExperimentPictures {
 public:
  /// Throws ConfigError if the pictures of two runs would have the same name.
  ExperimentPictures(const ExperimentSpec& spec, const std::filesystem::path& out);

  bool wants(const RunSpec& run) const { return spec_.images && run.seed == spec_.first_seed; }

  /// The truth of a subject, EXR and PNG.
  void save_truth(const Subject& subject) const;

  /// The result (EXR and PNG), the signed difference (EXR), the error map (PNG), the estimated errors (EXR and PNG) if
  /// there are any, and with `sample_pictures` the samples on the whole plane and inside every crop (PNG).
  void save(const RunResult& result, const Subject& subject, const PointSet& samples) const;

  /// One sheet per scene, filter and budget, and one for each of its crops, from the pictures on disk, so that a
  /// resumed experiment gets all of it. A sheet whose pictures are not all there yet (another shard makes them) is left
  /// out. `rows` are those of runs.jsonl. Returns the first overview.
  std::filesystem::path draw_sheets(const std::vector<Json>& rows) const;

 private:
  std::string subject_stem(const SubjectSpec& subject) const;
  std::string stem(const RunSpec& run) const;
  std::filesystem::path picture(const std::string& name) const { return out_ / "images" / name; }

  const ExperimentSpec& spec_;
  std::filesystem::path out_;
  bool several_filters_ = false;
};

/// "apple" of scene:apple, "photo" of folder/photo.png.
std::string scene_name(const std::string& scene);

}  // namespace abn::harness
