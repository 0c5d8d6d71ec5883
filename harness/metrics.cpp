#include "harness/metrics.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "harness/error_structure.h"
#include "harness/flip.h"
#include "harness/oiio_compare.h"
#include "harness/separable_filter.h"
#include "harness/ssim.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

// Each term is a function of one test value x and one reference value y.
double difference(double x, double y) { return x - y; }
double absolute(double x, double y) { return std::abs(x - y); }
double squared(double x, double y) { return (x - y) * (x - y); }
// The constants .01 keep black pixels from deciding the score; 0/0 is 0.
double relative_squared(double x, double y) { return squared(x, y) / (y * y + 0.01); }
double symmetric_relative(double x, double y) { return absolute(x, y) / (std::abs(x) + std::abs(y) + 0.01); }
// Reinhard's curve x/(1+x), continued oddly below 0, where it would have a pole.
double tone_mapped(double value) { return value / (1.0 + std::abs(value)); }
double squared_tone_mapped(double x, double y) { return squared(tone_mapped(x), tone_mapped(y)); }

// Mean of a term over pixels and channels: a sum per row, then the rows in order, so that threads change nothing.
template <class Term>
double mean_of(const MetricInput& input, Term term) {
  require_comparable(input.test, input.reference);
  const auto height = static_cast<int>(input.test.size.height);
  std::vector<double> rows(input.test.size.height);
#pragma omp parallel for schedule(static) if (input.test.size.area() >= smallest_parallel_raster)
  for (int y = 0; y < height; ++y) {
    const auto test = input.test.row(static_cast<std::uint32_t>(y));
    const auto reference = input.reference.row(static_cast<std::uint32_t>(y));
    double sum = 0;
    for (std::size_t i = 0; i < test.size(); ++i) sum += term(test[i], reference[i]);
    rows[static_cast<std::size_t>(y)] = sum;
  }
  double sum = 0;
  for (double row : rows) sum += row;
  return sum / static_cast<double>(input.test.texels.size());
}

double root(double value) { return std::sqrt(value); }
double same(double value) { return value; }

// Per pixel: finish(mean of the term over the channels).
template <class Term, class Finish>
Grid<float> map_of(const MetricInput& input, Term term, Finish finish) {
  require_comparable(input.test, input.reference);
  const std::uint32_t channels = input.test.channels;
  Grid<float> map(input.test.size);
  const auto count = static_cast<std::ptrdiff_t>(map.cells().size());
#pragma omp parallel for schedule(static) if (map.cells().size() >= smallest_parallel_raster)
  for (std::ptrdiff_t pixel = 0; pixel < count; ++pixel) {
    const std::size_t first = static_cast<std::size_t>(pixel) * channels;
    double sum = 0;
    for (std::size_t i = first; i < first + channels; ++i) sum += term(input.test.texels[i], input.reference.texels[i]);
    map[static_cast<std::size_t>(pixel)] = static_cast<float>(finish(sum / channels));
  }
  return map;
}

double peak_signal_to_noise(const MetricInput& input) {
  const double mean_square = mean_of(input, squared);
  // Without a peak there is no ratio.
  return input.high_dynamic_range ? std::numeric_limits<double>::quiet_NaN() : -10.0 * std::log10(mean_square);
}

FlipResult flip(const MetricInput& input) {
  require_comparable(input.test, input.reference);
  return input.high_dynamic_range ? hdr_flip(input.test, input.reference) : ldr_flip(input.test, input.reference);
}

// Row of a metric that is the mean of a term, or the root of that mean.
template <class Term, class Finish>
Metric mean_row(std::string name, std::string unit, std::string summary, std::string cite, Term term, Finish finish) {
  return {std::move(name),
          std::move(unit),
          std::move(summary),
          std::move(cite),
          true,
          [=](const MetricInput& input) { return finish(mean_of(input, term)); },
          [=](const MetricInput& input) { return map_of(input, term, finish); }};
}

