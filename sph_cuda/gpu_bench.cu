// abn_gpu_bench: how long the SPH engine takes on this machine's GPU, and beside it on its CPU.
//
// Prints a page of Markdown: cold start, then warm medians with quartiles; copies apart; a step by kernel against the
// floor of its memory traffic. Exit status: 0, 1 a CUDA error, 77 no device.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"
#include "sph_cuda/adaptive_plane.h"
#include "sph_cuda/check.h"
#include "sph_cuda/device.h"
#include "sph_cuda/engine.h"
#include "sph_cuda/kriging.h"
#include "sph_cuda/profiling_device.h"
#include "sph_cuda/solver.h"
#include "sph_cuda/test_downscale.h"

namespace abn::sph_cuda {
namespace {

constexpr int repeats = 15;

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Quartiles {
  double low = 0, median = 0, high = 0;
};
Quartiles quartiles_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return {at(0.25), at(0.5), at(0.75)};
}
void print_row(const std::string& what, const std::vector<double>& times, double per = 1) {
  const Quartiles q = quartiles_of(times);
  std::printf("| %s | %.3f | %.3f – %.3f |\n", what.c_str(), q.median / per, q.low / per, q.high / per);
}

struct Plane {
  Extent extent;
  std::vector<Vec2f> positions;
  Grid<float> field;  // empty = uniform
  sph::Setup setup() const {
    auto made = sph::setup_of(extent, positions);
    if (field.size().area() > 0) made.size_field = &field;
    return made;
  }
};
Plane plane_of(std::uint64_t particles, double ratio = 1) {
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(particles) / 6)));
  Plane plane{{side, side}, {}, {}};
  if (ratio > 1) plane.field = sph::smooth_size_field({256, 256}, ratio);
  plane.positions = ratio > 1 ? sph::drawn_positions(plane.extent, plane.field, particles)
                              : sph::white_positions(plane.extent, particles);
  return plane;
}

/// `count` times: an engine made anew, then `timed` on it.
std::vector<double> times_of(const Plane& plane, const sph::SolverFactory& make, int count,
                             const std::function<void(sph::Solver&)>& timed) {
  std::vector<double> times;
  for (int k = 0; k < count; ++k) {
    const auto solver = make(plane.setup());
    solver->relax(1, false);  // the first launch of every kernel loads it
    const double begin = now_ms();
    timed(*solver);
    times.push_back(now_ms() - begin);
  }
  return times;
}

/// What a step of a particle takes at least: reckoned, not counted, as 19 us for 240 000 on an H200.
constexpr double instructions_per_particle = 2650;

/// How long a device that issues an instruction for 128 threads per multiprocessor and cycle takes for a step.
double issue_us(double particles) {
  int processors = 0;
  int kilohertz = 0;
  check(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, 0), "cudaDeviceGetAttribute");
  check(cudaDeviceGetAttribute(&kilohertz, cudaDevAttrClockRate, 0), "cudaDeviceGetAttribute");
  return particles * instructions_per_particle / (processors * 128.0 * kilohertz * 1e-3);
}

void by_kernel(const Plane& plane, const std::string& title) {
  constexpr int steps = 20;
  DeviceSolver<ProfilingDevice> solver(plane.setup());
  solver.relax(2, false);
  kernel_times().clear();
  solver.relax(steps, false);
  const double n = static_cast<double>(plane.positions.size());
  std::printf(
      "\n%s, by kernel (timed one by one: launch latency included)\n\n| kernel | launches per step | us per step | "
      "ns per particle |\n|---|---|---|---|\n",
      title.c_str());
  double total = 0;
  double launches = 0;
  for (const auto& [kernel, time] : kernel_times()) {
    const double us = time.milliseconds * 1e3 / steps;
    total += us;
    launches += static_cast<double>(time.launches);
    std::printf("| %s | %.0f | %.2f | %.3f |\n", kernel.c_str(), static_cast<double>(time.launches) / steps, us,
                us * 1e3 / n);
  }
  std::printf("| all | | %.2f | %.3f |\n", total, total * 1e3 / n);
  std::printf("| floor: a launch 1 us, and %.0f instructions per particle | %.0f | %.2f | %.3f |\n",
              instructions_per_particle, launches / steps, launches / steps + issue_us(n), issue_us(n) * 1e3 / n);
}

