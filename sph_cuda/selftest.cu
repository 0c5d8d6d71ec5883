// abn_selftest: does this machine's GPU compute what the host computes?
//
// Every ABN_HD function that the engine's kernels are made of is run on random inputs by a kernel and by the host, by
// the same code. Integers and placements must be equal, floats within 1e-6 relative, sums over neighbours within 1e-5.
// Then whole engines (selftest_engine.h), what their sets are worth, and adaptive downscales (selftest_statistics.h).
// With the word `large`, up to 20 million particles. Exit status: 0 all equal, 1 a mismatch or a CUDA error, 77 no
// device (the status by which ctest skips a test).
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "sampling/rng.h"
#include "sampling/sph/bodies.h"
#include "sampling/sph/model.h"
#include "sampling/sph/size_field.h"
#include "sampling/vec.h"
#include "sph_cuda/adaptive_plane.h"
#include "sph_cuda/buffer.h"
#include "sph_cuda/check.h"
#include "sph_cuda/device.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/kriging.h"
#include "sph_cuda/kriging_engine.h"
#include "sph_cuda/selftest_engine.h"
#include "sph_cuda/selftest_statistics.h"

namespace abn::sph_cuda {
namespace {

constexpr std::uint32_t count = 1U << 16;  // inputs per test
constexpr std::uint32_t block = 256;
constexpr double tolerance = 1e-6;
constexpr double body_tolerance = 1e-5;  // of a sum

/// Runs body(i) for i in [0,count); launch: one thread per index, no shared memory, writes only its own index.
template <class Body>
__global__ void run_kernel(Body body) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) body(i);
}

/// The results of `body`, which writes to its member `out`, on the host and on the device.
template <class Out, class Body>
void run_both(Body body, std::vector<Out>& host, std::vector<Out>& device) {
  host.resize(count);
  body.out = host.data();
  for (std::uint32_t i = 0; i < count; ++i) body(i);
  Buffer<Out> buffer(count);
  body.out = buffer.data();
  run_kernel<<<(count + block - 1) / block, block>>>(body);
  check(cudaGetLastError(), "kernel launch");
  check(cudaDeviceSynchronize(), "kernel");
  device = buffer.to_host();
}

/// 128 bits of Philox per index.
struct PhiloxWords {
  Philox4* out;
  ABN_HD void operator()(std::uint32_t i) const {
    Rng rng(0x0123456789ABCDEFULL + i, 77, std::uint64_t{i} << 20);
    for (int draw = 0; draw < 5; ++draw) rng.next();
    out[i] = {{rng.next(), rng.below(i + 1), rng.below(1000), rng.next()}};
  }
};

/// Placement on planes of many sizes, with offsets up to the last float below the border.
struct Placement {
  Vec2f* out;
  ABN_HD void operator()(std::uint32_t i) const {
    Rng rng(1, 2, i);
    const Vec2f unit = i % 4 == 0 ? Vec2f{just_below(1.0F), rng.uniform()} : rng.uniform2();
    const Extent plane{1 + rng.below(5000), 1 + rng.below(5000)};
    out[i] = i % 2 == 0 ? to_plane(unit, plane) : to_pixel(unit, rng.below(plane.width), rng.below(plane.height));
  }
};

constexpr int model_values = 12;

/// Every function of sph/model.h and the size field on one random pair.
struct ModelValues {
  float value[model_values];
};
constexpr const char* model_names[model_values] = {"warp",
                                                   "kernel_constant",
                                                   "density_term",
                                                   "pressure",
                                                   "force_term",
                                                   "coincident_offset.x",
                                                   "coincident_offset.y",
                                                   "advance.vx",
                                                   "advance.vy",
                                                   "advance",
                                                   "wrap",
                                                   "bilinear_periodic"};

struct Model {
  ModelValues* out;
  const float* field;  // [16*9], where this side can read it
  ABN_HD void operator()(std::uint32_t i) const {
    Rng rng(3, 4, i);
    const float size_i = 0.1F + 3.0F * rng.uniform();
    const float size_j = 0.1F + 3.0F * rng.uniform();
    const float support = 0.5F + 4.0F * rng.uniform();
    const float dx = 4.0F * (rng.uniform() - 0.5F);
    const float dy = 4.0F * (rng.uniform() - 0.5F);
    const float r2 = dx * dx + dy * dy;
    const float factor = sph::warp(size_i, size_j);
    const float density = 0.3F + rng.uniform();
    const float pressure_i = sph::pressure(density, 1.0F, 1.0F / 0.3F);
    const float weight = sph::force_term(r2, factor / support, pressure_i, 1.0F);
    float offset_x, offset_y;
    sph::coincident_offset(i, rng.below(100000), offset_x, offset_y);
    float vx = rng.uniform() - 0.5F;
    float vy = rng.uniform() - 0.5F;
    const float moved = sph::advance(vx, vy, i % 16 == 0 ? INFINITY : 5.0F * (rng.uniform() - 0.5F),
                                     rng.uniform() - 0.5F, 1.2F, 0.6F, 0.3F);
    out[i] = {{factor, sph::kernel_constant(support), sph::density_term(r2, factor / support), pressure_i, weight,
               offset_x, offset_y, vx, vy, moved, sph::wrap(1000.0F * (rng.uniform() - 0.5F), 37.5F),
               sph::bilinear_periodic(field, 16, 9, 16.0F * rng.uniform(), 9.0F * rng.uniform())}};
  }
};

