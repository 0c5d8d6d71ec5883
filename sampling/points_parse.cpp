// Reading the formats of points_io.h from memory. Nothing here trusts a count or a length that a file states.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn {
namespace {

// With an owner pixel given a position may lie outside the plane, as far as this many planes: beyond is garbage.
constexpr double far_outside = 1e6;
// Enough for every format; a line with more numbers is wrong however many.
constexpr std::size_t max_columns = 5;
constexpr std::string_view blanks = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// A piece of a file for a message: short, and without control characters.
std::string quoted(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
  return "'" + shown + (text.size() > 40 ? "..." : "") + "'";
}

std::string plural(std::uint64_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string shown(double value) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end};
}

[[noreturn]] void fail(std::string_view name, const std::string& text) { throw IoError(std::string(name) + text); }

/// The lines of a text with their numbers, from 1.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  /// Moves on to the next line that is not blank.
  bool next() {
    while (!rest_.empty()) {
      const auto end = rest_.find('\n');
      line_ = trimmed(rest_.substr(0, end));
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      if (!line_.empty()) return true;
    }
    return false;
  }
  std::string_view line() const { return line_; }
  bool comment() const { return line_.front() == '#'; }
  std::string place() const { return ", line " + std::to_string(number_) + ": "; }

 private:
  std::string_view rest_;
  std::string_view line_;
  std::uint64_t number_ = 0;
};

/// The numbers of a line, separated by blanks or single commas, perhaps in one pair of brackets.
struct Row {
  std::array<double, max_columns> number{};
  std::size_t count = 0;
};

Row parse_row(std::string_view name, const Lines& lines) {
  std::string_view rest = lines.line();
  if (rest.front() == '(' && rest.back() == ')') rest = trimmed(rest.substr(1, rest.size() - 2));
  Row row;
  bool separator = false;  // a comma that waits for its number
  while (!rest.empty() || separator) {
    const auto end = rest.find_first_of(" \t\r\v\f,");
    std::string_view word = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view{} : trimmed(rest.substr(end));
    std::string_view digits = word;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || stop != digits.data() + digits.size() || !std::isfinite(value)) {
      fail(name, lines.place() + quoted(word) + " is no finite number; give two numbers a line");
    }
    if (row.count == max_columns) fail(name, lines.place() + "too many numbers; give two a line");
    row.number[row.count++] = value;
    separator = !rest.empty() && rest.front() == ',';
    if (separator) rest = trimmed(rest.substr(1));
  }
  return row;
}

/// `place` makes the text that tells where the point is, when it is needed.
template <class Place>
FilePoint checked(std::string_view name, const Place& place, double x, double y, bool has_pixel) {
  const auto inside = [&](double value) {
    return has_pixel ? std::abs(value) <= far_outside : value >= 0 && value < 1;
  };
  if (!inside(x) || !inside(y)) {
    fail(name, place() + "the point (" + shown(x) + ", " + shown(y) +
                   ") is outside [0,1); scale the points to the unit square");
  }
  return {x, y};
}

void require_points(std::string_view name, const FilePoints& points) {
  if (points.position.empty()) fail(name, " holds no points; give at least one");
}

FilePoints parse_pairs(std::string_view name, std::string_view bytes) {
  FilePoints points;
  Lines lines(bytes);
  bool counted = false;
  double stated = 0;
  std::uint64_t realisations = 1;
  bool separated = false;  // a '#' after points
  while (lines.next()) {
    if (lines.comment() && !counted) {
      separated = separated || !points.position.empty();
      continue;
    }
    if (separated) {
      // Points of a further realisation: what they are is not read, only that they are.
      ++realisations;
      while (lines.next() && !lines.comment()) {
      }
      continue;
    }
    const Row row = parse_row(name, lines);
    if (row.count == 1 && points.position.empty() && !counted) {
      stated = row.number[0];
      counted = true;
      if (stated < 1 || stated > std::numeric_limits<std::uint32_t>::max() || stated != std::floor(stated)) {
        fail(name, lines.place() + quoted(lines.line()) + " is no number of points; give a whole number, or two " +
                       "coordinates a line");
      }
      points.format = PointFormat::psa;
      continue;
    }
    if (row.count != 2) {
      fail(name, lines.place() + plural(row.count, "number") +
                     ", but a point has two; the file is cut off or has another dimension");
    }
    points.position.push_back(checked(
        name, [&] { return lines.place(); }, row.number[0], row.number[1], false));
  }
  const auto found = points.position.size();
  if (counted && static_cast<double>(found) != stated) {
    fail(name, " states " + plural(static_cast<std::uint64_t>(stated), "point") + " but holds " +
                   std::to_string(found) + "; it is cut off, or the number in its first line is wrong");
  }
  require_points(name, points);
  if (realisations > 1) {
    points.notice =
        std::string(name) + " holds " + std::to_string(realisations) + " realisations; the first one was read";
  }
  return points;
}

