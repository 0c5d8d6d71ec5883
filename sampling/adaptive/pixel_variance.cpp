#include "sampling/adaptive/pixel_variance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace abn {
namespace {

// Far enough below the largest float that sums over neighbours stay finite.
constexpr float largest_variance = 1e36F;

/// The cells of [0,cells) that cell i of `count` equal ones meets.
struct Range {
  std::uint32_t begin, end;
  Range(std::uint32_t i, std::uint32_t count, std::uint32_t cells)
      : begin(static_cast<std::uint32_t>(std::uint64_t{i} * cells / count)),
        end(static_cast<std::uint32_t>(((std::uint64_t{i} + 1) * cells + count - 1) / count)) {}
};

/// out(x,y) = f(before, here, after) along one axis.
template <class F>
Grid<float> along(const Grid<float>& in, bool rows, const F& f) {
  const Extent size = in.size();
  Grid<float> out(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const float before = rows ? in.at(x > 0 ? x - 1 : 0, y) : in.at(x, y > 0 ? y - 1 : 0);
      const float after = rows ? in.at(std::min(x + 1, size.width - 1), y) : in.at(x, std::min(y + 1, size.height - 1));
      out.at(x, y) = f(before, in.at(x, y), after);
    }
  }
  return out;
}

}  // namespace

Grid<float> pixel_variance(const Grid<PixelStats>& pixels, Extent plane) {
  Grid<float> variance(plane);
  if (pixels.size() != plane) return variance;
  for (std::size_t i = 0; i < variance.cells().size(); ++i) {
    const PixelStats& stats = pixels[i];
    const float v = stats.known() ? stats.m2 / stats.count : 0.0F;
    if (std::isfinite(v) && v > 0) variance[i] = std::min(v, largest_variance);
  }
  return variance;
}

Grid<float> resampled(const Grid<float>& values, Extent size) {
  const Extent from = values.size();
  Grid<float> result(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const Range rows(y, size.height, from.height);
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const Range columns(x, size.width, from.width);
      double sum = 0;
      std::uint64_t count = 0;
      for (std::uint32_t row = rows.begin; row < rows.end; ++row) {
        for (std::uint32_t column = columns.begin; column < columns.end; ++column) {
          const float value = values.at(column, row);
          if (!std::isfinite(value)) continue;
          sum += std::max(0.0, double{value});
          ++count;
        }
      }
      result.at(x, y) = count > 0 ? static_cast<float>(sum / static_cast<double>(count)) : 0.0F;
    }
  }
  return result;
}

Grid<float> dilated(const Grid<float>& values, int radius) {
  const auto largest = [](float before, float here, float after) { return std::max({before, here, after}); };
  Grid<float> result = values;
  for (int k = 0; k < radius; ++k) {
    result = along(result, true, largest);
    result = along(result, false, largest);
  }
  return result;
}

}  // namespace abn
