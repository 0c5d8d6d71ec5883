#include "harness/error_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

#include "harness/metrics.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void require_gain(double gain) {
  if (std::isfinite(gain) && gain > 0) return;
  throw ConfigError("gain " + number(gain) + ": must be a positive number; the thesis uses 10");
}

}  // namespace

Image ErrorMap::amplified(double gain) const {
  require_gain(gain);
  Image amplified = difference;
  for (float& texel : amplified.texels) texel = static_cast<float>(std::min(1.0, gain * std::abs(double{texel})));
  for (std::size_t i = 0; i < difference.texels.size(); ++i) {  // min(1, NaN) is 1
    if (std::isnan(difference.texels[i])) amplified.texels[i] = difference.texels[i];
  }
  return amplified;
}

Picture ErrorMap::false_colour_raster(double gain) const {
  require_gain(gain);
  Picture picture(difference.size.width, difference.size.height);
  for (std::size_t pixel = 0; pixel < difference.size.area(); ++pixel) {
    double sum = 0;
    for (std::size_t c = 0; c < difference.channels; ++c) {
      sum += std::abs(double{difference.texels[pixel * difference.channels + c]});
    }
    const Rgb8 colour = false_colour(static_cast<float>(gain * sum / difference.channels));
    std::copy_n(colour.data(), 3, picture.rgb.data() + pixel * 3);
  }
  return picture;
}

Picture ErrorMap::false_colour_picture(double gain) const {
  MontageLayout layout;
  layout.smallest_width = 600;
  layout.colour_bar = colour_bar(gain);
  const MontageItem item{"absolute error x " + number(gain), false_colour_raster(gain)};
  return montage({&item, 1}, layout);
}

ColourBar ErrorMap::colour_bar(double gain) {
  require_gain(gain);
  return {0.0, 1.0 / gain, true, "|test - reference|, mean over channels, linear light"};
}

ErrorMap error_map(const Image& test, const Image& reference) {
  require_comparable(test, reference);
  ErrorMap map{Image(test.size, test.channels)};
  for (std::size_t i = 0; i < test.texels.size(); ++i) {
    map.difference.texels[i] = test.texels[i] - reference.texels[i];
  }
  return map;
}

Picture estimated_error_raster(const Grid<float>& standard_error, double gain) {
  require_gain(gain);
  if (standard_error.cells().empty()) throw ConfigError("there are no estimated errors to draw");
  Picture picture(standard_error.size().width, standard_error.size().height);
  for (std::size_t pixel = 0; pixel < standard_error.cells().size(); ++pixel) {
    const Rgb8 colour = false_colour(static_cast<float>(gain * double{standard_error[pixel]}));
    std::copy_n(colour.data(), 3, picture.rgb.data() + pixel * 3);
  }
  return picture;
}

Picture estimated_error_picture(const Grid<float>& standard_error, double gain) {
  MontageLayout layout;
  layout.smallest_width = 600;
  layout.colour_bar = {0.0, 1.0 / gain, true, "standard error of luminance, estimated without the truth, linear light"};
  const MontageItem item{"estimated error x " + number(gain), estimated_error_raster(standard_error, gain)};
  return montage({&item, 1}, layout);
}

}  // namespace abn::harness
