// Speed of the two passes over the source image: evaluating samples and computing the exact truth. Answers are checked
// before they are timed; compare rows of one run with each other, not with those of another machine.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "harness/film.h"
#include "harness/image_io.h"
#include "harness/integrand.h"
#include "harness/truth.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

constexpr Extent source_size{3000, 3000};
constexpr Extent plane{200, 200};

// Uniform noise: no value is like its neighbours, so that a wrong texel shows.
const Image& source(std::uint32_t channels) {
  static const auto make = [](std::uint32_t count) {
    Image image(source_size, count);
    for (std::size_t i = 0; i < image.texels.size(); i += 4) {
      const Philox4 block = philox4x32({{static_cast<std::uint32_t>(i), 0, 0, 0}}, 1, 2);
      for (std::size_t k = 0; k < 4; ++k) image.texels[i + k] = unit_float(block.word[k]);
    }
    return image;
  };
  static const Image grey = make(1);
  static const Image rgb = make(3);
  return channels == 1 ? grey : rgb;
}

// Runs what follows on `threads` threads.
struct Threads {
  explicit Threads(int threads) : before(omp_get_max_threads()) {
    omp_set_num_threads(threads);
    cv::setNumThreads(threads);
  }
  ~Threads() { omp_set_num_threads(before); }
  int before;
};

enum Order { pixel_order, random_order };

// Samples [begin, begin + count) of `total`, either pixel by pixel or anywhere.
void fill_positions(Order order, std::uint64_t begin, std::uint64_t total, std::vector<Vec2f>& position) {
  for (std::size_t i = 0; i < position.size(); ++i) {
    Rng rng(1, stream_id("harness_bench"), begin + i);
    const Vec2f unit = rng.uniform2();
    const auto pixel = static_cast<std::uint32_t>((begin + i) * plane.area() / total);
    position[i] =
        order == pixel_order ? to_pixel(unit, pixel % plane.width, pixel / plane.width) : to_plane(unit, plane);
  }
}

bool right_texels(const Image& image, const std::vector<Vec2f>& position, const std::vector<float>& values) {
  for (std::size_t i = 0; i < position.size(); ++i) {
    const auto x = static_cast<std::uint32_t>(std::floor(double{position[i].x} * 15));
    const auto y = static_cast<std::uint32_t>(std::floor(double{position[i].y} * 15));
    if (!std::equal(image.texel(x, y), image.texel(x, y) + image.channels, &values[i * image.channels])) return false;
  }
  return true;
}

