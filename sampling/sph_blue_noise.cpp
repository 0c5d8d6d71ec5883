#include "sampling/sph_blue_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "sampling/choice_field.h"
#include "sampling/density_warp.h"
#include "sampling/error.h"
#include "sampling/from_file.h"
#include "sampling/relaxation_start.h"
#include "sampling/rng.h"
#include "sampling/sph/draw.h"
#include "sampling/sph/size_field.h"

namespace abn {
namespace {

constexpr std::uint64_t most_for_twin = 20000;  // its steps cost O(N^2)

std::vector<Vec2f> to_pixels(const std::vector<sph::UnitPosition>& positions, Extent plane) {
  const float right = just_below(static_cast<float>(plane.width));
  const float bottom = just_below(static_cast<float>(plane.height));
  std::vector<Vec2f> pixels;
  pixels.reserve(positions.size());
  for (const sph::UnitPosition p : positions) {
    pixels.push_back({std::min(static_cast<float>(p.x * plane.width), right),
                      std::min(static_cast<float>(p.y * plane.height), bottom)});
  }
  return pixels;
}

/// Eq. 2.22 for a relative density I: s = 1 / sqrt(I), I clamped from below at a share of its maximum.
Grid<float> size_of_density(const Grid<float>& density, double least) {
  float largest = 0;
  for (std::size_t i = 0; i < density.cells().size(); ++i) {
    if (!(density[i] >= 0 && std::isfinite(density[i]))) {
      throw ConfigError("density: cell " + std::to_string(i) + " is " + std::to_string(density[i]) +
                        "; every relative density must be finite and >= 0");
    }
    largest = std::max(largest, density[i]);
  }
  if (!(largest > 0)) throw ConfigError("density: it is 0 everywhere; some of it must be above 0");
  Grid<float> size(density.size());
  for (std::size_t i = 0; i < size.cells().size(); ++i) {
    size[i] = static_cast<float>(1 / std::sqrt(std::max(double{density[i]} / double{largest}, least)));
  }
  return size;
}

template <class Enumeration>
Enumeration choice(const std::string& word, std::initializer_list<const char*> words) {
  int at = 0;
  for (const char* name : words) {
    if (word == name) return static_cast<Enumeration>(at);
    ++at;
  }
  throw ConfigError("sph_blue_noise: unknown word '" + word + "'");  // fields() lets none through
}

}  // namespace

std::vector<Vec2f> coarse_cell_positions(Extent plane, std::uint64_t count, std::uint64_t seed, double per_cell) {
  const double cells = std::max(1.0, static_cast<double>(count) / per_cell);
  // The shorter side first: on a thin plane it gets one cell and the longer side all the others.
  const auto shorter = std::min(plane.width, plane.height);
  const auto longer = std::max(plane.width, plane.height);
  const double across = std::max(1.0, std::round(std::sqrt(cells * shorter / longer)));
  const double along = std::max(1.0, std::round(cells / across));
  const bool wide = plane.width >= plane.height;
  const auto columns = static_cast<std::uint64_t>(wide ? along : across);
  const auto rows = static_cast<std::uint64_t>(wide ? across : along);

  const double cell_width = static_cast<double>(plane.width) / static_cast<double>(columns);
  const double cell_height = static_cast<double>(plane.height) / static_cast<double>(rows);
  const float right = just_below(static_cast<float>(plane.width));
  const float bottom = just_below(static_cast<float>(plane.height));
  std::vector<Vec2f> positions;
  positions.reserve(count);
  // count * (visited + 1) / total without overflow: whole part and remainder of the mean count, apart.
  const std::uint64_t total = columns * rows;
  const std::uint64_t whole = count / total;
  const std::uint64_t rest = count % total;
  std::uint64_t visited = 0;
  for (std::uint64_t row = 0; row < rows; ++row) {
    for (std::uint64_t k = 0; k < columns; ++k, ++visited) {
      const std::uint64_t column = row % 2 == 0 ? k : columns - 1 - k;
      std::uint64_t here = whole + rest * (visited + 1) / total - rest * visited / total;
      for (; here > 0; --here) {
        const Vec2f unit = Rng(seed, stream_id("sph_blue_noise coarse cells"), positions.size()).uniform2();
        const double x = (static_cast<double>(column) + double{unit.x}) * cell_width;
        const double y = (static_cast<double>(row) + double{unit.y}) * cell_height;
        positions.push_back({std::min(static_cast<float>(x), right), std::min(static_cast<float>(y), bottom)});
      }
    }
  }
  return positions;
}

const StrategyInfo SphBlueNoise::info = {
    .name = "sph_blue_noise",
    .family = "blue noise",
    .summary = "Particles that repel each other like a fluid, relaxed together over the whole plane.",
    .cite = "Jiang et al. 2015, Blue noise sampling using an SPH-based method; Russell 2017 (thesis), 2.5 and 2.6",
    .advice = "The best plain choice where neither axis nor scale of the image is special; the start of sph_adaptive.",
    .density = true,
    .solver = true,
};

std::vector<Field<SphBlueNoise::Params>> SphBlueNoise::fields() {
  using P = Params;
  return {
      {"delta", &P::delta, "density difference relative to the mean density: smaller is stiffer", 0.01, 1e6},
      choice_field<P>("kernel", &P::kernel, "smoothing kernel; poly6_spiky is the thesis'",
                      {"wendland", "poly6_spiky", "cubic"}),
      choice_field<P>("boundary", &P::boundary,
                      "opposite sides joined, or walls with fixed ghost particles behind them", {"periodic", "ghost"}),
      {"start", &P::start,
       "first positions: coarse_cells (white inside cells of 16), white, sobol_owen, jitter, file:PATH"},
      {"iterations", &P::iterations, "iterations, at most", 0, 1000000},
      {"support_radius", &P::support_radius, "support radius of the kernel [spacings]", 1.0, 8.0},
      {"step", &P::step, "force times this is added to the velocity; above 2 unstable [spacings]", 0.0, 10.0},
      {"adaptive_step", &P::adaptive_step, "a step of at most 4 delta, reduced while the particles do not calm down"},
      {"damping", &P::damping, "share of the velocity that survives an iteration", 0.0, 0.99},
      {"velocity_cap", &P::velocity_cap, "largest move in an iteration [spacings]", 1e-6, 10.0},
      {"tolerance", &P::tolerance, "stop early when the move is below [spacings]; 0 = never stop early", 0.0, 1.0},
      choice_field<P>("criterion", &P::criterion, "whose move: the mean one, or that of every particle (thesis)",
                      {"mean", "every"}),
      {"classes", &P::classes, "sets that are blue alone and together, emitted one after the other", 1, 64},
      {"least_density", &P::least_density, "with a density: its floor, relative to its maximum (eq. 2.22)", 1e-6, 1.0},
      {"gradient_limit", &P::gradient_limit, "with a density: largest slope of the local spacing", 0.01, 100.0},
      {"background", &P::background, "with a density: subtract the mean-field force; without it the density is missed"},
      choice_field<P>("search", &P::search,
                      "thesis_cells looks into 3x3 cells of the smallest support only: fig. 2.3's mistake",
                      {"exact", "thesis_cells"}),
  };
}

SphBlueNoise::SphBlueNoise(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  if (task.budget < 1 || task.budget > std::numeric_limits<std::uint32_t>::max()) {
    throw ConfigError("sph_blue_noise: budget " + std::to_string(task.budget) +
                      " is not possible; ask for 1 to 4294967295 samples");
  }
  if (params.search == "thesis_cells" && task.budget > most_for_twin) {
    throw ConfigError("sph_blue_noise: search = thesis_cells runs on the slow reference engine; ask for at most " +
                      std::to_string(most_for_twin) + " samples, not " + std::to_string(task.budget));
  }
  if (params.classes > 1 && (params.boundary == "ghost" || task.density)) {
    throw ConfigError("sph_blue_noise: classes = " + std::to_string(params.classes) +
                      " goes only with boundary = periodic and without a density");
  }
  const std::vector<std::string> starts = {"coarse_cells", "white", "sobol_owen", "jitter"};
  if (params.start.starts_with("file:")) {
    const std::string path = params.start.substr(5);
    start_file_ = scale_to_plane(read_points(path), task.plane, path).position;
    if (start_file_.size() != task.budget) {
      throw ConfigError("sph_blue_noise: start = " + params.start + " holds " + std::to_string(start_file_.size()) +
                        " points; ask for that many samples, not " + std::to_string(task.budget));
    }
  } else if (std::find(starts.begin(), starts.end(), params.start) == starts.end()) {
    throw ConfigError("sph_blue_noise: start = " + params.start +
                      "; known: coarse_cells white sobol_owen jitter file:PATH");
  }
  if (task.density) size_ = size_of_density(*task.density, params.least_density);
}

std::vector<Vec2f> SphBlueNoise::start() const {
  const Extent plane = task_.plane;
  if (!start_file_.empty()) return start_file_;
  if (task_.density) {
    if (params_.start == "coarse_cells" || params_.start == "white") {
      // From the field as the engine will prepare it: where its gradient is limited, the raw one would have to be
      // mended over distances that particles do not travel.
      sph::FieldOptions options;
      const double spacing = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(task_.budget));
      options.length_x = plane.width / spacing;
      options.length_y = plane.height / spacing;
      options.count = static_cast<double>(task_.budget);
      options.support = params_.support_radius;
      options.gradient_limit = params_.gradient_limit;
      options.background = false;
      const sph::SizeField field = sph::prepare_size_field(size_, options);
      const auto density = [&](double u, double v) {
        if (field.uniform) return 1.0;
        const sph::BilinearPlace<double> place(field.width, field.height, u * field.width, v * field.height);
        const double s = sph::sample_size(field.view<double>(), place).size;
        return 1 / (s * s);
      };
      const double per_cell = params_.start == "white" ? static_cast<double>(task_.budget) : 16;
      const double aspect = static_cast<double>(plane.width) / plane.height;
      return to_pixels(sph::draw_by_density(density, aspect, task_.budget, task_.seed, per_cell), plane);
    }
    // The other starts are uniform: bend them to the density.
    const DensityWarp warp(*task_.density);
    std::vector<Vec2f> positions = relaxation_start(params_.start, {1, 1}, task_.budget, task_.seed);
    for (Vec2f& p : positions) p = to_plane(warp(p), plane);
    return positions;
  }
  if (params_.start == "coarse_cells") return coarse_cell_positions(plane, task_.budget, task_.seed);
  return relaxation_start(params_.start, plane, task_.budget, task_.seed);
}

