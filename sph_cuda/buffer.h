// Device memory that frees itself.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sph_cuda/check.h"

namespace abn::sph_cuda {

/// Values of T on the current device; move-only, uninitialised until uploaded. Copies are synchronous: they come after
/// everything in the streams that do not opt out of waiting for the default stream.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t count) { reset(count); }
  explicit Buffer(const std::vector<T>& host) : Buffer(host.size()) { upload(host); }
  Buffer(Buffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)),
        count_(std::exchange(other.count_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  Buffer& operator=(Buffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
    std::swap(capacity_, other.capacity_);
    return *this;
  }
  ~Buffer() { cudaFree(data_); }

  /// Room for `count` values; what was there is lost. Memory once taken is kept for later, and a buffer that grows
  /// takes a quarter more than it needs. Throws DeviceError where the device has no such memory left.
  void reset(std::size_t count) {
    if (count <= capacity_) {
      count_ = count;
      return;
    }
    const std::size_t asked = count;
    if (capacity_ > 0) count += count / 4;
    check(cudaFree(std::exchange(data_, nullptr)), "cudaFree");
    count_ = capacity_ = 0;
    const cudaError_t status = cudaMalloc(reinterpret_cast<void**>(&data_), count * sizeof(T));
    if (status == cudaErrorMemoryAllocation) {
      cudaGetLastError();  // not sticky, and told here
      std::size_t free = 0;
      std::size_t total = 0;
      check(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
      throw DeviceError("the CUDA device has " + std::to_string(free >> 20) + " of " + std::to_string(total >> 20) +
                        " MiB left, and " + std::to_string((count * sizeof(T) >> 20) + 1) +
                        " MiB more are needed; ask for fewer samples or use --backend cpu");
    }
    check(status, "cudaMalloc");
    capacity_ = count;
    count_ = asked;
  }
  void upload(std::span<const T> host) {
    check(cudaMemcpy(data_, host.data(), host.size_bytes(), cudaMemcpyHostToDevice), "copy to device");
  }
  void upload(const std::vector<T>& host) { upload(std::span<const T>(host)); }
  void upload_at(std::size_t first, std::span<const T> host) {
    check(cudaMemcpy(data_ + first, host.data(), host.size_bytes(), cudaMemcpyHostToDevice), "copy to device");
  }
  std::vector<T> download(std::size_t count) const { return download_at(0, count); }
  std::vector<T> download_at(std::size_t first, std::size_t count) const {
    std::vector<T> host(count);
    check(cudaMemcpy(host.data(), data_ + first, count * sizeof(T), cudaMemcpyDeviceToHost), "copy to host");
    return host;
  }
  std::vector<T> to_host() const { return download(count_); }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return count_; }

 private:
  T* data_ = nullptr;
  std::size_t count_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace abn::sph_cuda
