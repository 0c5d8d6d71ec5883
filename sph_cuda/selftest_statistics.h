// The part of abn_selftest that compares what sets are worth: spectrum, spacing and the error of a picture, over seeds.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include "sampling/kriging/pixel_estimates.h"
#include "sampling/rng.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"
#include "sph_cuda/selftest_engine.h"
#include "sph_cuda/test_downscale.h"

namespace abn::sph_cuda {

/// Mean of the periodogram |sum exp(-2 pi i k x)|^2 / N over `count` frequencies whose length lies between two shares
/// of sqrt(N) per side of a square plane; 1 for white noise.
inline double power_between(const std::vector<Vec2f>& points, Extent plane, double from, double to, int count) {
  const double n = std::sqrt(static_cast<double>(points.size()));
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    Rng rng(11, 12, static_cast<std::uint64_t>(k));
    const double radius = n * (from + (to - from) * double{rng.uniform()});
    const double angle = std::numbers::pi * double{rng.uniform()};
    const double u = std::round(radius * std::cos(angle)) / plane.width;
    const double v = std::round(radius * std::sin(angle)) / plane.height;
    double real = 0;
    double imaginary = 0;
    for (const Vec2f p : points) {
      const double phase = 2 * std::numbers::pi * (u * double{p.x} + v * double{p.y});
      real += std::cos(phase);
      imaginary += std::sin(phase);
    }
    sum += (real * real + imaginary * imaginary) / static_cast<double>(points.size());
  }
  return sum / count;
}

/// Root mean square error of the pixels' means of shade()'s first channel; `truth` [plane].
inline double picture_error(const std::vector<Vec2f>& points, Extent plane, const std::vector<double>& truth) {
  std::vector<double> sum(truth.size(), 0);
  std::vector<double> count(truth.size(), 0);
  for (const Vec2f p : points) {
    float rgb[3];
    shade(p, plane, rgb);
    const std::size_t pixel = static_cast<std::size_t>(p.y) * plane.width + static_cast<std::size_t>(p.x);
    sum[pixel] += double{rgb[0]};
    count[pixel] += 1;
  }
  double squares = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double error = (count[i] > 0 ? sum[i] / count[i] : 0.5) - truth[i];
    squares += error * error;
  }
  return std::sqrt(squares / static_cast<double>(truth.size()));
}

/// The pixels' means by 32 x 32 points each.
inline std::vector<double> picture_truth(Extent plane) {
  constexpr std::uint32_t side = 32;
  std::vector<double> truth;
  for (std::uint32_t y = 0; y < plane.height; ++y) {
    for (std::uint32_t x = 0; x < plane.width; ++x) {
      double sum = 0;
      for (std::uint32_t k = 0; k < side * side; ++k) {
        float rgb[3];
        shade({static_cast<float>(x + (k % side + 0.5) / side), static_cast<float>(y + (k / side + 0.5) / side)}, plane,
              rgb);
        sum += double{rgb[0]};
      }
      truth.push_back(sum / (side * side));
    }
  }
  return truth;
}

/// Differences of pairs: their mean lies within `allowed` of 0, or 0 within their 95 % interval.
inline bool report_pairs(const char* name, const std::vector<double>& host, const std::vector<double>& device,
                         double allowed) {
  const auto n = static_cast<double>(host.size());
  double mean = 0;
  double of_host = 0;
  for (std::size_t i = 0; i < host.size(); ++i) {
    mean += (device[i] - host[i]) / n;
    of_host += host[i] / n;
  }
  double squares = 0;
  for (std::size_t i = 0; i < host.size(); ++i) {
    const double deviation = device[i] - host[i] - mean;
    squares += deviation * deviation;
  }
  const double student = 1.96 + 2.55 / (n - 1);  // 2.094 for 20 pairs
  const double half = student * std::sqrt(squares / (n - 1) / n);
  const bool good = std::isfinite(mean) && std::fabs(mean) <= std::fmax(half, allowed * of_host);
  std::printf("%s %-32s host %.5f, device - host %+.2e +- %.1e\n", good ? "ok    " : "FAILED", name, of_host, mean,
              half);
  return good;
}

