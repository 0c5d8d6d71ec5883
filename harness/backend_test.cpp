#include "harness/backend.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

Film some_film() {
  Film film({4, 4}, 1, true);
  std::vector<Vec2f> position;
  std::vector<float> value;
  for (std::uint32_t i = 0; i < 60; ++i) {
    position.push_back(Rng(1, 2, i).uniform2() * 4);
    value.push_back(position.back().x);
  }
  film.add({.position = position}, value);
  return film;
}

PixelEstimates fail(const Film&, bool) { throw DeviceError("no memory left"); }

TEST(Backend, DevelopsOnTheDevice) {
  const Film film = some_film();
  int calls = 0;
  Backend backend;
  backend.estimate = [&](const Film& given, bool steps) {
    ++calls;
    EXPECT_FALSE(steps);
    PixelEstimates estimates;
    estimates.value.assign(16, 0.5F);
    estimates.scale = Grid<PixelScale>({4, 4}, PixelScale{.unit_variance = 1, .degrees = 1});
    estimates.samples = given.samples();
    return estimates;
  };
  EXPECT_EQ(develop(film, find_reconstruction("kriging"), backend).image.texel(1, 1)[0], 0.5F);
  EXPECT_EQ(calls, 1);
  develop(film, find_reconstruction("mean"), backend);  // estimates nothing
  EXPECT_EQ(calls, 1);
}

TEST(Backend, FallsBackOnlyIfItMay) {
  const Film film = some_film();
  Backend backend;
  backend.estimate = fail;
  const Reconstruction& row = find_reconstruction("edge");
  EXPECT_THROW(develop(film, row, backend), DeviceError);
  backend.falls_back = true;
  EXPECT_EQ(develop(film, row, backend).image.texels, row.develop(film).image.texels);
}

TEST(Backend, KrigingAndEdgeRunOnDevices) {
  for (const Reconstruction& row : reconstructions()) {
    EXPECT_EQ(row.develop.runs_on_device(), row.name == "kriging" || row.name == "edge") << row.name;
  }
}

TEST(Backend, KnowsItsWords) {
  EXPECT_EQ(resolve_backend("cpu").name, "cpu");
  EXPECT_EQ(resolve_backend("cpu").estimate, nullptr);
  EXPECT_THROW(resolve_backend("gpu"), ConfigError);
}

}  // namespace
}  // namespace abn::harness