// Samples as a strategy hands them over, 2^16 a batch; the positions of 40 M samples are prepared outside the clock.
void evaluate(benchmark::State& state) {
  const auto total = static_cast<std::uint64_t>(state.range(0));
  const auto order = static_cast<Order>(state.range(1));
  const auto channels = static_cast<std::uint32_t>(state.range(2));
  const Threads threads(static_cast<int>(state.range(3)));
  const Image& image = source(channels);
  const ImageIntegrand integrand(image, plane, state.range(4) == 0 ? Interpolation::nearest : Interpolation::bilinear);
  std::vector<Vec2f> position(total);
  fill_positions(order, 0, total, position);
  constexpr std::size_t batch = 1 << 16;
  std::vector<float> values(batch * channels);
  if (state.range(4) == 0) {
    std::vector<Vec2f> first(position.begin(), position.begin() + batch);
    integrand.evaluate(first, values);
    if (!right_texels(image, first, values)) {
      state.SkipWithError("wrong texels");
      return;
    }
  }
  for (auto _ : state) {
    for (std::size_t begin = 0; begin < total; begin += batch) {
      const std::size_t count = std::min<std::size_t>(batch, total - begin);
      integrand.evaluate({&position[begin], count}, {values.data(), count * channels});
      benchmark::DoNotOptimize(values.data());
      benchmark::ClobberMemory();
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(total) * state.iterations());
}
BENCHMARK(evaluate)
    ->ArgNames({"samples", "random_order", "channels", "threads", "bilinear"})
    ->Args({240'000, pixel_order, 3, 1, 0})
    ->Args({240'000, random_order, 3, 1, 0})
    ->Args({240'000, pixel_order, 1, 1, 0})
    ->Args({240'000, pixel_order, 3, 1, 1})
    ->Args({240'000, pixel_order, 3, 2, 0})
    ->Args({40'000'000, pixel_order, 3, 1, 0})
    ->Args({40'000'000, random_order, 3, 1, 0})
    ->Args({40'000'000, pixel_order, 3, 2, 0})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void film(benchmark::State& state) {
  const auto order = static_cast<Order>(state.range(0));
  const auto channels = static_cast<std::uint32_t>(state.range(1));
  std::vector<Vec2f> position(240'000);
  fill_positions(order, 0, position.size(), position);
  const ImageIntegrand integrand(source(channels), plane);
  std::vector<float> values(position.size() * channels);
  integrand.evaluate(position, values);
  for (auto _ : state) {
    Film film(plane, channels);
    film.add({.position = position}, values);
    benchmark::DoNotOptimize(film.develop());
  }
}
BENCHMARK(film)
    ->ArgNames({"random_order", "channels"})
    ->ArgsProduct({{pixel_order, random_order}, {1, 3}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// The least that any truth must do: read every texel once.
void read_only_sum(benchmark::State& state) {
  const Image& image = source(3);
  for (auto _ : state) {
    float sum[16] = {};
    const float* texel = image.texels.data();
    for (std::size_t i = 0; i < image.texels.size(); i += 16) {
#pragma omp simd
      for (std::size_t k = 0; k < 16; ++k) sum[k] += texel[i + k];
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(image.texels.size() * sizeof(float)) * state.iterations());
}
BENCHMARK(read_only_sum)->UseRealTime()->Unit(benchmark::kMillisecond);

// The largest difference to sums in long double, relative to the value.
double block_error(const Image& image, const Image& mean) {
  double worst = 0;
  for (std::uint32_t y = 0; y < plane.height; ++y) {
    for (std::uint32_t x = 0; x < plane.width; ++x) {
      for (std::uint32_t c = 0; c < image.channels; ++c) {
        long double sum = 0;
        for (std::uint32_t v = 0; v < 15; ++v) {
          for (std::uint32_t u = 0; u < 15; ++u) sum += image.texel(15 * x + u, 15 * y + v)[c];
        }
        sum /= 225;
        worst = std::max(worst, static_cast<double>(std::abs((mean.texel(x, y)[c] - sum) / sum)));
      }
    }
  }
  return worst;
}

void truth_whole_ratio(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(0)));
  const double error = block_error(source(3), exact_truth(source(3), plane).image);
  state.counters["relative_error"] = error;
  if (error > 1e-7) state.SkipWithError("inexact");
  for (auto _ : state) benchmark::DoNotOptimize(exact_truth(source(3), plane));
}
BENCHMARK(truth_whole_ratio)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

// The same answer by weights, and a ratio that has no other way.
void truth_weighted(benchmark::State& state) {
  const Threads threads(1);
  const auto to = static_cast<std::uint32_t>(state.range(0));
  const auto interpolation = state.range(1) == 0 ? Interpolation::nearest : Interpolation::bilinear;
  for (auto _ : state) benchmark::DoNotOptimize(detail::weighted_mean(source(3), {to, to}, interpolation));
}
BENCHMARK(truth_weighted)
    ->ArgNames({"to", "bilinear"})
    ->Args({200, 0})
    ->Args({199, 0})
    ->Args({200, 1})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void opencv_inter_area(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(0)));
  Image mean(plane, 3);
  const cv::Mat from(3000, 3000, CV_32FC3, const_cast<float*>(source(3).texels.data()));
  cv::Mat to(200, 200, CV_32FC3, mean.texels.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  state.counters["relative_error"] = block_error(source(3), mean);
  for (auto _ : state) cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
}
BENCHMARK(opencv_inter_area)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

void monte_carlo_40_million(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(0)));
  const ImageIntegrand integrand(source(3), plane);
  for (auto _ : state) benchmark::DoNotOptimize(monte_carlo_truth(integrand, 1000, 1));
}
BENCHMARK(monte_carlo_40_million)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

void hash_pixels(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(pixel_hash(source(3)));
}
BENCHMARK(hash_pixels)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace abn::harness
