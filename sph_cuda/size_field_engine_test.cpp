// The device's preparation of a size field without a device, bit for bit against the host's.
#include "sph_cuda/size_field_engine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "sampling/rng.h"
#include "sampling/sph/size_field_cases.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

sph::FieldOptions options_for(double length_x, double length_y, bool walls) {
  sph::FieldOptions options;
  options.length_x = length_x;
  options.length_y = length_y;
  options.count = length_x * length_y;
  options.walls = walls;
  options.background = false;
  return options;
}

/// Some large values among many small ones.
Grid<float> rough_field(Extent size, double exponent) {
  Grid<float> s(size);
  for (std::size_t i = 0; i < s.cells().size(); ++i) {
    const double u = double{Rng(11, stream_id("rough field"), i).uniform()};
    s[i] = static_cast<float>(0.1 + 6 * std::pow(u, exponent));
  }
  return s;
}

void expect_same(SizeFieldEngine<HostDevice>& engine, HostDevice& device, const Grid<float>& s,
                 const sph::FieldOptions& options, const std::string& where) {
  const sph::SizeField expected = sph::prepare_size_field(s, options);
  const auto copy = on_device(s);
  engine.prepare(device, copy.data(), s.size(), options);
  const sph::SizeField& field = engine.field();
  ASSERT_EQ(field.uniform, expected.uniform) << where;
  EXPECT_EQ(field.length_x, expected.length_x) << where;
  EXPECT_EQ(field.length_y, expected.length_y) << where;
  EXPECT_EQ(field.margin_x, expected.margin_x) << where;
  EXPECT_EQ(field.margin_y, expected.margin_y) << where;
  EXPECT_EQ(field.smallest, expected.smallest) << where;
  EXPECT_EQ(field.largest, expected.largest) << where;
  EXPECT_EQ(field.width, expected.width) << where;
  EXPECT_EQ(field.height, expected.height) << where;
  EXPECT_TRUE(field.cells.empty());
  const std::size_t cells = expected.cells.size();
  ASSERT_EQ(std::size_t{field.width} * field.height, cells) << where;
  EXPECT_TRUE(cells == 0 || same_bits<sph::FieldCell>(engine.cells(), expected.cells.data(), cells)) << where;
  const std::vector<double> density = expected.uniform ? std::vector<double>{} : sph::tile_densities(expected);
  EXPECT_EQ(engine.tile_density(), density) << where;
}

/// One engine for all of them: what an earlier field left behind must not matter.
TEST(SizeFieldEngine, EqualsTheHostBitForBit) {
  HostDevice device;
  SizeFieldEngine<HostDevice> engine;
  std::vector<std::string> words = {"smooth:100", "step:100"};
  for (const sph::SizeFieldCase& field : sph::size_field_cases()) words.push_back(field.name);
  for (const bool walls : {false, true}) {
    for (const std::string& word : words) {
      for (const Extent size : {Extent{60, 44}, Extent{9, 5}, Extent{150, 3}}) {
        expect_same(engine, device, sph::make_size_field(word, size), options_for(40, 29, walls),
                    word + " " + std::to_string(size.width) + (walls ? " walls" : ""));
      }
    }
  }
}

/// Finer than the particles can follow.
TEST(SizeFieldEngine, ReducesARasterAsTheHost) {
  HostDevice device;
  SizeFieldEngine<HostDevice> engine;
  for (const bool walls : {false, true}) {
    for (const char* word : {"constant", "smooth", "disc:2"}) {
      for (const Extent size : {Extent{161, 140}, Extent{61, 500}}) {
        const sph::FieldOptions options = options_for(20, 14, walls);
        expect_same(engine, device, sph::make_size_field(word, size), options, word);
        EXPECT_TRUE(engine.field().uniform || walls || engine.field().width * engine.field().height < size.area() / 2);
      }
    }
  }
}

TEST(SizeFieldEngine, EqualsTheHostOnRoughAndTinyFields) {
  HostDevice device;
  SizeFieldEngine<HostDevice> engine;
  for (const bool walls : {false, true}) {
    for (const Extent size : {Extent{1, 1}, Extent{2, 1}, Extent{1, 5}, Extent{2, 3}, Extent{33, 65}, Extent{97, 34}}) {
      for (const double exponent : {1.0, 12.0}) {
        for (const double limit : {0.02, 0.3, 1.0, 20.0}) {
          sph::FieldOptions options = options_for(45, 60, walls);
          options.gradient_limit = limit;
          options.support = 2.5;
          expect_same(engine, device, rough_field(size, exponent), options,
                      std::to_string(size.width) + " wide, limit " + std::to_string(limit) + (walls ? " walls" : ""));
        }
      }
    }
    // Few particles: every spacing that is wished is cut to that of one on the plane.
    expect_same(engine, device, sph::make_size_field("step:1000", {64, 40}), options_for(1.5, 1.2, walls), "few");
    expect_same(engine, device, rough_field({2100, 7}, 12), options_for(1500, 5, walls), "long rows");
  }
}

/// The gradient's limit takes many launches here: from one small value it spreads over the whole raster.
TEST(SizeFieldEngine, DoesNotDependOnTheOrderOfThreads) {
  Grid<float> crater({160, 90}, 9.0F);
  crater.at(3, 80) = 0.5F;
  for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered}) {
    HostDevice device(order);
    SizeFieldEngine<HostDevice> engine;
    for (const bool walls : {false, true}) {
      sph::FieldOptions options = options_for(100, 60, walls);
      const std::string where = "order " + std::to_string(static_cast<int>(order)) + (walls ? " walls" : "");
      expect_same(engine, device, rough_field({100, 80}, 12), options, where);
      options.gradient_limit = 0.01;
      expect_same(engine, device, crater, options, where + " crater");
    }
  }
}

}  // namespace
}  // namespace abn::sph_cuda
