// A device that is a loop on the host: every launch block by block and thread by thread, in an order that can be
// chosen, on arrays of exactly their size, so that the address sanitizer sees a kernel that reads or writes past one.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "sph_cuda/host_memory.h"

namespace abn::sph_cuda {

/// In what order the blocks and threads of a launch run. Results must not depend on it.
enum class LaunchOrder : std::uint8_t { forward, backward, scattered };

class HostDevice {
 public:
  static constexpr const char* name = "host loop";

  HostDevice() = default;
  explicit HostDevice(LaunchOrder order) : order_(order) {}

  template <class T>
  class Buffer {
   public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept
        : data_(std::exchange(other.data_, nullptr)), count_(std::exchange(other.count_, 0)) {}
    Buffer& operator=(Buffer&& other) noexcept {
      std::swap(data_, other.data_);
      std::swap(count_, other.count_);
      return *this;
    }
    ~Buffer() { reset(0); }

    void reset(std::size_t count) {
      static_assert(std::is_trivially_copyable_v<T>);
      if (data_ != nullptr) HostMemory::give_back(std::exchange(data_, nullptr));
      count_ = count;
      if (count > 0) data_ = static_cast<T*>(HostMemory::take(count * sizeof(T)));
    }
    void upload(std::span<const T> values) {
      assert(values.size() == count_);
      upload_at(0, values);
    }
    void upload(const std::vector<T>& values) { upload(std::span<const T>(values)); }
    void upload_at(std::size_t first, std::span<const T> values) {
      assert(first + values.size() <= count_);
      const HostMemory::Access access(data_, count_ * sizeof(T));
      std::copy(values.begin(), values.end(), data_ + first);
    }
    std::vector<T> download(std::size_t count) const { return download_at(0, count); }
    std::vector<T> download_at(std::size_t first, std::size_t count) const {
      assert(first + count <= count_);
      const HostMemory::Access access(data_, count_ * sizeof(T));
      return {data_ + first, data_ + first + count};
    }
    T* data() { return data_; }
    const T* data() const { return data_; }
    std::size_t size() const { return count_; }

   private:
    T* data_ = nullptr;
    std::size_t count_ = 0;
  };

  template <class Body>
  void launch(std::uint32_t n, const Body& body) const {
    constexpr std::uint32_t threads = 128;
    HostMemory::check_pointers(body);
    const HostMemory::Access access;
    for_each((n + threads - 1) / threads, [&](std::uint32_t block) {
      for_each(threads, [&](std::uint32_t thread) {
        const std::uint64_t i = std::uint64_t{block} * threads + thread;
        if (i < n) body(static_cast<std::uint32_t>(i));
      });
    });
  }

  template <class Body>
  void launch_blocks(std::uint32_t blocks, const Body& body) const {
    HostMemory::check_pointers(body);
    const HostMemory::Access access;
    for_each(blocks, [&](std::uint32_t block) {
      const auto shared = std::make_unique_for_overwrite<unsigned char[]>(body.shared_bytes());
      std::memset(shared.get(), 0xCD, body.shared_bytes());
      for (int phase = 0; phase < body.phases(block); ++phase) {
        for_each(Body::threads, [&](std::uint32_t thread) { body(phase, block, thread, shared.get()); });
      }
    });
  }

  void prepare_sums(std::uint32_t) const {}
  void exclusive_sum(const std::uint32_t* in, std::uint32_t* out, std::uint32_t n) const {
    const HostMemory::Access access;
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      out[i] = sum;
      sum += in[i];
    }
  }

  void prepare_sort(std::uint32_t) const {}
  void sort_pairs(const std::uint64_t* key, std::uint64_t* sorted_key, const std::uint32_t* value,
                  std::uint32_t* sorted_value, std::uint32_t n) const {
    const HostMemory::Access access;
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
    for (std::uint32_t i = 0; i < n; ++i) {
      sorted_key[i] = key[order[i]];
      sorted_value[i] = value[order[i]];
    }
  }

  template <class Enqueue>
  void replay(const void*, int, const Enqueue& enqueue) const {
    enqueue();
  }
  void forget(const void*) const {}

 private:
  template <class F>
  void for_each(std::uint32_t count, const F& f) const {
    for (std::uint32_t k = 0; k < count; ++k) {
      if (order_ == LaunchOrder::forward) f(k);
      if (order_ == LaunchOrder::backward) f(count - 1 - k);
    }
    if (order_ != LaunchOrder::scattered) return;
    // Strides of 7: 0, 7, 14, …, then 1, 8, …
    for (std::uint32_t first = 0; first < 7; ++first) {
      for (std::uint64_t k = first; k < count; k += 7) f(static_cast<std::uint32_t>(k));
    }
  }

  LaunchOrder order_ = LaunchOrder::forward;
};

}  // namespace abn::sph_cuda
