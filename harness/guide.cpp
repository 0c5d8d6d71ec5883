#include "harness/guide.h"

#include <algorithm>

#include "harness/image_io.h"
#include "harness/truth.h"

namespace abn::harness {
namespace {

Image luminance_image(const Image& image) {
  Image grey(image.size, 1);
  for (std::size_t i = 0; i < image.size.area(); ++i) {
    grey.texels[i] = luminance(&image.texels[i * image.channels], image.channels);
  }
  return grey;
}

}  // namespace

std::shared_ptr<const Grid<float>> load_guide(const std::string& word, const Image& source, Extent to) {
  if (word == "true_variance") {
    Image grey = luminance_image(source);
    const Image mean = exact_truth(grey, to).image;
    for (float& value : grey.texels) value *= value;
    const Image square = exact_truth(grey, to).image;
    auto guide = std::make_shared<Grid<float>>(to);
    for (std::size_t i = 0; i < to.area(); ++i) {
      // In double: both terms are rounded to float already, so that a variance below 1e-7 of the square is noise.
      const double variance = double{square.texels[i]} - double{mean.texels[i]} * double{mean.texels[i]};
      (*guide)[i] = static_cast<float>(std::max(0.0, variance));
    }
    return guide;
  }
  const Image grey = luminance_image(load_image(word).image);
  auto guide = std::make_shared<Grid<float>>(grey.size);
  for (std::size_t i = 0; i < grey.size.area(); ++i) (*guide)[i] = std::max(0.0F, grey.texels[i]);
  return guide;
}

}  // namespace abn::harness
