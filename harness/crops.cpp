#include "harness/crops.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "harness/error_map.h"
#include "harness/metrics.h"

namespace abn::harness {

CanvasArea pixels_of(const Region& region, Extent size) {
  const auto interval = [](double from, double to, std::uint32_t length) {
    const auto side = static_cast<int>(length);
    const int first = std::clamp(static_cast<int>(std::lround(from * length)), 0, side - 1);
    return std::pair(first, std::clamp(static_cast<int>(std::lround(to * length)), first + 1, side) - first);
  };
  const auto [left, width] = interval(region.left, region.right, size.width);
  const auto [top, height] = interval(region.top, region.bottom, size.height);
  return {left, top, width, height};
}

Image cut_out(const Image& image, const CanvasArea& area) {
  assert(area.left >= 0 && area.top >= 0 && area.right() <= static_cast<int>(image.size.width) &&
         area.bottom() <= static_cast<int>(image.size.height));
  const Extent size{static_cast<std::uint32_t>(area.width), static_cast<std::uint32_t>(area.height)};
  Image part(size, image.channels);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const float* from = image.texel(static_cast<std::uint32_t>(area.left), static_cast<std::uint32_t>(area.top) + y);
    std::copy_n(from, std::size_t{size.width} * image.channels, part.texel(0, y));
  }
  return part;
}

double rmse_inside(const Image& test, const Image& truth, const CanvasArea& area) {
  require_comparable(test, truth);
  const Image a = cut_out(test, area);
  const Image b = cut_out(truth, area);
  double sum = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    const double difference = double{a.texels[i]} - double{b.texels[i]};
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(a.texels.size()));
}

Picture crop_sheet(const Image& truth, const std::vector<Exhibit>& exhibits, const Region& region,
                   const CropLayout& layout) {
  const CanvasArea area = pixels_of(region, truth.size);
  const auto shown = [&](const Image& image) {
    return enlarge(
        to_picture(cut_out(image, area), layout.high_dynamic_range ? ToneMapping::reinhard : ToneMapping::none),
        layout.zoom);
  };
  std::vector<MontageItem> items = {{.label = "truth", .picture = shown(truth)}};
  for (const Exhibit& exhibit : exhibits) items.push_back({.label = exhibit.label, .picture = shown(exhibit.image)});
  items.push_back({.label = "", .picture = {}});
  for (const Exhibit& exhibit : exhibits) {
    const ErrorMap map = error_map(cut_out(exhibit.image, area), cut_out(truth, area));
    items.push_back(
        {.label = fmt::format("error x {:g}\nRMSE {:.4f}", layout.gain, rmse_inside(exhibit.image, truth, area)),
         .picture = enlarge(map.false_colour_raster(layout.gain), layout.zoom)});
  }
  MontageLayout sheet;
  sheet.columns = static_cast<std::uint32_t>(exhibits.size() + 1);
  sheet.smallest_width = 1;  // enlarged already
  sheet.title = layout.title;
  sheet.colour_bar = ErrorMap::colour_bar(layout.gain);
  sheet.note = fmt::format("Pixels {}..{} x {}..{} of {}x{}.", area.left, area.right() - 1, area.top, area.bottom() - 1,
                           truth.size.width, truth.size.height);
  if (layout.high_dynamic_range) sheet.note += " High dynamic range, shown as x/(1+x); errors are of linear light.";
  return montage(items, sheet);
}

std::vector<Region> named_regions(const std::string& scene_word, const std::vector<std::string>& names) {
  constexpr std::string_view kPrefix = "scene:";
  std::vector<Region> found;
  if (names.empty() || !scene_word.starts_with(kPrefix)) return found;
  const std::vector<Region> all = regions(find_scene(scene_word.substr(kPrefix.size())));
  for (const std::string& name : names) {
    const auto region = std::find_if(all.begin(), all.end(), [&](const Region& r) { return r.name == name; });
    if (region != all.end()) found.push_back(*region);
  }
  return found;
}

}  // namespace abn::harness
