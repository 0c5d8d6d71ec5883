// Point sets on file: the formats of the toolkits we compare with, on the unit square [0,1)^2.
//
//   utk      text, "x y" lines, realisations separated by '#'   UTK (github.com/utk-team/utk)
//   utk-bin  UTK's binary form, one realisation
//   psa      text, the number of points, then "x y" lines       PSA (github.com/nodag/psa)
//   rps      raw little-endian float32 pairs                    PSA
//   csv      a header x,y[,weight][,pixel], then rows
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sampling/sampler.h"
#include "sampling/vec.h"

namespace abn {

enum class PointFormat { utk, utk_bin, psa, rps, csv };

/// "utk", "utk-bin", "psa", "rps" or "csv".
std::string_view format_name(PointFormat format);
/// The reverse. Throws ConfigError that lists the names.
PointFormat parse_point_format(std::string_view name);
/// What an extension means: .bin utk-bin, .txt psa, .rps rps, .csv csv, anything else utk.
PointFormat format_for(const std::filesystem::path& path);

/// A position on the unit square, in double as the formats keep it.
struct FilePoint {
  double x = 0;
  double y = 0;
  friend bool operator==(FilePoint, FilePoint) = default;
};

/// What a utk-bin file begins with.
struct UtkHeader {
  static constexpr std::uint32_t right_magic = 0x214B5455;  // "UTK!"
  std::uint32_t magic = right_magic;
  std::array<std::uint8_t, 4> meta = {5, 0, 0, 0};  // number type: int32, int64, uint32, uint64, float, double
  std::uint32_t realisations = 1;
  std::uint32_t points = 0;
  std::uint32_t dimensions = 2;
};
static_assert(sizeof(UtkHeader) == 20);

/// A point set as read. Positions lie in [0,1)^2; only with `pixel` given may they lie outside, and are finite.
struct FilePoints {
  std::vector<FilePoint> position;
  std::vector<float> weight;         // finite, >= 0; empty = all 1
  std::vector<std::uint32_t> pixel;  // owner; empty = the pixel that contains the position
  PointFormat format = PointFormat::utk;
  std::string notice;  // empty, or one sentence on what was left unread
};

/// Reads a file; content, then the extension, tells the format. Of several realisations in a text file the first is
/// read, with a notice. Also text as "(x, y)" lines (Helmer's sampler) is understood. Throws IoError naming the file,
/// the line or byte, and the remedy: missing, empty, cut off, no number, not in [0,1), wrong header.
FilePoints read_points(const std::filesystem::path& path);

/// The same for bytes in memory; messages begin with `name`. Without `format` the content tells it, where
/// `rps` cannot be recognised.
FilePoints parse_points(std::string_view bytes, std::string_view name, std::optional<PointFormat> format = {});

/// The bytes of a file of `samples` on `plane`, scaled to the unit square. Text has 17 digits: scaled back, positions
/// are the same floats. rps rounds to float32. Throws ConfigError if a sample lies outside the plane and the
/// format is not csv, which keeps its pixel.
std::string format_points(const SampleBatch& samples, Extent plane, PointFormat format);

/// Writes that file, atomically. Returns a notice if the format could not keep weights or pixels, else empty. Throws
/// IoError, ConfigError.
std::string write_points(const std::filesystem::path& path, const SampleBatch& samples, Extent plane,
                         PointFormat format);

}  // namespace abn
