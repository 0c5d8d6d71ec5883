// abn_selftest: does this machine's GPU compute what the host computes?
//
// Every ABN_HD function that the engine's kernels are made of is run on random inputs by a kernel and by the host, by
// the same code. Integers and placements must be equal, floats within 1e-6 relative.
// Exit status: 0 all equal, 1 a mismatch or a CUDA error, 77 no device (the status by which ctest skips a test).
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include "sampling/rng.h"
#include "sampling/sph/model.h"
#include "sampling/sph/size_field.h"
#include "sampling/vec.h"
#include "sph_cuda/buffer.h"
#include "sph_cuda/check.h"
#include "sph_cuda/device.h"

namespace abn::sph_cuda {
namespace {

constexpr std::uint32_t count = 1U << 16;  // inputs per test
constexpr std::uint32_t block = 256;
constexpr double tolerance = 1e-6;

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
                                                   "advance.ok",
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
    const bool ok = sph::advance(vx, vy, i % 16 == 0 ? INFINITY : 5.0F * (rng.uniform() - 0.5F), rng.uniform() - 0.5F,
                                 1.2F, 0.6F, 0.3F);
    out[i] = {{factor, sph::kernel_constant(support), sph::density_term(r2, factor / support), pressure_i, weight,
               offset_x, offset_y, vx, vy, ok ? 1.0F : 0.0F, sph::wrap(1000.0F * (rng.uniform() - 0.5F), 37.5F),
               sph::bilinear_periodic(field, 16, 9, 16.0F * rng.uniform(), 9.0F * rng.uniform())}};
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

bool run() {
  bool good = true;
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

int main() {
  try {
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
    }
    std::printf("%s\n", good ? "the devices compute what the host computes" : "MISMATCH between host and device");
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "abn_selftest: %s\n", error.what());
    return 1;
  }
}
