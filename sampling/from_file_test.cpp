#include "sampling/from_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "sampling/blue_noise_test.h"
#include "sampling/error.h"
#include "sampling/rng.h"
#include "sampling/test_folder.h"

namespace abn {
namespace {

static_assert(StrategyClass<FromFile>);

template <class Error>
std::string refusal(const SamplingTask& task, const std::string& path) {
  try {
    FromFile sampler(task, {path});
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(FromFile, WrittenPointsComeBackExactlyInBatches) {
  const TestFolder folder;
  const std::string path = folder.path() / "points.bin";
  const Extent plane{200, 137};
  std::vector<Vec2f> points;
  for (std::size_t i = 0; i < (1U << 20) + 3; ++i) points.push_back(to_plane(Rng(1, 0, i).uniform2(), plane));
  points[0] = {just_below(200.0F), just_below(137.0F)};
  write_points(path, {.position = points}, plane, PointFormat::utk_bin);

  FromFile sampler({.plane = plane, .budget = points.size(), .seed = 1}, {path});
  const Grid<PixelStats> pixels({1, 1});
  EXPECT_EQ(sampler.next({pixels}).position.size(), 1U << 20);
  EXPECT_EQ(sampler.next({pixels}).position.size(), 3U);
  EXPECT_TRUE(sampler.next({pixels}).empty());
  EXPECT_TRUE(sampler.next({pixels}).empty());
  FromFile again({.plane = plane, .budget = points.size(), .seed = 2}, {path});
  EXPECT_EQ(all_positions(again), points);
  EXPECT_TRUE(again.diagnostics().empty());
}

TEST(FromFile, PointsNeverReachTheFarBorder) {
  const TestFolder folder;
  const std::string path = folder.path() / "points.txt";
  std::ofstream(path) << "1\n0.99999999999999989 0.99999999999999989\n";
  for (std::uint32_t side = 1; side < 2000; ++side) {
    FromFile sampler({.plane = {side, side}, .budget = 1, .seed = 1}, {path});
    const Vec2f point = all_positions(sampler)[0];
    EXPECT_LT(point.x, static_cast<float>(side));
    EXPECT_EQ(static_cast<std::uint32_t>(point.x), side - 1);
  }
}

TEST(FromFile, WeightsAndPixelsAreHandedOn) {
  const TestFolder folder;
  const std::string path = folder.path() / "points.csv";
  std::ofstream(path) << "x,y,weight,pixel\n-0.25,0.5,2,0\n0.5,0.5,0.5,3\n";
  FromFile sampler({.plane = {2, 2}, .budget = 2, .seed = 1}, {path});
  const Grid<PixelStats> pixels({1, 1});
  const SampleBatch batch = sampler.next({pixels});
  ASSERT_EQ(batch.position.size(), 2U);
  EXPECT_EQ(batch.position[0], (Vec2f{-0.5F, 1.0F}));
  EXPECT_EQ(batch.weight[0], 2.0F);
  EXPECT_EQ(batch.pixel[1], 3U);

  const std::string message = refusal<ConfigError>({.plane = {1, 2}, .budget = 2, .seed = 1}, path);
  EXPECT_NE(message.find("point 1 belongs to pixel 3, but the plane has 2"), std::string::npos) << message;
}

TEST(FromFile, AnotherCountIsRefusedWithTheFlag) {
  const TestFolder folder;
  const std::string path = folder.path() / "points.dat";
  std::ofstream(path) << "0.5 0.5\n0.25 0.25\n0.1 0.1\n";
  for (const std::uint64_t budget : {2, 4}) {
    const std::string message = refusal<ConfigError>({.plane = {2, 2}, .budget = budget, .seed = 1}, path);
    EXPECT_NE(message.find("points.dat' holds 3 points"), std::string::npos) << message;
    EXPECT_NE(message.find("--samples 3"), std::string::npos) << message;
  }
}

TEST(FromFile, MoreRealisationsAreAWarning) {
  const TestFolder folder;
  const std::string path = folder.path() / "points.dat";
  std::ofstream(path) << "0.5 0.5\n#\n0.25 0.25\n";
  FromFile sampler({.plane = {2, 2}, .budget = 1, .seed = 1}, {path});
  ASSERT_EQ(sampler.diagnostics().size(), 1U);
  EXPECT_TRUE(sampler.diagnostics()[0].warning);
  EXPECT_NE(sampler.diagnostics()[0].text.find("2 realisations"), std::string::npos);
}

TEST(FromFile, MissingPathIsAWordMissingFileIsAFile) {
  EXPECT_NE(refusal<ConfigError>({.plane = {2, 2}, .budget = 1, .seed = 1}, "").find("file:PATH"), std::string::npos);
  EXPECT_NE(refusal<IoError>({.plane = {2, 2}, .budget = 1, .seed = 1}, "/no/such.dat").find("/no/such.dat"),
            std::string::npos);
}

}  // namespace
}  // namespace abn
