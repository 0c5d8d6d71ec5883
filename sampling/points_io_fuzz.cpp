// libFuzzer entry for the readers of points_io.h: whatever the bytes, they give points that keep the promises of
// FilePoints or an IoError, never anything else. Build with -fsanitize=fuzzer,address,undefined.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "sampling/error.h"
#include "sampling/points_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using abn::PointFormat;
  if (size == 0) return 0;
  constexpr PointFormat formats[] = {PointFormat::utk, PointFormat::utk_bin, PointFormat::psa, PointFormat::rps,
                                     PointFormat::csv};
  // The first byte is the extension: one of the formats, or none.
  std::optional<PointFormat> format;
  if (data[0] % 6 < 5) format = formats[data[0] % 6];
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    const abn::FilePoints points = abn::parse_points(bytes, "fuzz", format);
    const auto count = points.position.size();
    if (count == 0 || (!points.weight.empty() && points.weight.size() != count) ||
        (!points.pixel.empty() && points.pixel.size() != count)) {
      std::abort();
    }
    for (const auto& [x, y] : points.position) {
      const bool inside = x >= 0 && x < 1 && y >= 0 && y < 1;
      if (!inside && (points.pixel.empty() || !std::isfinite(x) || !std::isfinite(y))) std::abort();
    }
    for (const float weight : points.weight) {
      if (!(weight >= 0) || !std::isfinite(weight)) std::abort();
    }
  } catch (const abn::IoError&) {
  }
  return 0;
}
