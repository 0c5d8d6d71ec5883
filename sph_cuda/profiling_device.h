// A CUDA device that times every kernel: for benchmarks only, because it waits after each.
#pragma once

#include <cuda_runtime.h>
#include <cxxabi.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <typeinfo>

#include "sph_cuda/check.h"
#include "sph_cuda/cuda_device.h"

namespace abn::sph_cuda {

/// Time spent in every kind of kernel, all ProfilingDevices together.
struct KernelTime {
  double milliseconds = 0;
  int launches = 0;
};
inline std::map<std::string, KernelTime>& kernel_times() {
  static std::map<std::string, KernelTime> times;
  return times;
}

class ProfilingDevice {
 public:
  static constexpr const char* name = "cuda, timed";
  template <class T>
  using Buffer = CudaDevice::Buffer<T>;

  template <class Body>
  void launch(std::uint32_t n, const Body& body) {
    time(name_of(typeid(Body)), [&] { device_.launch(n, body); });
  }
  template <class Body>
  void launch_blocks(std::uint32_t blocks, const Body& body) {
    time(name_of(typeid(Body)), [&] { device_.launch_blocks(blocks, body); });
  }
  void prepare_sums(std::uint32_t n) { device_.prepare_sums(n); }
  void exclusive_sum(const std::uint32_t* in, std::uint32_t* out, std::uint32_t n) {
    time("exclusive sum (CUB)", [&] { device_.exclusive_sum(in, out, n); });
  }
  void prepare_sort(std::uint32_t n) { device_.prepare_sort(n); }
  void sort_pairs(const std::uint64_t* key, std::uint64_t* sorted_key, const std::uint32_t* value,
                  std::uint32_t* sorted_value, std::uint32_t n) {
    time("sort of pairs (CUB)", [&] { device_.sort_pairs(key, sorted_key, value, sorted_value, n); });
  }
  template <class Enqueue>
  void replay(const void*, int, const Enqueue& enqueue) {
    enqueue();
  }
  void forget(const void*) {}

 private:
  /// "FindDensity", of abn::sph_cuda::FindDensity<…>.
  static std::string name_of(const std::type_info& type) {
    const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(type.name(), nullptr, nullptr, nullptr),
                                                           &std::free);
    std::string name = text ? text.get() : type.name();
    const std::string own = "abn::sph_cuda::";
    for (std::size_t at = name.find(own); at != std::string::npos; at = name.find(own)) name.erase(at, own.size());
    if (name.rfind("SumChunks", 0) == 0) return name;
    return name.substr(0, name.find('<'));
  }

  template <class F>
  void time(const std::string& kernel, const F& f) {
    check(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
    Event begin;
    Event end;
    check(cudaEventRecord(begin.get(), device_.stream()), "cudaEventRecord");
    f();
    check(cudaEventRecord(end.get(), device_.stream()), "cudaEventRecord");
    check(cudaEventSynchronize(end.get()), kernel.c_str());
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, begin.get(), end.get()), "cudaEventElapsedTime");
    KernelTime& known = kernel_times()[kernel];
    known.milliseconds += double{milliseconds};
    ++known.launches;
  }

  class Event {
   public:
    Event() { check(cudaEventCreate(&event_), "cudaEventCreate"); }
    ~Event() { cudaEventDestroy(event_); }
    Event(const Event&) = delete;
    Event& operator=(const Event&) = delete;
    cudaEvent_t get() const { return event_; }

   private:
    cudaEvent_t event_ = nullptr;
  };

  CudaDevice device_;
};

}  // namespace abn::sph_cuda
