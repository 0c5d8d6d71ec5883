// What CudaDevice leaves to CUB.
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "sph_cuda/cuda_device.h"

namespace abn::sph_cuda {
namespace {

constexpr int key_bits = 64;

}  // namespace

void CudaDevice::prepare_sums(std::uint32_t n) {
  std::size_t bytes = 0;
  const std::uint32_t* in = nullptr;
  std::uint32_t* out = nullptr;
  check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, in, out, n, stream()), "cub::DeviceScan");
  reserve(bytes);
}

void CudaDevice::exclusive_sum(const std::uint32_t* in, std::uint32_t* out, std::uint32_t n) {
  std::size_t bytes = scratch_.size();
  check(cub::DeviceScan::ExclusiveSum(scratch_.data(), bytes, in, out, n, stream()), "cub::DeviceScan");
}

void CudaDevice::prepare_sort(std::uint32_t n) {
  std::size_t bytes = 0;
  const std::uint64_t* key = nullptr;
  const std::uint32_t* value = nullptr;
  std::uint64_t* sorted_key = nullptr;
  std::uint32_t* sorted_value = nullptr;
  check(cub::DeviceRadixSort::SortPairs(nullptr, bytes, key, sorted_key, value, sorted_value, n, 0, key_bits, stream()),
        "cub::DeviceRadixSort");
  reserve(bytes);
}

void CudaDevice::sort_pairs(const std::uint64_t* key, std::uint64_t* sorted_key, const std::uint32_t* value,
                            std::uint32_t* sorted_value, std::uint32_t n) {
  if (n == 0) return;
  std::size_t bytes = scratch_.size();
  check(cub::DeviceRadixSort::SortPairs(scratch_.data(), bytes, key, sorted_key, value, sorted_value, n, 0, key_bits,
                                        stream()),
        "cub::DeviceRadixSort");
}

}  // namespace abn::sph_cuda
