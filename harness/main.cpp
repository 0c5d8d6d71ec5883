// The command line: words to option structs, exceptions to exit codes. The only file that includes CLI11.
#include <fmt/format.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <new>
#include <stdexcept>
#include <system_error>

#include "harness/progress.h"
#include "harness/verbs.h"
#include "sampling/error.h"

namespace {

using namespace abn::harness;

struct Verb {
  CLI::App* command;
  std::function<int()> action;
};

/// A whole number in [lo, hi] as it was typed: CLI11 by itself would wrap -1 and clamp 2^64.
CLI::Validator whole(std::uint64_t lo, std::uint64_t hi) {
  const auto check = [lo, hi](const std::string& word) -> std::string {
    std::uint64_t value = 0;
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc{} && rest == end && value >= lo && value <= hi) return {};
    return fmt::format("'{}' is no whole number from {} to {}", word, lo, hi);
  };
  return {check, ""};
}

/// A finite number, and greater than 0 if `positive`.
CLI::Validator finite(bool positive) {
  const auto check = [positive](const std::string& word) -> std::string {
    double value = 0;
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc{} && rest == end && std::isfinite(value) && (value > 0 || !positive)) return {};
    return fmt::format("'{}' is no number{}", word, positive ? " > 0" : "");
  };
  return {check, ""};
}

/// A number from 0 to 1.
CLI::Validator share() {
  const auto check = [](const std::string& word) -> std::string {
    double value = 0;
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc{} && rest == end && value >= 0 && value <= 1) return {};
    return fmt::format("'{}' is no number from 0 to 1", word);
  };
  return {check, ""};
}

/// Not the empty word that an unset variable of a script leaves.
CLI::Validator given() {
  return {[](const std::string& word) { return std::string(word.empty() ? "the value is empty; give one" : ""); }, ""};
}

constexpr std::uint64_t kMaxBudget = std::uint64_t{1} << 36;
constexpr std::uint64_t kMaxSeed = std::numeric_limits<std::uint64_t>::max();

/// Options of every verb. Global flags may stand before or after the verb.
struct CommandLine {
  CLI::App app{
      "abn: which samples, and what do they cost?\nTakes a high-resolution image as the integrand and samples it down "
      "with interchangeable strategies."};
  GlobalOptions global;
  DownscaleOptions downscale;
  RunOptions run;
  PointsOptions points;
  AnalyzeOptions analyze;
  CompareOptions compare;
  TruthOptions truth;
  SceneOptions scene;
  ListOptions list;
  std::vector<Verb> verbs;

  CLI::App* verb(const char* name, const char* summary, const char* example, std::function<int()> action) {
    CLI::App* command = app.add_subcommand(name, summary);
    command->footer(fmt::format("Example:\n  {}\n", example));
    add_global(command);
    verbs.push_back({command, std::move(action)});
    return command;
  }
  std::string verb_names() const {
    std::string names;
    for (const auto& verb : verbs) names += " " + verb.command->get_name();
    return names;
  }
  void add_global(CLI::App* command) {
    command->add_option("--backend", global.backend, "engine of the SPH strategies: cpu, cuda, or auto = a CUDA device if there is one")
        ->capture_default_str();
    command->add_option("--threads", global.threads, "number of threads; 0 = all cores")
        ->check(whole(0, 4096))
        ->capture_default_str();
    command->add_flag("--quiet", global.quiet, "no progress, no notices");
    command->add_flag("--json", global.json, "JSON on stdout and nothing else there");
    command->add_flag("--no-cache", global.no_cache, "never read or write cached stages");
  }

  CommandLine() {
    app.name("abn");
    app.set_version_flag("--version", version_text());
    app.require_subcommand(0, 1);
    add_global(&app);
    app.footer(
        "Every verb has its own --help with an example. First steps:\n  abn run main\n  abn downscale scene:apple "
        "--strategy multijitter --spp 6 -o apple.png\n  abn list strategies\n"
        "Exit codes: 0 success, 1 a comparison differs, 2 wrong words, 3 a file, 4 a device, 130 stopped by Ctrl-C.\n");
    add_downscale();
    add_run();
    add_points();
    add_analyze();
    add_compare();
    add_truth();
    add_scene();
    auto* c = verb("list", "what there is: strategies, scenes, filters, reconstructions, metrics, point_metrics",
                   "abn list strategies jitter", [this] { return abn::harness::list(global, list); });
    c->add_option("KIND", list.kind,
                  "strategies, scenes, filters, reconstructions, metrics or point_metrics; nothing = all names");
    c->add_option("NAME", list.name, "one of them in full: parameters, whom to cite, when to use it");
    verb("info", "version, libraries, processor, data folders", "abn info --json", [this] { return info(global); });
  }

