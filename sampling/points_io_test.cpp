#include "sampling/points_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "sampling/error.h"
#include "sampling/rng.h"
#include "sampling/test_folder.h"

namespace abn {
namespace {

constexpr PointFormat all_formats[] = {PointFormat::utk, PointFormat::utk_bin, PointFormat::psa, PointFormat::rps,
                                       PointFormat::csv};
constexpr Extent plane{200, 137};

std::vector<Vec2f> random_points(std::size_t count) {
  std::vector<Vec2f> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(to_plane(Rng(7, 0, i).uniform2(), plane));
  points[0] = {0, 0};
  points[1] = {just_below(200.0F), just_below(137.0F)};
  return points;
}

/// The message of the IoError that reading these bytes throws; empty if it throws none.
std::string refusal(std::string_view bytes, std::optional<PointFormat> format = {}) {
  try {
    parse_points(bytes, "'p.dat'", format);
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

void expect_mentions(const std::string& message, const std::string& word) {
  EXPECT_NE(message.find(word), std::string::npos) << "'" << message << "' does not say '" << word << "'";
}

template <class T>
std::string utk_bin(std::uint8_t type, std::uint32_t realisations, std::uint32_t points, std::uint32_t dimensions,
                    const std::vector<T>& values) {
  std::string bytes = "UTK!";
  bytes += static_cast<char>(type);
  bytes += std::string(3, '\0');
  for (const std::uint32_t word : {realisations, points, dimensions}) {
    bytes.append(reinterpret_cast<const char*>(&word), 4);
  }
  return bytes.append(reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size());
}

TEST(PointsIo, PositionsComeBackAsTheSameFloats) {
  const TestFolder folder;
  const auto points = random_points(5000);
  for (const PointFormat format : all_formats) {
    const auto path = folder.path() / (format == PointFormat::utk_bin ? "p.bin"
                                       : format == PointFormat::rps   ? "p.rps"
                                                                      : "p.dat");
    EXPECT_EQ(write_points(path, {.position = points}, plane, format), "");
    const FilePoints read = read_points(path);
    EXPECT_EQ(read.format, format) << format_name(format);
    EXPECT_EQ(read.notice, "");
    ASSERT_EQ(read.position.size(), points.size()) << format_name(format);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto x = static_cast<float>(read.position[i].x * plane.width);
      const auto y = static_cast<float>(read.position[i].y * plane.height);
      const float tolerance = format == PointFormat::rps ? 2e-5F : 0.0F;
      EXPECT_NEAR(x, points[i].x, tolerance);
      EXPECT_NEAR(y, points[i].y, tolerance);
    }
  }
}

TEST(PointsIo, LayoutsAreThoseOfTheToolkits) {
  const std::vector<Vec2f> points = {{0.5F, 0.25F}, {0, 0.75F}};
  const SampleBatch batch{.position = points};
  EXPECT_EQ(format_points(batch, {1, 1}, PointFormat::utk), "0.5 0.25\n0 0.75\n");
  EXPECT_EQ(format_points(batch, {1, 1}, PointFormat::psa), "2\n0.5 0.25\n0 0.75\n");
  EXPECT_EQ(format_points(batch, {1, 1}, PointFormat::csv), "x,y\n0.5,0.25\n0,0.75\n");
  EXPECT_EQ(format_points(batch, {1, 1}, PointFormat::utk_bin), utk_bin<double>(5, 1, 2, 2, {0.5, 0.25, 0, 0.75}));
  const float pairs[] = {0.5F, 0.25F, 0, 0.75F};
  EXPECT_EQ(format_points(batch, {1, 1}, PointFormat::rps), std::string(reinterpret_cast<const char*>(pairs), 16));
  EXPECT_EQ(format_points({.position = std::span(points).first(1)}, {3, 1}, PointFormat::utk),
            "0.16666666666666666 0.25\n");
}

TEST(PointsIo, RoundingToFloatNeverReachesOne) {
  for (std::uint32_t width = 1; width < 3000; ++width) {
    const std::vector<Vec2f> points = {{just_below(static_cast<float>(width)), 0}};
    const std::string bytes = format_points({.position = points}, {width, 1}, PointFormat::rps);
    EXPECT_LT(parse_points(bytes, "p", PointFormat::rps).position[0].x, 1.0) << width;
  }
}

TEST(PointsIo, CsvKeepsWeightsAndPixelsTheOthersSaySo) {
  const TestFolder folder;
  const PointSet set{{{0.5F, 0.5F}, {-0.25F, 1.5F}}, {1.0F, 0.3F}, {7, 4000000000U}};
  write_points(folder.path() / "p.csv", set.view(), {2, 2}, PointFormat::csv);
  const FilePoints read = read_points(folder.path() / "p.csv");
  EXPECT_EQ(read.weight, set.weight);
  EXPECT_EQ(read.pixel, set.pixel);
  EXPECT_EQ(read.position[1], (FilePoint{-0.125, 0.75}));

  EXPECT_THROW(write_points(folder.path() / "p.dat", set.view(), {2, 2}, PointFormat::utk), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "p.dat"));
  const SampleBatch weighted{.position = std::span(set.position).first(1), .weight = std::span(set.weight).first(1)};
  expect_mentions(write_points(folder.path() / "p.dat", weighted, {2, 2}, PointFormat::utk), "use --format csv");
}

TEST(PointsIo, TextVariantsAreUnderstood) {
  const std::vector<FilePoint> two = {{0.5, 0.25}, {0.125, 0.75}};
  for (const char* text : {
           "0.5 0.25\n0.125 0.75\n",
           "0.5 0.25\n0.125 0.75",
           "\n# a comment\n 0.5\t0.25 \r\n\r\n0.125   0.75\r\n\n",
           "(0.5, 0.25)\n(0.125, 0.75)\n",
           "0.5,0.25\n0.125 , 0.75\n",
           "+5e-1 .25\n1.25E-1 0.75\n#\n",
           "2\n0.5 0.25\n0.125 0.75\n",
           "x,y\n0.5,0.25\n0.125,0.75\n",
           " x , y \n0.5, 0.25\n\n0.125 ,0.75\n",
       }) {
    EXPECT_EQ(parse_points(text, "p").position, two) << text;
    EXPECT_EQ(parse_points(text, "p").notice, "") << text;
  }
}

TEST(PointsIo, FirstRealisationIsReadWithANotice) {
  const FilePoints points = parse_points("0.5 0.25\n#\n0.1 0.2\n0.3 0.4\n#\n0.5 0.5\n#\n", "'p.dat'");
  EXPECT_EQ(points.position, (std::vector<FilePoint>{{0.5, 0.25}}));
  EXPECT_EQ(points.notice, "'p.dat' holds 3 realisations; the first one was read");
}

TEST(PointsIo, EveryBinaryNumberTypeIsRead) {
  const std::vector<FilePoint> origin = {{0, 0}};
  EXPECT_EQ(parse_points(utk_bin<std::int32_t>(0, 1, 1, 2, {0, 0}), "p").position, origin);
  EXPECT_EQ(parse_points(utk_bin<std::int64_t>(1, 1, 1, 2, {0, 0}), "p").position, origin);
  EXPECT_EQ(parse_points(utk_bin<std::uint32_t>(2, 1, 1, 2, {0, 0}), "p").position, origin);
  EXPECT_EQ(parse_points(utk_bin<std::uint64_t>(3, 1, 1, 2, {0, 0}), "p").position, origin);
  EXPECT_EQ(parse_points(utk_bin<float>(4, 1, 1, 2, {0.5F, 0.25F}), "p").position,
            (std::vector<FilePoint>{{0.5, 0.25}}));
  EXPECT_EQ(parse_points(utk_bin<double>(5, 1, 1, 2, {0.1, 0.2}), "p").position, (std::vector<FilePoint>{{0.1, 0.2}}));
  expect_mentions(refusal(utk_bin<std::int32_t>(0, 1, 1, 2, {0, -1})), "scale the points to the unit square");
  expect_mentions(refusal(utk_bin<std::uint64_t>(3, 1, 1, 2, {0, ~std::uint64_t{0}})), "byte 20");
}

TEST(PointsIo, BadTextIsRefusedWithItsLine) {
  expect_mentions(refusal(""), "'p.dat' is empty");
  expect_mentions(refusal(" \n\n"), "holds no points");
  expect_mentions(refusal("# nothing\n"), "holds no points");
  expect_mentions(refusal("0.5 0.5\n0.5 1\n"), "line 2: the point (0.5, 1) is outside [0,1)");
  expect_mentions(refusal("-1e-9 0.5\n"), "outside [0,1)");
  expect_mentions(refusal("0.5 nan\n"), "line 1: 'nan' is no finite number");
  expect_mentions(refusal("0.5 inf\n"), "no finite number");
  expect_mentions(refusal("0.5 0.5\n0.25"), "line 2: 1 number");
  expect_mentions(refusal("0.5 0.5 0.5\n"), "another dimension");
  expect_mentions(refusal("0.1 0.2 0.3 0.4 0.5 0.6\n"), "too many numbers");
  expect_mentions(refusal("0.5 0.5\n\nhello world\n"), "line 3: 'hello' is no finite number");
  expect_mentions(refusal("0.5 0.5x\n"), "'0.5x'");
  expect_mentions(refusal("(0.5, 0.5\n"), "no finite number");
  expect_mentions(refusal("0.5,,0.5\n"), "no finite number");
  expect_mentions(refusal("0.5,0.5,\n"), "no finite number");
  expect_mentions(refusal("\x1b[31m 0.5\n"), "'?[31m'");
  expect_mentions(refusal("3\n0.5 0.5\n0.5 0.5\n"), "states 3 points but holds 2");
  expect_mentions(refusal("1\n0.5 0.5\n0.5 0.5\n"), "states 1 point but holds 2");
  expect_mentions(refusal("2.5\n0.5 0.5\n"), "no number of points");
  expect_mentions(refusal("1e99\n0.5 0.5\n"), "no number of points");
  expect_mentions(refusal(std::string("0.5 0.5\n\0\0", 10)), "byte 8: binary data");
}

TEST(PointsIo, BadTablesAreRefusedWithTheirLine) {
  expect_mentions(refusal("x;y\n0.5;0.5\n"), "give x,y[,weight][,pixel]");
  expect_mentions(refusal("0.5,0.5\n", PointFormat::csv), "give x,y[,weight][,pixel]");
  expect_mentions(refusal("x,y\n"), "holds no points");
  expect_mentions(refusal("x,y,weight\n0.5,0.5\n"), "line 2: 2 numbers, but the header names 3 columns");
  expect_mentions(refusal("x,y,weight\n0.5,0.5,-1\n"), "give a number >= 0");
  expect_mentions(refusal("x,y,weight\n0.5,0.5,1e39\n"), "out of range");
  expect_mentions(refusal("x,y,pixel\n0.5,0.5,1.5\n"), "no pixel number");
  expect_mentions(refusal("x,y,pixel\n0.5,0.5,4294967296\n"), "no pixel number");
  expect_mentions(refusal("x,y,pixel\n1e7,0.5,0\n"), "outside");
  expect_mentions(refusal("x,y\n1.5,0.5\n"), "outside");
}

TEST(PointsIo, BadBinaryIsRefusedWithItsByte) {
  const std::string good = utk_bin<double>(5, 1, 2, 2, {0.5, 0.25, 0, 0.75});
  EXPECT_EQ(refusal(good), "");
  for (std::size_t size = 4; size < good.size(); ++size) {
    EXPECT_NE(refusal(std::string_view(good).substr(0, size)), "") << size;
  }
  expect_mentions(refusal(good + "x"), "its header announces 52");
  expect_mentions(refusal(good.substr(0, 10)), "less than the 20");
  expect_mentions(refusal("text 0.5 0.5 and so on...", PointFormat::utk_bin), "no 'UTK!'");
  expect_mentions(refusal(utk_bin<double>(6, 1, 1, 2, {0, 0})), "number type 6");
  expect_mentions(refusal(utk_bin<double>(5, 3, 1, 2, {0, 0})), "3 realisations");
  expect_mentions(refusal(utk_bin<double>(5, 1, 1, 3, {0, 0, 0})), "3 dimensions");
  expect_mentions(refusal(utk_bin<double>(5, 1, 0, 2, {})), "holds no points");
  expect_mentions(refusal(utk_bin<double>(5, 1, 4294967295U, 2, {0, 0})), "cut off");
  expect_mentions(refusal(utk_bin<double>(5, 1, 1, 2, {0, std::nan("")})), "byte 20: the point (0, nan)");
  const float pairs[] = {0.5F, 0.25F, 1.0F, 0.0F};
  const std::string raw(reinterpret_cast<const char*>(pairs), sizeof(pairs));
  expect_mentions(refusal(raw, PointFormat::rps), "byte 8: the point (1, 0) is outside");
  expect_mentions(refusal(raw.substr(0, 12), PointFormat::rps), "no multiple of the 8");
}

TEST(PointsIo, UnreadableFilesAreNamed) {
  const TestFolder folder;
  const auto message = [](const std::filesystem::path& path) -> std::string {
    try {
      read_points(path);
    } catch (const IoError& error) {
      return error.what();
    }
    return {};
  };
  expect_mentions(message(folder.path() / "none.dat"), "none.dat': no such file");
  expect_mentions(message(folder.path()), "no regular file");
  std::ofstream(folder.path() / "empty.rps").flush();
  expect_mentions(message(folder.path() / "empty.rps"), "is empty");
  expect_mentions(message(folder.path() / "empty.rps/p.dat"), "cannot read");
}

TEST(PointsIo, FormatNamesAndExtensions) {
  for (const PointFormat format : all_formats) EXPECT_EQ(parse_point_format(format_name(format)), format);
  EXPECT_THROW(parse_point_format("ply"), ConfigError);
  EXPECT_EQ(format_for("a/p.bin"), PointFormat::utk_bin);
  EXPECT_EQ(format_for("p.CSV"), PointFormat::csv);
  EXPECT_EQ(format_for("p.txt"), PointFormat::psa);
  EXPECT_EQ(format_for("p.rps"), PointFormat::rps);
  EXPECT_EQ(format_for("p.dat"), PointFormat::utk);
  EXPECT_EQ(format_for("p"), PointFormat::utk);
}

}  // namespace
}  // namespace abn
