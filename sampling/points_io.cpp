#include "sampling/points_io.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <system_error>

#include "sampling/atomic_file.h"
#include "sampling/error.h"

namespace abn {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary formats are little-endian");

struct FormatName {
  PointFormat format;
  std::string_view name;
  std::string_view extension;  // empty: any other
};
constexpr std::array<FormatName, 5> formats = {{{PointFormat::utk, "utk", ""},
                                                {PointFormat::utk_bin, "utk-bin", ".bin"},
                                                {PointFormat::psa, "psa", ".txt"},
                                                {PointFormat::rps, "rps", ".rps"},
                                                {PointFormat::csv, "csv", ".csv"}}};

/// Seventeen significant digits bring every double back.
void append_number(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 17);
  text.append(digits.data(), end);
}

template <class T>
void append_bytes(std::string& bytes, const T& value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

bool inside(FilePoint point) { return point.x >= 0 && point.x < 1 && point.y >= 0 && point.y < 1; }

}  // namespace

std::string_view format_name(PointFormat format) {
  return std::find_if(formats.begin(), formats.end(), [&](const FormatName& row) { return row.format == format; })
      ->name;
}

PointFormat parse_point_format(std::string_view name) {
  for (const auto& row : formats) {
    if (row.name == name) return row.format;
  }
  std::string known;
  for (const auto& row : formats) known.append(known.empty() ? "" : " ").append(row.name);
  throw ConfigError("unknown point format '" + std::string(name) + "'; give --format one of: " + known);
}

PointFormat format_for(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const auto& row : formats) {
    if (!row.extension.empty() && row.extension == extension) return row.format;
  }
  return PointFormat::utk;
}

std::string format_points(const SampleBatch& samples, Extent plane, PointFormat format) {
  const auto count = samples.position.size();
  const double width = plane.width;
  const double height = plane.height;
  const auto unit = [&](std::size_t i) {
    const FilePoint point{static_cast<double>(samples.position[i].x) / width,
                          static_cast<double>(samples.position[i].y) / height};
    if (!inside(point) && (format != PointFormat::csv || samples.pixel.empty())) {
      throw ConfigError("sample " + std::to_string(i) + " lies outside the plane, which the format " +
                        std::string(format_name(format)) + " cannot keep; use --format csv");
    }
    return point;
  };

  std::string bytes;
  switch (format) {
    case PointFormat::psa:
      bytes = std::to_string(count) + "\n";
      [[fallthrough]];
    case PointFormat::utk:
      bytes.reserve(bytes.size() + 40 * count);
      for (std::size_t i = 0; i < count; ++i) {
        const FilePoint point = unit(i);
        append_number(bytes, point.x);
        bytes += ' ';
        append_number(bytes, point.y);
        bytes += '\n';
      }
      break;
    case PointFormat::csv:
      bytes = "x,y";
      if (!samples.weight.empty()) bytes += ",weight";
      if (!samples.pixel.empty()) bytes += ",pixel";
      bytes += '\n';
      for (std::size_t i = 0; i < count; ++i) {
        const FilePoint point = unit(i);
        append_number(bytes, point.x);
        bytes += ',';
        append_number(bytes, point.y);
        if (!samples.weight.empty()) {
          bytes += ',';
          append_number(bytes, static_cast<double>(samples.weight[i]));
        }
        if (!samples.pixel.empty()) bytes.append(",").append(std::to_string(samples.pixel[i]));
        bytes += '\n';
      }
      break;
    case PointFormat::utk_bin:
      if (count > std::numeric_limits<std::uint32_t>::max()) {
        throw ConfigError("utk-bin counts points with 32 bits; use --format utk for " + std::to_string(count));
      }
      append_bytes(bytes, UtkHeader{.points = static_cast<std::uint32_t>(count)});
      for (std::size_t i = 0; i < count; ++i) append_bytes(bytes, unit(i));
      break;
    case PointFormat::rps:
      for (std::size_t i = 0; i < count; ++i) {
        const FilePoint point = unit(i);
        // Rounding to float must not reach 1.
        append_bytes(bytes, std::min(static_cast<float>(point.x), just_below(1.0F)));
        append_bytes(bytes, std::min(static_cast<float>(point.y), just_below(1.0F)));
      }
      break;
  }
  return bytes;
}

std::string write_points(const std::filesystem::path& path, const SampleBatch& samples, Extent plane,
                         PointFormat format) {
  write_atomically(path, format_points(samples, plane, format));
  if (format == PointFormat::csv || (samples.weight.empty() && samples.pixel.empty())) return {};
  std::string notice = "the format ";
  notice.append(format_name(format)).append(" of '").append(path.string());
  return notice.append("' keeps positions only; use --format csv to keep weights and pixels");
}

FilePoints read_points(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::not_found) {
    throw IoError("cannot read the points '" + name + "': no such file; check the path");
  }
  if (type != std::filesystem::file_type::regular && type != std::filesystem::file_type::fifo) {
    throw IoError("cannot read the points '" + name + "': " + (error ? error.message() : "it is no regular file") +
                  "; name a file of points");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string bytes;
  std::vector<char> chunk(std::size_t{1} << 20);
  while (file.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || file.gcount() > 0) {
    bytes.append(chunk.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.is_open() || file.bad()) {
    const int reason = errno != 0 ? errno : EIO;
    throw IoError("cannot read the points '" + name + "': " + std::generic_category().message(reason) +
                  "; check its permissions");
  }
  const PointFormat by_name = format_for(path);
  const bool by_content = by_name == PointFormat::utk || by_name == PointFormat::psa;
  return parse_points(bytes, std::string("'") + name + "'", by_content ? std::nullopt : std::optional(by_name));
}

}  // namespace abn