/// `seeds` sets of both engines, relaxed from the same starts, six particles per pixel.
inline bool run_statistics(const sph::SolverFactory& on_host, const sph::SolverFactory& on_device,
                           std::uint64_t seeds = 20, Extent plane = {41, 41}) {
  const std::vector<double> truth = picture_truth(plane);
  struct Statistics {
    std::vector<double> low, peak, nearest, error;
  } of[2];
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const std::vector<Vec2f> start = sph::white_positions(plane, 6 * plane.area(), seed);
    for (int side = 0; side < 2; ++side) {
      const auto solver = (side == 0 ? on_host : on_device)(sph::setup_of(plane, start));
      solver->relax(100, true);
      const std::vector<Vec2f> set = copy_of(solver->positions());
      of[side].low.push_back(power_between(set, plane, 0.05, 0.5, 60));
      of[side].peak.push_back(power_between(set, plane, 1.0, 1.2, 60));
      of[side].nearest.push_back(mean_nearest(set, plane));
      of[side].error.push_back(picture_error(set, plane, truth));
    }
  }
  bool good = report_pairs("sets, power at low frequencies", of[0].low, of[1].low, 0.01);
  good &= report_pairs("sets, power at the peak", of[0].peak, of[1].peak, 0.01);
  good &= report_pairs("sets, nearest neighbours", of[0].nearest, of[1].nearest, 0.002);
  good &= report_pairs("sets, error of a picture", of[0].error, of[1].error, 0.01);
  return good;
}

/// `seeds` adaptive downscales of both, from the same bases; the device's again, for equality.
inline bool run_adaptive_tests(const AdaptivePlaneFactory& on_host, const AdaptivePlaneFactory& on_device,
                               std::uint64_t seeds = 20, Extent plane = {64, 64}) {
  AdaptivePlaneOptions options;
  options.plane = plane;
  options.map = {2 * plane.width, 2 * plane.height};
  options.floor = 0.02;
  options.delta = INFINITY;
  const std::uint64_t budget = 6 * options.plane.area();
  const std::vector<double> truth = picture_truth(options.plane);
  std::vector<double> share[2], edges[2], error[2];
  std::uint64_t equal = 0;
  bool repeats = true;
  for (options.seed = 1; options.seed <= seeds; ++options.seed) {
    const std::vector<Vec2f> base = jittered_base(options.plane, budget / 4, options.seed);
    const Downscale runs[] = {run_downscale(on_host, options, base, budget),
                              run_downscale(on_device, options, base, budget)};
    for (int side = 0; side < 2; ++side) {
      share[side].push_back(runs[side].uniform_share);
      edges[side].push_back(runs[side].straight_edge_share);
      error[side].push_back(picture_error(runs[side].position, options.plane, truth));
    }
    for (std::size_t i = 0; i < budget; ++i) equal += runs[0].position[i] == runs[1].position[i] ? 1 : 0;
    repeats &= run_downscale(on_device, options, base, budget).position == runs[1].position;
  }
  bool good = report_pairs("downscales, uniform share", share[0], share[1], 1e-6);
  good &= report_pairs("downscales, straight edges", edges[0], edges[1], 0.01);
  good &= report_pairs("downscales, error of the means", error[0], error[1], 0.01);
  std::printf("%s downscales, again on the device: %s; %.2f %% of the samples are the host's bit for bit\n",
              repeats ? "ok    " : "FAILED", repeats ? "equal bit for bit" : "DIFFER",
              100 * static_cast<double>(equal) / static_cast<double>(seeds * budget));
  return good && repeats;
}

/// The pictures of one adaptive downscale, with steps and without: within 1e-4 of the picture's range but for pixels in
/// which the sides find another step, at most one in a thousand.
inline bool run_picture_tests(const SampleEstimator& on_host, const SampleEstimator& on_device,
                              Extent plane = {64, 64}) {
  AdaptivePlaneOptions options;
  options.plane = plane;
  options.map = {2 * plane.width, 2 * plane.height};
  options.floor = 0.02;
  options.delta = INFINITY;
  const std::uint64_t budget = 6 * plane.area();
  const Downscale run = run_downscale([](const AdaptivePlaneOptions& o) { return make_adaptive_plane(o); }, options,
                                      jittered_base(plane, budget / 4, 1), budget);
  const std::vector<float> weight(run.position.size(), 1.0F);
  bool good = true;
  for (const bool steps : {false, true}) {
    const PixelEstimates host = on_host(run.position, run.value, weight, 3, plane, steps);
    const PixelEstimates device = on_device(run.position, run.value, weight, 3, plane, steps);
    std::uint64_t far = 0;
    std::uint64_t different = 0;
    for (std::size_t i = 0; i < host.value.size(); ++i) {
      far += std::fabs(double{host.value[i]} - double{device.value[i]}) <= 1e-4 ? 0 : 1;
      different += host.value[i] == device.value[i] ? 0 : 1;
    }
    const bool close = device.value.size() == host.value.size() && far * 1000 <= host.value.size();
    std::printf("%s picture by %-23s %llu of %llu values not equal bit for bit, %llu farther than 1e-4\n",
                close ? "ok    " : "FAILED", steps ? "edge" : "kriging", static_cast<unsigned long long>(different),
                static_cast<unsigned long long>(host.value.size()), static_cast<unsigned long long>(far));
    good &= close;
  }
  return good;
}

}  // namespace abn::sph_cuda