  void add_downscale() {
    auto& o = downscale;
    auto* c =
        verb("downscale", "sample one image down with one strategy; print error and time",
             "abn downscale scene:apple --strategy sph_blue_noise --spp 6 -o apple.exr --error-map apple_error.png",
             [this] { return abn::harness::downscale(global, downscale); });
    c->add_option("IMAGE", o.image, "an image file or scene:NAME")->required();
    c->add_option("--to", o.to, "output size [px]")->capture_default_str();
    c->add_option("--strategy", o.strategy, "abn list strategies; or file:PATH, command:CMD")->required();
    auto* spp = c->add_option("--spp", o.spp, "samples per pixel, default 6; with --target-error at most, default 64")
                    ->check(given());
    c->add_option("--samples", o.samples, "samples in all")->excludes(spp)->check(whole(1, kMaxBudget));
    c->add_option("--target-error", o.target_error,
                  "stop when the estimated RMSE (linear light) reaches this; adaptive strategies only")
        ->check(finite(true));
    c->add_option("--set", o.set, "a parameter of the strategy, KEY=VALUE (repeatable)")->allow_extra_args(false);
    c->add_option("--guide", o.guide,
                  "where samples matter: an image (albedo, edges), or true_variance; for parameters that say so")
        ->check(given());
    c->add_option("--seed", o.seed, "seed of the strategy")->check(whole(0, kMaxSeed))->capture_default_str();
    add_filter(c, o.filter);
    c->add_option("--reconstruction", o.reconstruction, "abn list reconstructions; auto = what the strategy recommends")
        ->capture_default_str();
    c->add_option("--truth", o.truth, "exact, or monte_carlo:SPP")->capture_default_str();
    add_source(c, o.integrand, o.channels, o.on_nonfinite);
    c->add_option("-o,--output", o.output, "write the picture here (.exr linear, .png sRGB, …)")->check(given());
    c->add_option("--error-map", o.error_map,
                  "write the error: .exr signed difference, otherwise |difference| x gain in false colour")
        ->check(given());
    c->add_option("--estimated-error", o.estimated_error,
                  "write the error as estimated without the truth: .exr, otherwise x gain in false colour")
        ->check(given());
    c->add_option("--gain", o.gain, "gain of the error maps")->check(finite(true))->capture_default_str();
    c->add_option("--reliability", o.reliability,
                  "write how true the estimated errors are: a chart of the bins, or their numbers (.csv)")
        ->check(given());
    c->add_option("--points", o.points, "write the samples here, unit square, format by extension as in abn points")
        ->check(given());
    auto* picture = c->add_option("--points-picture", o.points_picture,
                                  "draw the samples here, white on black, ghost particles in blue")
                        ->check(given());
    c->add_option("--points-region", o.points_region,
                  "what of them to draw: LEFT,TOP,RIGHT,BOTTOM [px], default the whole plane")
        ->needs(picture)
        ->check(given());
  }
  void add_run() {
    auto& o = run;
    auto* c = verb("run", "run an experiment: every strategy, scene, budget and seed of a TOML file",
                   "abn run fig_3_2 --seeds 2 --out /tmp/fig_3_2", [this] { return run_verb(global, run); });
    c->add_option("SPEC", o.spec, "a TOML file, or the name of an experiment such as main or fig_4_2")->required();
    c->add_option("--out", o.out, "folder of the results; default results/runs/NAME")->check(given());
    auto* resume = c->add_flag("--resume", o.resume, "go on where an earlier run stopped");
    c->add_flag("--overwrite", o.overwrite, "replace the results in the folder")->excludes(resume);
    c->add_option("--seeds", o.seeds, "number of seeds, instead of the spec's")->check(whole(1, 1000000));
    c->add_option("--set", o.set, "STRATEGY.KEY=VALUE (repeatable)")->allow_extra_args(false);
    c->add_option("--shard", o.shard, "I/N: do only the runs with index I modulo N, I from 0")->check(given());
    c->add_flag("--dry-run", o.dry_run, "check everything, list the runs, do none");
  }
  void add_points() {
    auto& o = points;
    auto* c = verb("points", "write the samples of a strategy on the unit square",
                   "abn points --strategy poisson_disk --count 4096 -o points.txt --format psa",
                   [this] { return abn::harness::points(global, points); });
    c->add_option("--strategy", o.strategy, "abn list strategies")->required();
    c->add_option("--count", o.count, "number of samples")->required()->check(whole(1, kMaxBudget));
    c->add_option("--seed", o.seed, "seed")->check(whole(0, kMaxSeed))->capture_default_str();
    c->add_option("--set", o.set, "a parameter of the strategy, KEY=VALUE (repeatable)")->allow_extra_args(false);
    add_density(c, o.density, o.density_floor);
    add_reading(c, o.channels, o.on_nonfinite);
    c->add_option("--picture", o.picture, "draw the points here, white dots on black: bright where they are many")
        ->check(given());
    c->add_option("--format", o.format, "utk, utk-bin, psa, rps or csv; default by the extension, else utk")
        ->check(given());
    c->add_option("-o,--output", o.output, "file to write")->required()->check(given());
  }
  void add_analyze() {
    auto& o = analyze;
    auto* c = verb("analyze", "spectrum, distances, order, discrepancy and integration error of point sets",
                   "abn analyze --strategy jitter --count 1024 --sets 5 -o /tmp/jitter_analysis",
                   [this] { return abn::harness::analyze(global, analyze); });
    c->add_option("FILE", o.file, "points on the unit square, as abn points writes them; or give --strategy")
        ->check(given());
    c->add_option("--strategy", o.strategy, "draw the points with it: abn list strategies; or command:CMD")
        ->check(given());
    c->add_option("--count", o.count, "points in a set, default 4096")->check(whole(1, kMaxBudget));
    c->add_option("--sets", o.sets, "number of sets, with the seeds from --seed on, default 10")
        ->check(whole(1, 100000));
    c->add_option("--seed", o.seed, "seed of the first set")->check(whole(0, kMaxSeed))->capture_default_str();
    c->add_option("--set", o.set, "a parameter of the strategy, KEY=VALUE (repeatable)")->allow_extra_args(false);
    add_density(c, o.density, o.density_floor);
    add_reading(c, o.channels, o.on_nonfinite);
    c->add_option("--pixels", o.pixels, "grid for the variation of counts")->capture_default_str();
    c->add_option("-o,--output", o.output, "folder for analysis.json and pictures (points, spectrum, radial, …, sheet)")
        ->check(given());
  }
  void add_compare() {
    auto& o = compare;
    auto* c = verb("compare", "metrics between two images",
                   "abn compare apple.exr truth.exr --metric rmse,flip --fail 0.05 --error-map error.png",
                   [this] { return abn::harness::compare(global, compare); });
    c->add_option("TEST", o.test, "image file")->required();
    c->add_option("REFERENCE", o.reference, "image file")->required();
    c->add_option("--metric", o.metrics,
                  "names separated by commas, default all; the first one is what --fail looks at")
        ->delimiter(',')
        ->allow_extra_args(false);
    c->add_option("--error-map", o.error_map, "write the error: .exr signed difference, otherwise false colour")
        ->check(given());
    c->add_option("--gain", o.gain, "gain of the error map")->check(finite(true))->capture_default_str();
    add_reading(c, o.channels, o.on_nonfinite);
    c->add_option("--fail", o.fail, "exit with 1 if the first metric is worse than this")->check(finite(false));
  }
  void add_truth() {
    auto& o = truth;
    auto* c =
        verb("truth", "the exact (or Monte Carlo) picture that strategies are measured against",
             "abn truth scene:apple --to 200x200 -o truth.exr", [this] { return abn::harness::truth(global, truth); });
    c->add_option("IMAGE", o.image, "an image file or scene:NAME")->required();
    c->add_option("--to", o.to, "output size [px]")->capture_default_str();
    add_filter(c, o.filter);
    c->add_option("--truth", o.method, "exact, or monte_carlo:SPP")->capture_default_str();
    add_source(c, o.integrand, o.channels, o.on_nonfinite);
    c->add_option("-o,--output", o.output, "file to write")->required()->check(given());
  }
  void add_scene() {
    auto& o = scene;
    auto* c = verb("scene", "write a scene as an image", "abn scene zone_plate --size 1000 -o zone.png",
                   [this] { return abn::harness::scene(global, scene); });
    c->add_option("NAME", o.name, "abn list scenes")->required();
    c->add_option("--size", o.size, "width and height [px]")->check(whole(1, 65536))->capture_default_str();
    c->add_option("-o,--output", o.output, "file to write")->required()->check(given());
  }
  static void add_filter(CLI::App* c, std::string& filter) {
    c->add_option("--filter", filter, "abn list filters; with parameters as in gaussian:sigma=0.5,radius=1.5")
        ->capture_default_str();
  }
  static void add_source(CLI::App* c, std::string& integrand, std::string& channels, std::string& on_nonfinite) {
    c->add_option("--integrand", integrand,
                  "between texel centres: nearest, bilinear, or analytic (scene:apple_analytic)")
        ->capture_default_str();
    add_reading(c, channels, on_nonfinite);
  }
  static void add_density(CLI::App* c, std::string& density, double& floor) {
    c->add_option(
         "--density", density,
         "density wanted: luminance of an image or scene:NAME (bright = many points), or size:NAME[:RATIO], the "
         "density s^-2 of a spacing s such as smooth, ramp, step or disc")
        ->check(given());
    c->add_option("--density-floor", floor, "raise lower densities to this share of the highest one")
        ->check(share())
        ->capture_default_str();
  }
  static void add_reading(CLI::App* c, std::string& channels, std::string& on_nonfinite) {
    c->add_option("--channels", channels, "channels of the file to use, one or three names or numbers, e.g. R,G,B")
        ->check(given());
    c->add_option("--on-nonfinite", on_nonfinite, "NaN and Inf in the input: refuse, zero or clamp")
        ->capture_default_str();
  }
};