/// A plane of particles sorted into cells, as the engine's passes see it: a torus of 64 x 64 spacings, one tile, sizes
/// and reaches that differ.
class SortedPlane {
 public:
  static constexpr std::uint32_t particles = 4096;
  static constexpr float length = 64;

  SortedPlane() : tiles_(1), start_(rows * columns + 1, 0), x_(padded), y_(padded), size_(padded), id_(padded) {
    tiles_[0].columns = columns;
    tiles_[0].rows = rows;
    tiles_[0].inverse_width = columns / length;
    tiles_[0].inverse_height = rows / length;
    const sph::CellView<float> cells = view().cells;
    std::vector<std::uint32_t> cell(particles);
    std::vector<Vec2f> place(particles);
    for (std::uint32_t i = 0; i < particles; ++i) {
      place[i] = Rng(7, 8, i).uniform2() * length;
      cell[i] = cells.cell(place[i].x, place[i].y);
      ++start_[cell[i] + 1];
    }
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::uint32_t> next = start_;
    for (std::uint32_t i = 0; i < particles; ++i) {
      const std::uint32_t to = next[cell[i]]++;
      x_[to] = place[i].x;
      y_[to] = place[i].y;
      size_[to] = 0.6F + 0.6F * Rng(9, 10, i).uniform();
      id_[to] = i;
    }
  }
  sph::ParticleView<float> view() const { return view_of(tiles_, start_, x_, y_, size_, id_); }
  /// The same on the device, as long as this object lives.
  sph::ParticleView<float> device_view() {
    on_device_ = std::make_unique<OnDevice>(*this);
    return view_of(on_device_->tiles, on_device_->start, on_device_->x, on_device_->y, on_device_->size,
                   on_device_->id);
  }

 private:
  static constexpr std::uint32_t rows = 32, columns = 128, padded = particles + 8;

  struct OnDevice {
    explicit OnDevice(const SortedPlane& plane)
        : tiles(plane.tiles_), start(plane.start_), x(plane.x_), y(plane.y_), size(plane.size_), id(plane.id_) {}
    Buffer<sph::Tile<float>> tiles;
    Buffer<std::uint32_t> start;
    Buffer<float> x, y, size;
    Buffer<std::uint32_t> id;
  };

  template <class Tiles, class Indices, class Floats>
  static sph::ParticleView<float> view_of(const Tiles& tiles, const Indices& start, const Floats& x, const Floats& y,
                                          const Floats& size, const Indices& id) {
    sph::ParticleView<float> view;
    view.cells.tiles = tiles.data();
    view.cells.length_x = view.cells.length_y = length;
    view.cells.tiles_per_x = view.cells.tiles_per_y = 1 / length;
    view.cell_start = start.data();
    view.x = x.data();
    view.y = y.data();
    view.size = size.data();
    view.reach = size.data();  // a bound is not needed to compare, only the same one on both sides
    view.pressure = size.data();
    view.id = id.data();
    return view;
  }

  std::vector<sph::Tile<float>> tiles_;
  std::vector<std::uint32_t> start_;
  std::vector<float> x_, y_, size_;
  std::vector<std::uint32_t> id_;
  std::unique_ptr<OnDevice> on_device_;
};

/// Density and force of a particle by the bodies of the engine's kernels, for one kernel function, uniform or sized.
template <sph::Terms terms>
struct Bodies {
  ModelValues* out;
  sph::ParticleView<float> view;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t particle = i % SortedPlane::particles;
    const sph::Force<float> force = sph::force_on<terms>(view, particle);
    out[i] = {{sph::density_of<terms>(view, particle).all, force.x, force.y}};
  }
};

template <class T>
bool report_bitwise(const char* name, const std::vector<T>& host, const std::vector<T>& device) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (std::memcmp(&host[i], &device[i], sizeof(T)) != 0) {
      std::printf("FAILED %-20s differs at input %u\n", name, i);
      return false;
    }
  }
  std::printf("ok     %-20s %u inputs, equal bit for bit\n", name, count);
  return true;
}

/// |a - b| relative to the larger of them, or to `floor` where both are small because terms cancelled.
double relative_difference(double a, double b, double floor) {
  if (std::isnan(a) || std::isnan(b)) return INFINITY;
  const double scale = std::fmax(floor, std::fmax(std::fabs(a), std::fabs(b)));
  return std::fabs(a - b) / scale;
}