std::vector<Metric> make_table() {
  return {
      mean_row("rmse", "linear light", "root of the mean squared error, sqrt(mean (x-y)^2)", "", squared, root),
      mean_row("mae", "linear light", "mean absolute error, mean |x-y|", "", absolute, same),
      mean_row("bias", "linear light", "mean error, mean (x-y); 0 is best", "", difference, same),
      {"psnr",
       "dB",
       "peak signal to noise ratio for a peak of 1, -20 log10 rmse; none for high dynamic range or equal images",
       "",
       false,
       peak_signal_to_noise,
       {}},
      mean_row("relmse", "", "relative squared error, mean (x-y)^2/(y^2+.01)", "Rousselle, Knaus, Zwicker 2011",
               relative_squared, same),
      mean_row("smape", "", "symmetric relative error, mean |x-y|/(|x|+|y|+.01), below 2 whatever the outlier",
               "Makridakis 1993", symmetric_relative, same),
      mean_row("rmse_tonemapped", "", "rmse of x/(1+x), for high dynamic range", "Reinhard et al. 2002",
               squared_tone_mapped, root),
      {"ssim", "", "structural similarity of sRGB-encoded values, 1 for equal images",
       "Wang, Bovik, Sheikh, Simoncelli 2004", false,
       [](const MetricInput& input) {
         require_comparable(input.test, input.reference);
         return structural_similarity(input.test, input.reference).mean;
       },
       [](const MetricInput& input) {
         require_comparable(input.test, input.reference);
         return structural_similarity(input.test, input.reference).map;
       }},
      {"flip", "", "visible difference of alternating images, 0 to 1, at 67 pixels per degree",
       "Andersson et al. 2020 (low dynamic range), 2021 (high)", true,
       [](const MetricInput& input) { return flip(input).mean; },
       [](const MetricInput& input) { return flip(input).map; }},
      {"yee_failures",
       "px",
       "pixels that fail OpenImageIO's perceptual comparison; blind to differences without colour",
       "Yee 2004",
       true,
       [](const MetricInput& input) {
         return static_cast<double>(compare_perceptual(input.test, input.reference).failures);
       },
       {}},
      {"differing_pixels",
       "px",
       "pixels with a value that differs by more than 1e-6, as `idiff` counts failures",
       "OpenImageIO",
       true,
       [](const MetricInput& input) {
         return static_cast<double>(compare_thresholds(input.test, input.reference).failures);
       },
       {}},
      {"spectral_peak",
       "",
       "largest over mean power of the error's spectrum: 10 = noise, hundreds = a visible pattern",
       "thesis fig. 3.5",
       true,
       [](const MetricInput& input) { return spectral_peak(input.test, input.reference); },
       {}},
      {"error_run_length",
       "px",
       "mean length of runs of large errors of one sign: below 2 = noise, more = stairs and bands",
       "thesis fig. 3.2",
       true,
       [](const MetricInput& input) { return error_run_length(input.test, input.reference); },
       {}},
  };
}

std::string describe(const Image& image) {
  return std::to_string(image.size.width) + "x" + std::to_string(image.size.height) + " with " +
         std::to_string(image.channels) + (image.channels == 1 ? " channel" : " channels");
}

}  // namespace

const std::vector<Metric>& metrics() {
  static const std::vector<Metric> table = make_table();
  return table;
}

const Metric& find_metric(std::string_view name) {
  for (const Metric& metric : metrics()) {
    if (metric.name == name) return metric;
  }
  std::string message = "metric '" + std::string(name) + "': unknown; known are";
  for (const Metric& metric : metrics()) message += " " + metric.name;
  throw ConfigError(message);
}

WorstPixel worst_pixel(const Image& test, const Image& reference) {
  require_comparable(test, reference);
  std::size_t worst = 0;
  double largest = -1;
  for (std::size_t i = 0; i < test.texels.size(); ++i) {
    const double error = absolute(test.texels[i], reference.texels[i]);
    if (error > largest || std::isnan(error)) {
      worst = i;
      largest = error;
      if (std::isnan(error)) break;
    }
  }
  const std::size_t pixel = worst / test.channels;
  return {static_cast<std::uint32_t>(pixel % test.size.width), static_cast<std::uint32_t>(pixel / test.size.width),
          static_cast<std::uint32_t>(worst % test.channels), difference(test.texels[worst], reference.texels[worst])};
}

void require_comparable(const Image& test, const Image& reference) {
  if (test.size != reference.size || test.channels != reference.channels) {
    throw ConfigError("compare: the test image is " + describe(test) + ", the reference " + describe(reference) +
                      "; give two images of the same size and channels (`abn truth IMAGE --to WxH` makes a reference, "
                      "--channels chooses channels)");
  }
  if (test.texels.empty())
    throw ConfigError("compare: both images are " + describe(test) + "; give images with pixels");
}

}  // namespace abn::harness