FilePoints parse_csv(std::string_view name, std::string_view bytes) {
  FilePoints points;
  points.format = PointFormat::csv;
  Lines lines(bytes);
  if (!lines.next()) fail(name, " is empty; give the header x,y and a row for each point");
  std::string header;
  for (const char c : lines.line()) {
    if (blanks.find(c) == std::string_view::npos) header += c;
  }
  const bool has_weight = header == "x,y,weight" || header == "x,y,weight,pixel";
  const bool has_pixel = header == "x,y,pixel" || header == "x,y,weight,pixel";
  if (!has_weight && !has_pixel && header != "x,y") {
    fail(name, lines.place() + "the header is " + quoted(lines.line()) + "; give x,y[,weight][,pixel]");
  }
  const std::size_t columns = 2U + (has_weight ? 1U : 0U) + (has_pixel ? 1U : 0U);
  while (lines.next()) {
    const Row row = parse_row(name, lines);
    if (row.count != columns) {
      fail(name, lines.place() + plural(row.count, "number") + ", but the header names " + std::to_string(columns) +
                     " columns; the file is cut off or the header is wrong");
    }
    points.position.push_back(checked(
        name, [&] { return lines.place(); }, row.number[0], row.number[1], has_pixel));
    if (has_weight) {
      const double weight = row.number[2];
      if (weight < 0 || weight > static_cast<double>(std::numeric_limits<float>::max())) {
        fail(name, lines.place() + "the weight " + shown(weight) + " is out of range; give a number >= 0");
      }
      points.weight.push_back(static_cast<float>(weight));
    }
    if (has_pixel) {
      const double pixel = row.number[columns - 1];
      if (pixel < 0 || pixel > std::numeric_limits<std::uint32_t>::max() || pixel != std::floor(pixel)) {
        fail(name, lines.place() + "the pixel " + shown(pixel) + " is no pixel number; give y*width+x");
      }
      points.pixel.push_back(static_cast<std::uint32_t>(pixel));
    }
  }
  require_points(name, points);
  return points;
}

/// Pairs of T from `offset` on.
template <class T>
FilePoints parse_binary(std::string_view name, std::string_view bytes, std::size_t offset, PointFormat format) {
  FilePoints points;
  points.format = format;
  points.position.reserve((bytes.size() - offset) / (2 * sizeof(T)));
  for (; offset < bytes.size(); offset += 2 * sizeof(T)) {
    std::array<T, 2> pair{};
    std::memcpy(pair.data(), bytes.data() + offset, sizeof(pair));
    const auto x = static_cast<double>(pair[0]);
    const auto y = static_cast<double>(pair[1]);
    points.position.push_back(checked(
        name, [&] { return ", byte " + std::to_string(offset) + ": "; }, x, y, false));
  }
  require_points(name, points);
  return points;
}

FilePoints parse_rps(std::string_view name, std::string_view bytes) {
  if (bytes.size() % 8 != 0) {
    fail(name, " holds " + plural(bytes.size(), "byte") +
                   ", no multiple of the 8 of a float32 pair; it is cut off or no rps file");
  }
  return parse_binary<float>(name, bytes, 0, PointFormat::rps);
}

FilePoints parse_utk_bin(std::string_view name, std::string_view bytes) {
  UtkHeader header;
  if (bytes.size() < sizeof(header)) {
    fail(name, " holds " + plural(bytes.size(), "byte") + ", less than the 20 of a utk-bin header; it is cut off");
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.magic != UtkHeader::right_magic) {
    fail(name, ", byte 0: no 'UTK!'; it is no utk-bin file, give text points another extension than .bin");
  }
  constexpr std::array<std::size_t, 6> sizes = {4, 8, 4, 8, 4, 8};
  const std::size_t type = header.meta[0];
  if (type >= sizes.size()) {
    fail(name, ", byte 4: number type " + std::to_string(type) + " is unknown; known are 0 to 5");
  }
  if (header.realisations != 1) {
    fail(name, ", byte 8: " + plural(header.realisations, "realisation") +
                   "; give one a file (UTK repeats the first one in such files: write them with {i} in the name)");
  }
  if (header.dimensions != 2) {
    fail(name, ", byte 16: " + plural(header.dimensions, "dimension") + "; give points of the plane, with 2");
  }
  // At most 2^32 * 2 * 8 + 20: no overflow.
  const std::uint64_t expected = sizeof(header) + std::uint64_t{header.points} * 2 * sizes[type];
  if (bytes.size() != expected) {
    fail(name, " holds " + plural(bytes.size(), "byte") + ", but its header announces " + std::to_string(expected) +
                   "; it is cut off or damaged");
  }
  switch (type) {
    case 0:
      return parse_binary<std::int32_t>(name, bytes, sizeof(header), PointFormat::utk_bin);
    case 1:
      return parse_binary<std::int64_t>(name, bytes, sizeof(header), PointFormat::utk_bin);
    case 2:
      return parse_binary<std::uint32_t>(name, bytes, sizeof(header), PointFormat::utk_bin);
    case 3:
      return parse_binary<std::uint64_t>(name, bytes, sizeof(header), PointFormat::utk_bin);
    case 4:
      return parse_binary<float>(name, bytes, sizeof(header), PointFormat::utk_bin);
    default:
      return parse_binary<double>(name, bytes, sizeof(header), PointFormat::utk_bin);
  }
}

PointFormat recognise(std::string_view name, std::string_view bytes) {
  if (bytes.starts_with("UTK!")) return PointFormat::utk_bin;
  if (bytes.substr(0, 4096).find('\0') != std::string_view::npos) {
    fail(name, ", byte " + std::to_string(bytes.find('\0')) +
                   ": binary data, but no utk-bin file; give raw float32 pairs the extension .rps");
  }
  Lines lines(bytes);
  if (lines.next() && lines.line().front() == 'x') return PointFormat::csv;
  return PointFormat::utk;  // or psa: the first line tells
}

}  // namespace

FilePoints parse_points(std::string_view bytes, std::string_view name, std::optional<PointFormat> format) {
  if (bytes.empty()) fail(name, " is empty; give at least one point");
  switch (format ? *format : recognise(name, bytes)) {
    case PointFormat::utk_bin:
      return parse_utk_bin(name, bytes);
    case PointFormat::rps:
      return parse_rps(name, bytes);
    case PointFormat::csv:
      return parse_csv(name, bytes);
    case PointFormat::utk:
    case PointFormat::psa:
      break;
  }
  return parse_pairs(name, bytes);
}

}  // namespace abn
