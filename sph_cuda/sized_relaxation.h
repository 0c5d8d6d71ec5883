// Particles in a size field that is prepared on the device, with its ring of ghosts: nothing but a few numbers passes
// through the host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampling/sph/problem.h"
#include "sampling/vec.h"
#include "sph_cuda/ghost_engine.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/relaxation.h"
#include "sph_cuda/size_field_engine.h"

namespace abn::sph_cuda {

/// Places [px] to places on the torus [d].
struct PlaceOnTorus {
  const Vec2f* position;
  double spacing;  // d [px]
  float length_x, length_y;
  float* x;
  float* y;
  ABN_HD void operator()(std::uint32_t i) const {
    x[i] = sph::wrap(static_cast<float>(static_cast<double>(position[i].x) / spacing), length_x);
    y[i] = sph::wrap(static_cast<float>(static_cast<double>(position[i].y) / spacing), length_y);
  }
};
/// And back.
struct PlaceOnPlane {
  const float* x;
  const float* y;
  double spacing;
  float right, bottom;  // the last places inside
  Vec2f* position;
  ABN_HD void operator()(std::uint32_t i) const {
    const auto px = static_cast<float>(static_cast<double>(x[i]) * spacing);
    const auto py = static_cast<float>(static_cast<double>(y[i]) * spacing);
    position[i] = {px < right ? px : right, py < bottom ? py : bottom};
  }
};
inline PlaceOnPlane place_on_plane(const float* x, const float* y, double spacing, Extent plane, Vec2f* position) {
  return {
      x,       y, spacing, just_below(static_cast<float>(plane.width)), just_below(static_cast<float>(plane.height)),
      position};
}

template <class T>
struct Copy {
  const T* from;
  T* to;
  ABN_HD void operator()(std::uint32_t i) const { to[i] = from[i]; }
};

template <class Device>
class SizedRelaxation {
 public:
  SizedRelaxation(Device& device, Relaxation<Device>& relaxation) : device_(device), relaxation_(relaxation) {}

  /// Prepares the field s [map], > 0 and finite, for the particles at `position` [px], makes the ring, and hands them
  /// all to the relaxation, nobody fixed. Returns the problem without raster and positions. Precondition: no background
  /// force, no classes. Throws DeviceError for too many particles or too little memory.
  sph::Problem place(const sph::Setup& setup, const float* s, Extent map, const Vec2f* position,
                     std::uint32_t particles) {
    sph::Problem problem = sph::problem_without_field(setup, particles);
    sizes_.prepare(device_, s, map, sph::field_options(setup, problem));
    sph::set_field(setup, sizes_.field(), sizes_.tile_density(), problem);
    const sph::FieldCell* field = problem.field.uniform ? nullptr : sizes_.cells();
    ghosts_ = problem.walls ? ring_.find(setup, problem, field) : 0;
    relaxation_.reset(setup, problem, std::size_t{particles} + ghosts_, field);
    float* x = relaxation_.x();
    float* y = relaxation_.y();
    device_.launch(particles, PlaceOnTorus{position, problem.spacing, static_cast<float>(problem.field.length_x),
                                           static_cast<float>(problem.field.length_y), x, y});
    device_.launch(ghosts_, Copy<float>{ring_.x(), x + particles});
    device_.launch(ghosts_, Copy<float>{ring_.y(), y + particles});
    return problem;
  }
  std::uint32_t ghosts() const { return ghosts_; }

 private:
  Device& device_;
  Relaxation<Device>& relaxation_;
  SizeFieldEngine<Device> sizes_;
  GhostEngine<Device> ring_{device_};
  std::uint32_t ghosts_ = 0;
};

}  // namespace abn::sph_cuda