void SphBlueNoise::relax() {
  const std::vector<Vec2f> first = start();
  sph::Setup setup;
  setup.plane = task_.plane;
  setup.positions = first;
  std::vector<std::uint8_t> labels;
  for (std::size_t i = 0; params_.classes > 1 && i < first.size(); ++i) {
    labels.push_back(static_cast<std::uint8_t>(i % static_cast<std::size_t>(params_.classes)));
  }
  setup.classes = labels;
  setup.kernel = choice<sph::Kernel>(params_.kernel, {"wendland", "poly6_spiky", "cubic"});
  setup.boundary = choice<sph::Boundary>(params_.boundary, {"periodic", "ghost"});
  setup.support_radius = static_cast<float>(params_.support_radius);
  setup.stiffness_ratio = static_cast<float>(params_.delta);
  setup.step = static_cast<float>(params_.step);
  setup.adaptive_step = params_.adaptive_step;
  setup.damping = static_cast<float>(params_.damping);
  setup.velocity_cap = static_cast<float>(params_.velocity_cap);
  if (params_.tolerance > 0) setup.tolerance = static_cast<float>(params_.tolerance);
  setup.criterion = choice<sph::Criterion>(params_.criterion, {"mean", "every"});
  setup.gradient_limit = static_cast<float>(params_.gradient_limit);
  setup.background = params_.background;
  setup.thesis_cells = params_.search == "thesis_cells";
  setup.seed = task_.seed;
  const std::unique_ptr<sph::Solver> solver = setup.thesis_cells ? sph::make_twin_solver(setup)
                                              : task_.solver     ? task_.solver(setup)
                                                                 : sph::make_cpu_solver(setup);
  if (task_.density) solver->set_size_field(size_);
  report_ = solver->relax(params_.iterations, params_.tolerance > 0);
  backend_ = solver->backend();
  const auto ring = solver->ghosts();
  ghosts_.assign(ring.begin(), ring.end());
  const auto relaxed = solver->positions();
  const auto classes = static_cast<std::size_t>(params_.classes);
  classes_.resize(classes);
  for (std::size_t c = 0; c < classes; ++c) {
    std::vector<Vec2f> members;
    for (std::size_t i = c; i < relaxed.size(); i += classes) members.push_back(relaxed[i]);
    classes_[c].assign(members, task_.plane);
  }
}