/// The passes of an adaptive downscale of 200 x 200 at six samples per pixel, stage by stage.
void adaptive_downscale() {
  AdaptivePlaneOptions options;
  options.plane = {200, 200};
  options.map = {400, 400};
  options.floor = 0.02;
  options.delta = INFINITY;
  const std::uint64_t budget = 240000;
  const std::vector<Vec2f> base = jittered_base(options.plane, budget / 4, 1);
  const AdaptivePlaneFactory on_host = [](const AdaptivePlaneOptions& o) { return make_adaptive_plane(o); };
  const AdaptivePlaneFactory on_device = make_cuda_adaptive_plane_factory();
  std::printf(
      "\nThe passes of an adaptive downscale, 240 000 samples, 200 × 200 pixels; without the plane to begin with (it\n"
      "comes from the disk cache) and evaluation. The samples go to the host and their values back: "
      "included.\n"
      "\n| stage | GPU, ms | quartiles | this machine's CPU, ms |\n|---|---|---|---|\n");
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> gpu;
  std::map<std::string, std::vector<double>> cpu;
  const auto note = [&](std::map<std::string, std::vector<double>>& times, const Downscale& done) {
    std::map<std::string, double> once;
    for (const DownscaleStage& stage : done.stages) {
      if (std::find(names.begin(), names.end(), stage.name) == names.end()) names.push_back(stage.name);
      once[stage.name] += stage.milliseconds;
      if (stage.name != "evaluate") once["all but evaluation"] += stage.milliseconds;
    }
    for (const auto& [name, time] : once) times[name].push_back(time);
  };
  const SampleEstimator estimate = make_cuda_estimator();
  const std::vector<float> weight(budget, 1.0F);
  for (int k = -3; k < repeats; ++k) {  // the first ones load kernels and take memory
    Downscale done = run_downscale(on_device, options, base, budget);
    const double begin = now_ms();
    estimate(done.position, done.value, weight, 3, options.plane, true);
    done.stages.push_back({"picture (edge)", now_ms() - begin});
    if (k >= 0) note(gpu, done);
  }
  for (int k = 0; k < 3; ++k) note(cpu, run_downscale(on_host, options, base, budget));
  names.push_back("all but evaluation");
  for (const std::string& name : names) {
    const Quartiles q = quartiles_of(gpu[name]);
    std::printf("| %s | %.3f | %.3f – %.3f |", name.c_str(), q.median, q.low, q.high);
    if (cpu.count(name) > 0) std::printf(" %.1f |\n", quartiles_of(cpu[name]).median);
    if (cpu.count(name) == 0) std::printf(" (only in `abn downscale`) |\n");
  }
}

void run(const std::string& revision, const std::string& command) {
  const std::time_t now = std::time(nullptr);
  char date[32];
  std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
  std::printf("# SPH engine on the GPU\n\n%s. %s, revision %s. `%s`\n\n", describe_devices().c_str(), date,
              revision.c_str(), command.c_str());

  const Plane small = plane_of(240000);
  const double begin = now_ms();
  make_cuda_solver(small.setup())->relax(1, false);
  std::printf("Cold start (context, loading of kernels, first engine and step): %.1f ms.\n\n", now_ms() - begin);

  std::printf("| warm, medians of %d | ms | quartiles |\n|---|---|---|\n", repeats);
  print_row("240 000 × 150 steps", times_of(small, make_cuda_solver, repeats, [](auto& s) { s.relax(150, false); }));
  print_row("240 000 to convergence (mean < .01 d)",
            times_of(small, make_cuda_solver, repeats, [](auto& s) { s.relax(1000, true); }));
  std::vector<double> making;
  for (int k = 0; k < repeats; ++k) {
    const double start = now_ms();
    make_cuda_solver(small.setup())->evaluate();
    making.push_back(now_ms() - start);
  }
  print_row("240 000: engine made, positions to the device, one evaluation back", making);
  print_row("240 000: positions to the host",
            times_of(small, make_cuda_solver, repeats, [](auto& s) { static_cast<void>(s.positions()); }));
  const Plane sized = plane_of(240000, 10);
  print_row("240 000, size field 1:10, per step of 150",
            times_of(sized, make_cuda_solver, repeats, [](auto& s) { s.relax(150, false); }), 150);
  for (const std::uint64_t particles : {std::uint64_t{1000000}, std::uint64_t{10000000}}) {
    const Plane plane = plane_of(particles);
    print_row(std::to_string(particles) + ", per step of 64",
              times_of(plane, make_cuda_solver, 5, [](auto& s) { s.relax(64, false); }), 64);
  }
  print_row("this machine's CPU: 240 000, per step of 20",
            times_of(small, sph::make_cpu_solver, 3, [](auto& s) { s.relax(20, false); }), 20);
  print_row("this machine's CPU: 240 000, size field 1:10, per step of 20",
            times_of(sized, sph::make_cpu_solver, 3, [](auto& s) { s.relax(20, false); }), 20);
  adaptive_downscale();
  by_kernel(small, "240 000 uniform");
  by_kernel(sized, "240 000 in a size field 1:10");
  by_kernel(plane_of(10000000), "10 000 000 uniform");
}

}  // namespace
}  // namespace abn::sph_cuda

int main(int count, char** words) {
  try {
    if (abn::sph_cuda::list_devices().empty()) {
      std::printf("abn_gpu_bench: no CUDA device here; nothing was timed\n");
      return 77;
    }
    std::string command;
    for (int k = 0; k < count; ++k) {
      if (k > 0) command += ' ';
      command += words[k];
    }
    abn::sph_cuda::run(count > 1 ? words[1] : "not given", command);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "abn_gpu_bench: %s\n", error.what());
    return 1;
  }
}
