// Speed of the filtered truth against that of the box, of sample sharing against the plain mean, and of drawing from a
// filter by its inverse. Answers are checked before they are timed; compare rows of one run with each other only.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "harness/film.h"
#include "harness/filtered_truth.h"
#include "harness/sample_sharing.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

constexpr Extent plane{200, 200};
const std::vector<std::string> kinds = {"box", "triangle", "gaussian", "mitchell", "lanczos", "gaussian:support=disc"};

std::string kind(const benchmark::State& state) { return kinds[static_cast<std::size_t>(state.range(0))]; }

const Image& source() {
  static const Image image = [] {
    Image noise({3000, 3000}, 3);
    Rng rng(1, stream_id("filtered_bench"));
    for (float& texel : noise.texels) texel = rng.uniform();
    return noise;
  }();
  return image;
}

/// Its mean and variance must be what a filter of noise has: variance 1/12 times the sum of squared weights.
bool plausible(const Image& truth, const PixelFilter& filter) {
  double sum = 0;
  double squares = 0;
  for (const float value : truth.texels) {
    sum += double{value} - 0.5;
    squares += std::pow(double{value} - 0.5, 2);
  }
  const auto count = static_cast<double>(truth.texels.size());
  double energy = 0;  // integral of f^2
  constexpr int steps = 300;
  const double step = 2 * filter.radius() / steps;
  for (int y = 0; y < steps; ++y) {
    for (int x = 0; x < steps; ++x) {
      energy += std::pow(filter.value((x + 0.5) * step - filter.radius(), (y + 0.5) * step - filter.radius()), 2);
    }
  }
  energy *= step * step;
  const double expected = energy / 12 / (15.0 * 15.0);
  return std::abs(sum / count) < 1e-3 && std::abs(squares / count / expected - 1) < 0.05;
}

void exact_box(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(exact_truth(source(), plane));
}
BENCHMARK(exact_box)->UseRealTime()->Unit(benchmark::kMillisecond);

void truth_of(benchmark::State& state) {
  const auto filter = make_filter(kind(state));
  const auto interpolation = state.range(1) != 0 ? Interpolation::bilinear : Interpolation::nearest;
  if (!plausible(filtered_truth(source(), plane, *filter).image, *filter)) {
    state.SkipWithError("wrong truth");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(filtered_truth(source(), plane, *filter, interpolation));
  state.SetLabel(filter->words());
}
BENCHMARK(truth_of)
    ->ArgNames({"filter", "bilinear"})
    ->ArgsProduct({{0, 1, 2, 3, 4}, {0, 1}})
    ->Args({5, 0})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// 16 random samples per pixel.
const Film& film() {
  static const Film full = [] {
    Rng rng(1, stream_id("filtered_bench"));
    std::vector<Vec2f> position;
    for (std::uint32_t i = 0; i < 16 * plane.area(); ++i) {
      const std::uint32_t pixel = i / 16;
      position.push_back(to_pixel(rng.uniform2(), pixel % plane.width, pixel / plane.width));
    }
    std::vector<float> values(3 * position.size());
    for (float& value : values) value = rng.uniform();
    Film made(plane, 3, true);
    made.add({.position = position}, values);
    return made;
  }();
  return full;
}

void plain_mean(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(film().develop());
}
BENCHMARK(plain_mean)->UseRealTime()->Unit(benchmark::kMillisecond);

void sharing(benchmark::State& state) {
  const auto filter = make_filter(kind(state));
  const Image box = share_samples(film(), *make_filter("box")).image;
  const Image mean = film().develop().image;
  for (std::size_t i = 0; i < mean.texels.size(); ++i) {
    if (std::abs(box.texels[i] - mean.texels[i]) > 1e-6F) {
      state.SkipWithError("the box is not the mean");
      return;
    }
  }
  for (auto _ : state) benchmark::DoNotOptimize(share_samples(film(), *filter));
  state.SetLabel(filter->words());
}
BENCHMARK(sharing)->ArgName("filter")->DenseRange(0, 5)->UseRealTime()->Unit(benchmark::kMillisecond);

void inverse(benchmark::State& state) {
  const auto filter = make_filter(kind(state));
  constexpr int count = 1 << 16;
  std::vector<double> u(count);
  Rng rng(1, stream_id("filtered_bench"));
  for (double& value : u) {
    value = double{rng.uniform()};
    if (std::abs(filter->integral(filter->inverse(value)) - value) > 1e-8) {
      state.SkipWithError("not the inverse");
      return;
    }
  }
  for (auto _ : state) {
    double sum = 0;
    for (const double value : u) sum += filter->inverse(value);
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * count);
  state.SetLabel(filter->words());
}
BENCHMARK(inverse)->ArgName("filter")->DenseRange(0, 2)->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace abn::harness
