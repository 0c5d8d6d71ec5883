#include "harness/standard_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "harness/film.h"
#include "harness/image.h"

namespace abn::harness {

Grid<float> independent_standard_error(const Grid<PixelStats>& pixels) {
  Image errors(pixels.size(), 1);
  Grid<std::uint8_t> known(pixels.size());
  for (std::size_t p = 0; p < pixels.size().area(); ++p) {
    if (!pixels[p].known()) continue;
    known[p] = 1;
    errors.texels[p] = std::sqrt(std::max(pixels[p].variance(), 0.0F) / pixels[p].count);
  }
  if (fill_empty(errors, known) == pixels.size().area()) return {};
  Grid<float> result(pixels.size());
  std::copy(errors.texels.begin(), errors.texels.end(), result.cells().begin());
  return result;
}

}  // namespace abn::harness
