#include "harness/fallback_plane.h"

#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "sampling/error.h"

namespace abn::harness {
namespace {

class FallbackPlane final : public AdaptivePlane {
 public:
  FallbackPlane(const AdaptivePlaneOptions& options, const AdaptivePlaneFactory& on_device,
                std::function<void(const std::string&)> tell)
      : options_(options), tell_(std::move(tell)) {
    try {
      plane_ = on_device(options);
    } catch (const DeviceError& error) {
      go_on_here(error);
    }
  }

  void add(std::span<const Vec2f> position, std::span<const float> value, std::span<const float> light,
           std::uint32_t channels) override {
    const Added added{
        {position.begin(), position.end()}, {value.begin(), value.end()}, {light.begin(), light.end()}, channels};
    attempt([&] { plane_->add(added.position, added.value, added.light, channels); });
    if (!fallen_) past_.emplace_back(added);
  }
  Grid<float> driver() override {
    return attempt([&] { return plane_->driver(); });
  }
  double uniform_share() override {
    return attempt([&] { return plane_->uniform_share(); });
  }
  std::vector<Vec2f> add_by_density(const DensityPass& pass) override {
    std::vector<Vec2f> placed = attempt([&] { return plane_->add_by_density(pass); });
    if (!fallen_) past_.emplace_back(pass);
    return placed;
  }
  std::vector<Vec2f> refine(std::size_t count, std::uint64_t seed) override {
    return attempt([&] { return plane_->refine(count, seed); });
  }
  double straight_edge_share() override {
    return attempt([&] { return plane_->straight_edge_share(); });
  }
  std::span<const Vec2f> ghosts() const override { return plane_->ghosts(); }
  const char* backend() const override { return plane_->backend(); }

 private:
  struct Added {
    std::vector<Vec2f> position;
    std::vector<float> value, light;
    std::uint32_t channels = 1;
  };

  template <class F>
  auto attempt(const F& f) -> decltype(f()) {
    if (fallen_) return f();
    try {
      return f();
    } catch (const DeviceError& error) {
      go_on_here(error);
    }
    return f();
  }

  void go_on_here(const DeviceError& error) {
    tell_(error.what());
    fallen_ = true;
    plane_ = make_adaptive_plane(options_);
    for (const auto& event : past_) {
      if (const auto* added = std::get_if<Added>(&event)) {
        plane_->add(added->position, added->value, added->light, added->channels);
      } else {
        plane_->add_by_density(std::get<DensityPass>(event));  // for its density; its samples are added later
      }
    }
    past_.clear();
  }

  AdaptivePlaneOptions options_;
  std::function<void(const std::string&)> tell_;
  std::unique_ptr<AdaptivePlane> plane_;
  std::vector<std::variant<Added, DensityPass>> past_;
  bool fallen_ = false;
};

}  // namespace

AdaptivePlaneFactory with_fallback(AdaptivePlaneFactory on_device, std::function<void(const std::string&)> tell) {
  return [on_device = std::move(on_device), tell = std::move(tell)](const AdaptivePlaneOptions& options) {
    return std::make_unique<FallbackPlane>(options, on_device, tell);
  };
}

}  // namespace abn::harness
