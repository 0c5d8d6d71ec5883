#include "harness/fallback_plane.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "sampling/adaptive/sph_adaptive.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

/// A plane whose device fails at its `fails_at`-th call.
class FailingPlane final : public AdaptivePlane {
 public:
  FailingPlane(const AdaptivePlaneOptions& options, int fails_at)
      : plane_(make_adaptive_plane(options)), calls_left_(fails_at) {
    count();
  }
  void add(std::span<const Vec2f> position, std::span<const float> value, std::span<const float> light,
           std::uint32_t channels) override {
    count();
    plane_->add(position, value, light, channels);
  }
  Grid<float> driver() override {
    count();
    return plane_->driver();
  }
  double uniform_share() override {
    count();
    return plane_->uniform_share();
  }
  std::vector<Vec2f> add_by_density(const DensityPass& pass) override {
    count();
    return plane_->add_by_density(pass);
  }
  std::vector<Vec2f> refine(std::size_t wanted, std::uint64_t seed) override {
    count();
    return plane_->refine(wanted, seed);
  }
  double straight_edge_share() override {
    count();
    return plane_->straight_edge_share();
  }
  std::span<const Vec2f> ghosts() const override { return plane_->ghosts(); }
  const char* backend() const override { return "device"; }

 private:
  void count() {
    if (calls_left_-- == 0) throw DeviceError("no memory left");
  }
  std::unique_ptr<AdaptivePlane> plane_;
  int calls_left_;
};

struct Emitted {
  std::vector<Vec2f> position;
  std::string backend;
};

Emitted emit(const AdaptivePlaneFactory& factory) {
  SamplingTask task{.plane = {20, 20}, .budget = 1600, .seed = 3, .cache = false};
  task.adaptive_plane = factory;
  Emitted all;
  const auto sampler = row<SphAdaptive>().make(task, {{"refine", "always"}});
  const Grid<PixelStats> unused(task.plane);
  std::vector<float> values;
  for (;;) {
    const SampleBatch batch = sampler->next({unused, values});
    if (batch.empty()) break;
    values.clear();
    for (const Vec2f p : batch.position) values.push_back(p.x * p.y > 130 ? 1.0F : 0.0F);
    all.position.insert(all.position.end(), batch.position.begin(), batch.position.end());
  }
  for (const Diagnostic& d : sampler->diagnostics()) {
    if (d.name == "backend") all.backend = d.text;
  }
  return all;
}

TEST(FallbackPlane, GoesOnWhereTheDeviceFailed) {
  const Emitted expected = emit(nullptr);
  ASSERT_EQ(expected.position.size(), 1600U);
  int failures = 0;
  for (int fails_at = 0; fails_at < 20; ++fails_at) {
    std::vector<std::string> told;
    const Emitted got = emit(with_fallback(
        [&](const AdaptivePlaneOptions& options) { return std::make_unique<FailingPlane>(options, fails_at); },
        [&](const std::string& words) { told.push_back(words); }));
    EXPECT_EQ(got.position, expected.position) << "fails at call " << fails_at;
    EXPECT_EQ(got.backend, told.empty() ? "device" : expected.backend);
    EXPECT_LE(told.size(), 1U);
    for (const std::string& words : told) EXPECT_EQ(words, "no memory left");
    failures += static_cast<int>(told.size());
  }
  EXPECT_GT(failures, 8);   // in every stage
  EXPECT_LT(failures, 20);  // and a run without
}

}  // namespace
}  // namespace abn::harness
