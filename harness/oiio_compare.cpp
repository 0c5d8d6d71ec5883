#include "harness/oiio_compare.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <cstddef>

#include "harness/metrics.h"

namespace abn::harness {
namespace {

// A copy of the texels as OpenImageIO holds them; `channels` may be 3 for a grey image, which is then replicated.
OIIO::ImageBuf buffer(const Image& image, std::uint32_t channels) {
  const OIIO::ImageSpec spec(static_cast<int>(image.size.width), static_cast<int>(image.size.height),
                             static_cast<int>(channels), OIIO::TypeDesc::FLOAT);
  OIIO::ImageBuf copy(spec);
  auto* texels = static_cast<float*>(copy.localpixels());
  for (std::size_t pixel = 0; pixel < image.size.area(); ++pixel) {
    for (std::uint32_t c = 0; c < channels; ++c) {
      texels[pixel * channels + c] = image.texels[pixel * image.channels + (image.channels == 1 ? 0 : c)];
    }
  }
  return copy;
}

}  // namespace

ThresholdComparison compare_thresholds(const Image& test, const Image& reference, float failure_threshold,
                                       float warning_threshold) {
  require_comparable(test, reference);
  // One thread: the sums of OpenImageIO depend on the number of threads.
  const OIIO::ImageBufAlgo::CompareResults result =
      OIIO::ImageBufAlgo::compare(buffer(test, test.channels), buffer(reference, reference.channels), failure_threshold,
                                  warning_threshold, OIIO::ROI(), 1);
  return {result.meanerror,
          result.rms_error,
          result.PSNR,
          result.maxerror,
          static_cast<std::uint32_t>(result.maxx),
          static_cast<std::uint32_t>(result.maxy),
          static_cast<std::uint32_t>(result.maxc),
          result.nwarn,
          result.nfail};
}

PerceptualComparison compare_perceptual(const Image& test, const Image& reference) {
  require_comparable(test, reference);
  OIIO::ImageBufAlgo::CompareResults result{};
  const int failures =
      OIIO::ImageBufAlgo::compare_Yee(buffer(test, 3), buffer(reference, 3), result, 100.0F, 45.0F, OIIO::ROI(), 1);
  return {static_cast<std::uint64_t>(failures), result.maxerror};
}

}  // namespace abn::harness