SampleBatch SphBlueNoise::next(const Feedback&) {
  if (classes_.empty()) relax();
  for (; class_at_ < classes_.size(); ++class_at_) {
    const SampleBatch batch = classes_[class_at_].next();
    if (!batch.empty()) return batch;
  }
  return {};
}

std::vector<Diagnostic> SphBlueNoise::diagnostics() const {
  if (classes_.empty()) return {};
  Diagnostic dropped{"non_finite", static_cast<double>(report_.non_finite)};
  if (report_.non_finite > 0) {
    dropped.text = "steps of particles were not finite and were dropped; a larger delta or a smaller step is stable";
    dropped.warning = true;
  }
  Diagnostic moving{"mean_displacement", report_.mean_displacement};
  if (report_.steps >= 10 && report_.mean_displacement > 0.1) {
    moving.text = "the particles still move by more than a tenth of a spacing; a smaller step or damping is stable";
    moving.warning = true;
  }
  Diagnostic reductions{"step_reductions", static_cast<double>(report_.step_reductions)};
  if (report_.step_reductions > 0) {
    reductions.text = "the step was reduced because the particles did not calm down; ask for a smaller one";
  }
  return {
      {"iterations", static_cast<double>(report_.steps)},
      moving,
      {"max_displacement", report_.max_displacement},
      {"mean_converged_at", static_cast<double>(report_.mean_converged_at)},
      {"every_converged_at", static_cast<double>(report_.every_converged_at)},
      {"mean_density", report_.mean_density},
      {"converged", report_.converged ? 1.0 : 0.0},
      reductions,
      dropped,
      {"ghosts", static_cast<double>(ghosts_.size())},
      {"backend", 0, backend_},
  };
}

}  // namespace abn