/// The bodies on both sides: sums of some 13 terms in the same order.
template <sph::Terms terms>
bool report_bodies(const char* name, SortedPlane& plane) {
  std::vector<ModelValues> host(count);
  Bodies<terms> body{host.data(), plane.view()};
  for (std::uint32_t i = 0; i < count; ++i) body(i);
  Buffer<ModelValues> values(count);
  run_kernel<<<(count + block - 1) / block, block>>>(Bodies<terms>{values.data(), plane.device_view()});
  check(cudaGetLastError(), "kernel launch");
  check(cudaDeviceSynchronize(), "kernel");
  const std::vector<ModelValues> device = values.to_host();
  double worst = 0;
  std::uint32_t different = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) {
      worst = std::fmax(worst, relative_difference(host[i].value[k], device[i].value[k], 1e-1));
      different += host[i].value[k] != device[i].value[k] ? 1 : 0;
    }
  }
  std::printf("%s %-20s %u particles, largest relative difference %.3g, %u values not equal bit for bit\n",
              worst <= body_tolerance ? "ok    " : "FAILED", name, SortedPlane::particles, worst, different);
  return worst <= body_tolerance;
}

bool run() {
  bool good = true;
  SortedPlane plane;
  good &= report_bodies<sph::Terms{sph::Kernel::wendland, false, false}>("wendland", plane);
  good &= report_bodies<sph::Terms{sph::Kernel::wendland, true, false}>("wendland, sized", plane);
  good &= report_bodies<sph::Terms{sph::Kernel::poly6_spiky, true, false}>("poly6_spiky, sized", plane);
  good &= report_bodies<sph::Terms{sph::Kernel::cubic, true, false}>("cubic, sized", plane);
  std::vector<Philox4> words_host, words_device;
  run_both(PhiloxWords{}, words_host, words_device);
  good &= report_bitwise("philox4x32, Rng", words_host, words_device);

  std::vector<Vec2f> places_host, places_device;
  run_both(Placement{}, places_host, places_device);
  good &= report_bitwise("to_plane, to_pixel", places_host, places_device);

  std::vector<float> field(16 * 9);
  for (std::uint32_t i = 0; i < field.size(); ++i) field[i] = 0.1F + 10.0F * Rng(5, 6, i).uniform();
  const Buffer<float> field_on_device(field);
  std::vector<ModelValues> host(count);
  Model model{host.data(), field.data()};
  for (std::uint32_t i = 0; i < count; ++i) model(i);
  Buffer<ModelValues> values(count);
  run_kernel<<<(count + block - 1) / block, block>>>(Model{values.data(), field_on_device.data()});
  check(cudaGetLastError(), "kernel launch");
  check(cudaDeviceSynchronize(), "kernel");
  const std::vector<ModelValues> device = values.to_host();
  double largest = 0;
  for (int k = 0; k < model_values; ++k) {
    double worst = 0;
    std::uint32_t at = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double difference = relative_difference(host[i].value[k], device[i].value[k], 1e-2);
      if (difference > worst) {
        worst = difference;
        at = i;
      }
    }
    const bool equal = worst <= tolerance;
    std::printf("%s %-20s %u inputs, largest relative difference %.3g", equal ? "ok    " : "FAILED", model_names[k],
                count, worst);
    if (!equal) {
      std::printf(" at input %u: host %.9g, device %.9g", at, static_cast<double>(host[at].value[k]),
                  static_cast<double>(device[at].value[k]));
    }
    std::printf("\n");
    good &= equal;
    largest = std::fmax(largest, worst);
  }
  std::printf("largest relative difference %.3g (bar %.0e)\n", largest, tolerance);
  return good;
}

}  // namespace
}  // namespace abn::sph_cuda

int main(int count, char** words) {
  try {
    const bool large = count > 1 && std::strcmp(words[1], "large") == 0;
    if (count > 2 || (count == 2 && !large)) {
      std::fprintf(stderr, "usage: abn_selftest [large]\n");
      return 2;
    }
    const auto devices = abn::sph_cuda::list_devices();
    if (devices.empty()) {
      std::printf("abn_selftest: no CUDA device here; nothing was tested\n");
      return 77;
    }
    bool good = true;
    for (const auto& device : devices) {
      abn::sph_cuda::check(cudaSetDevice(device.index), "cudaSetDevice");
      std::printf("device %d: %s\n", device.index, abn::sph_cuda::describe_device(device).c_str());
      good &= abn::sph_cuda::run();
      good &= abn::sph_cuda::run_engine_tests(large);
      good &= abn::sph_cuda::run_statistics(abn::sph::make_cpu_solver, abn::sph_cuda::make_cuda_solver);
      const auto on_host = [](const abn::AdaptivePlaneOptions& options) { return abn::make_adaptive_plane(options); };
      good &= abn::sph_cuda::run_adaptive_tests(on_host, abn::sph_cuda::make_cuda_adaptive_plane_factory());
      const abn::SampleEstimator by_host_loop = [](auto... given) {
        return abn::sph_cuda::KrigingEngine<abn::sph_cuda::HostDevice>()(given...);
      };
      good &= abn::sph_cuda::run_picture_tests(by_host_loop, abn::sph_cuda::make_cuda_estimator());
    }
    std::printf("%s\n", good ? "the devices compute what the host computes" : "MISMATCH between host and device");
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "abn_selftest: %s\n", error.what());
    return 1;
  }
}
