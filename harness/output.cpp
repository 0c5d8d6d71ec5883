#include "harness/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "harness/error_map.h"
#include "harness/image_io.h"
#include "sampling/atomic_file.h"

namespace abn::harness {

bool is_linear_format(const std::string& path) { return path.ends_with(".exr") || path.ends_with(".hdr"); }

void require_writable_image(const std::string& path) {
  require_image_format(path);
  const AtomicFile probe(path);  // leaves nothing: it is never committed
}

void require_writable(const std::string& path) {
  std::error_code ignored;
  const auto type = std::filesystem::status(path, ignored).type();
  using std::filesystem::file_type;
  const bool is_stream = path.starts_with("/dev/") || path.starts_with("/proc/") || type == file_type::character ||
                         type == file_type::block || type == file_type::fifo || type == file_type::socket;
  if (!is_stream) const AtomicFile probe(path);
}

void write_picture(const std::string& path, const Image& image, bool high_dynamic_range) {
  if (is_linear_format(path) || !high_dynamic_range) {
    save_image(path, image);
  } else {
    const Picture picture = to_picture(image, ToneMapping::reinhard);
    save_rgb8(path, picture.size(), picture.rgb);
  }
}

void write_error_map(const std::string& path, const Image& test, const Image& reference, double gain) {
  const ErrorMap map = error_map(test, reference);
  if (path.ends_with(".exr")) {
    save_image(path, map.difference);
  } else {
    const Picture picture = map.false_colour_picture(gain);
    save_rgb8(path, picture.size(), picture.rgb);
  }
}

void write_estimated_error(const std::string& path, const Grid<float>& standard_error, double gain) {
  if (path.ends_with(".exr")) {
    Image map(standard_error.size(), 1);
    std::copy(standard_error.cells().begin(), standard_error.cells().end(), map.texels.begin());
    save_image(path, map);
  } else {
    const Picture picture = estimated_error_picture(standard_error, gain);
    save_rgb8(path, picture.size(), picture.rgb);
  }
}

Picture overview(const std::string& title, const Image& truth, const std::vector<Exhibit>& exhibits,
                 bool high_dynamic_range, double gain) {
  const ToneMapping tone_mapping = high_dynamic_range ? ToneMapping::reinhard : ToneMapping::none;
  std::vector<MontageItem> items = {{.label = "truth", .picture = to_picture(truth, tone_mapping)}};
  for (const auto& exhibit : exhibits)
    items.push_back({.label = exhibit.label, .picture = to_picture(exhibit.image, tone_mapping)});
  items.push_back({.label = "", .picture = {}});
  for (const auto& exhibit : exhibits) {
    items.push_back({.label = fmt::format("error x {:g}\nRMSE {:.4f}", gain, exhibit.rmse),
                     .picture = error_map(exhibit.image, truth).false_colour_raster(gain)});
  }
  MontageLayout layout;
  layout.columns = static_cast<std::uint32_t>(exhibits.size() + 1);
  layout.title = title;
  layout.colour_bar = ErrorMap::colour_bar(gain);
  if (high_dynamic_range) layout.note = "High dynamic range, shown as x/(1+x); errors are of linear light.";
  return montage(items, layout);
}

}  // namespace abn::harness
