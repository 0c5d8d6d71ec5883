#include "harness/experiment_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "harness/crops.h"
#include "harness/error_map.h"
#include "harness/experiment_loop.h"
#include "harness/image_io.h"
#include "harness/output.h"
#include "harness/sample_picture.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

namespace fs = std::filesystem;

void save(const fs::path& path, const Picture& picture) { save_rgb8(path.string(), picture.size(), picture.rgb); }

/// The runs whose pictures belong on one sheet.
struct Sheet {
  SubjectSpec subject;
  std::uint64_t samples = 0;
  std::vector<RunSpec> runs;  // of the first seed
};

std::vector<Sheet> sheets_of(const ExperimentSpec& spec) {
  std::vector<Sheet> sheets;
  for (const RunSpec& run : spec.expand()) {
    if (run.seed != spec.first_seed) continue;
    auto sheet = std::find_if(sheets.begin(), sheets.end(), [&](const Sheet& s) {
      return s.samples == run.samples && s.subject.scene == run.subject.scene && s.subject.filter == run.subject.filter;
    });
    if (sheet == sheets.end()) sheet = sheets.insert(sheets.end(), {run.subject, run.samples, {}});
    sheet->runs.push_back(run);
  }
  return sheets;
}

}  // namespace

std::string scene_name(const std::string& scene) {
  return scene.starts_with("scene:") ? scene.substr(6) : fs::path(scene).stem().string();
}

ExperimentPictures::ExperimentPictures(const ExperimentSpec& spec, const fs::path& out) : spec_(spec), out_(out) {
  if (!spec.images) return;
  const std::vector<RunSpec> runs = spec.expand();
  for (const RunSpec& run : runs) several_filters_ |= run.subject.filter != runs.front().subject.filter;
  std::map<std::string, std::string> owners;
  for (const RunSpec& run : runs) {
    if (!wants(run)) continue;
    const std::string owner = fmt::format("'{}' of {}", run.label, run.subject.scene);
    const auto [other, is_new] = owners.emplace(stem(run), owner);
    if (is_new) continue;
    throw ConfigError(
        fmt::format("the pictures of {} and {} would have the same file names; change a label or the name of an image",
                    other->second, owner));
  }
}

std::string ExperimentPictures::subject_stem(const SubjectSpec& subject) const {
  return scene_name(subject.scene) + (several_filters_ ? "_" + file_name(subject.filter) : "");
}

std::string ExperimentPictures::stem(const RunSpec& run) const {
  return fmt::format("{}_{}_{}", subject_stem(run.subject), run.samples, file_name(run.label));
}

void ExperimentPictures::save_truth(const Subject& subject) const {
  if (!spec_.images) return;
  fs::create_directories(out_ / "images");
  const std::string name = subject_stem(subject.spec) + "_truth";
  write_picture(picture(name + ".exr").string(), subject.truth.image, subject.high_dynamic_range);
  write_picture(picture(name + ".png").string(), subject.truth.image, subject.high_dynamic_range);
}

void ExperimentPictures::save(const RunResult& result, const Subject& subject, const PointSet& samples) const {
  const std::string name = stem(result.spec);
  const auto path = [&](const std::string& ending) { return picture(name + ending).string(); };
  write_picture(path(".exr"), result.picture, subject.high_dynamic_range);
  write_picture(path(".png"), result.picture, subject.high_dynamic_range);
  write_error_map(path("_difference.exr"), result.picture, subject.truth.image, spec_.gain);
  write_error_map(path("_error.png"), result.picture, subject.truth.image, spec_.gain);
  if (!result.standard_error.cells().empty()) {
    write_estimated_error(path("_estimated.exr"), result.standard_error, spec_.gain);
    write_estimated_error(path("_estimated.png"), result.standard_error, spec_.gain);
  }
  if (!spec_.sample_pictures) return;
  const Extent plane = subject.spec.to;
  const auto save_samples = [&](const std::string& ending, const PlaneRegion& region) {
    harness::save(path(ending), draw_samples(samples.position, result.ghosts, plane, region));
  };
  std::vector<Vec2f> all = result.ghosts;  // samples of a filter may lie outside the plane too
  all.insert(all.end(), samples.position.begin(), samples.position.end());
  save_samples("_samples.png", region_around(plane, all));
  for (const Region& region : named_regions(subject.spec.scene, spec_.crops)) {
    const CanvasArea area = pixels_of(region, plane);
    save_samples("_samples_" + region.name + ".png",
                 {static_cast<double>(area.left), static_cast<double>(area.top), static_cast<double>(area.right()),
                  static_cast<double>(area.bottom())});
  }
}

fs::path ExperimentPictures::draw_sheets(const std::vector<Json>& rows) const {
  fs::path first;
  if (!spec_.images) return first;
  std::map<std::string, const Json*> rows_by_key;
  for (const auto& row : rows) rows_by_key[row["key"]] = &row;
  const std::vector<Sheet> sheets = sheets_of(spec_);
  for (const Sheet& sheet : sheets) {
    std::vector<Exhibit> exhibits;
    for (const RunSpec& run : sheet.runs) {
      const fs::path file = picture(stem(run) + ".exr");
      const auto row = rows_by_key.find(run_key(run));
      if (row == rows_by_key.end() || !fs::exists(file)) break;
      const Json& rmse = (*row->second)["scores"].value("rmse", Json(nullptr));
      exhibits.push_back({run.label, load_image(file.string()).image, rmse.is_number() ? rmse.get<double>() : 0.0});
    }
    if (exhibits.size() != sheet.runs.size()) continue;
    const Image truth = load_image(picture(subject_stem(sheet.subject) + "_truth.exr").string()).image;
    const bool above_one = std::any_of(truth.texels.begin(), truth.texels.end(), [](float v) { return v > 1.0F; });
    const std::string which = fmt::format("{}_{}", subject_stem(sheet.subject), sheet.samples);
    const auto title = [&](const std::string& what) {
      return fmt::format("{}: {}, {}{}x{}, {} samples", spec_.title, what,
                         several_filters_ ? sheet.subject.filter + ", " : "", spec_.to.width, spec_.to.height,
                         sheet.samples);
    };
    const auto path = [&](const std::string& name) {
      return out_ / (sheets.size() == 1 ? name + ".png" : fmt::format("{}_{}.png", name, which));
    };
    harness::save(path("overview"),
                  overview(title(scene_name(sheet.subject.scene)), truth, exhibits, above_one, spec_.gain));
    if (first.empty()) first = path("overview");
    for (const Region& region : named_regions(sheet.subject.scene, spec_.crops)) {
      harness::save(path("crops_" + region.name),
                    crop_sheet(truth, exhibits, region,
                               {.title = title(scene_name(sheet.subject.scene) + ", " + region.name),
                                .high_dynamic_range = above_one,
                                .gain = spec_.gain,
                                .zoom = static_cast<std::uint32_t>(spec_.zoom)}));
    }
  }
  return first;
}

}  // namespace abn::harness