/// One line on stderr, whatever control characters a name in the message holds.
int fail(int code, std::string message) {
  for (char& c : message) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  }
  std::fputs(("abn: " + message + "\n").c_str(), stderr);
  return code;
}

int fail_to_print() { return fail(3, "standard output cannot be written; is the disk full?"); }

int fail_for_memory() { return fail(3, "out of memory; use a smaller image, output size or budget"); }

int fail_to_understand(const CommandLine& line, const CLI::ParseError& error) {
  const auto chosen = line.app.get_subcommands();
  if (!chosen.empty()) return fail(2, fmt::format("{} (abn {} --help)", error.what(), chosen.front()->get_name()));
  const auto words = line.app.remaining();
  if (words.empty() || words.front().starts_with('-')) return fail(2, fmt::format("{} (abn --help)", error.what()));
  return fail(2, fmt::format("there is no verb '{}'; the verbs are{} (abn --help)", words.front(), line.verb_names()));
}

int run_program(int argc, char** argv) {
  CommandLine line;
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return line.app.exit(error);  // --help, --version
    return fail_to_understand(line, error);
  }
  if (line.global.threads > 0) omp_set_num_threads(line.global.threads);
  for (const auto& verb : line.verbs) {
    if (verb.command->parsed()) return verb.action();
  }
  return fail(2, fmt::format("no verb is given; the verbs are{} (abn --help)", line.verb_names()));
}

}  // namespace

int main(int argc, char** argv) {
  install_interrupt_handler();
  try {
    const int code = run_program(argc, argv);
    // A full disk behind `abn … > file` shows only here.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail_to_print();
    return code;
  } catch (const abn::ConfigError& error) {
    return fail(2, error.what());
  } catch (const abn::IoError& error) {
    return fail(3, error.what());
  } catch (const abn::DeviceError& error) {
    return fail(4, error.what());
  } catch (const Interrupted&) {
    return fail(130, "stopped");
  } catch (const std::bad_alloc&) {
    return fail_for_memory();
  } catch (const std::length_error&) {  // a vector larger than the address space
    return fail_for_memory();
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(3, error.what());
  } catch (const std::system_error& error) {  // fmt::print throws it
    return std::ferror(stdout) != 0 ? fail_to_print() : fail(3, error.what());
  }
}
