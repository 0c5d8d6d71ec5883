// The device of engine.h that is a GPU. For files that nvcc compiles.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <type_traits>
#include <utility>

#include "sph_cuda/buffer.h"
#include "sph_cuda/check.h"

namespace abn::sph_cuda {

inline constexpr std::uint32_t threads_per_block = 128;          // of launches by index
inline constexpr std::size_t shared_without_asking = 48 * 1024;  // bytes that every block may have

/// Launch: one thread per index, no shared memory. Writes what the body says it writes.
template <class Body>
__global__ void __launch_bounds__(threads_per_block) run_indices(Body body, std::uint32_t n) {
  const std::uint64_t i = std::uint64_t{blockIdx.x} * threads_per_block + threadIdx.x;
  if (i < n) body(static_cast<std::uint32_t>(i));
}

/// Launch: Body::threads per block, body.shared_bytes() of shared memory, a barrier after every phase.
template <class Body>
__global__ void __launch_bounds__(Body::threads) run_blocks(Body body) {
  extern __shared__ uint4 shared_memory[];  // aligned for whatever a body keeps there
  const int phases = body.phases(blockIdx.x);
  for (int phase = 0; phase < phases; ++phase) {
    body(phase, blockIdx.x, threadIdx.x, static_cast<void*>(shared_memory));
    __syncthreads();
  }
}

class CudaDevice {
 public:
  static constexpr const char* name = "cuda";
  template <class T>
  using Buffer = sph_cuda::Buffer<T>;

  CudaDevice() {
    cudaStream_t stream = nullptr;
    check(cudaStreamCreate(&stream), "cudaStreamCreate");  // waits for copies, and they for it
    stream_.reset(stream);
  }

  template <class Body>
  void launch(std::uint32_t n, const Body& body) {
    static_assert(std::is_trivially_copyable_v<Body>);
    if (n == 0) return;
    const std::uint32_t blocks = n / threads_per_block + (n % threads_per_block != 0 ? 1 : 0);
    run_indices<<<blocks, threads_per_block, 0, stream_.get()>>>(body, n);
    check(cudaGetLastError(), "kernel launch");
  }

  template <class Body>
  void launch_blocks(std::uint32_t blocks, const Body& body) {
    static_assert(std::is_trivially_copyable_v<Body>);
    if (blocks == 0) return;
    const std::size_t bytes = body.shared_bytes();
    if (bytes > shared_without_asking) {
      check(
          cudaFuncSetAttribute(run_blocks<Body>, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(bytes)),
          "shared memory of a block");
    }
    run_blocks<<<blocks, Body::threads, bytes, stream_.get()>>>(body);
    check(cudaGetLastError(), "kernel launch");
  }

  // By CUB, in cuda_primitives.cu: its headers take long to compile. prepare_… makes room for up to n values: nothing
  // can be allocated while a graph is recorded.
  void prepare_sums(std::uint32_t n);
  void exclusive_sum(const std::uint32_t* in, std::uint32_t* out, std::uint32_t n);
  void prepare_sort(std::uint32_t n);
  void sort_pairs(const std::uint64_t* key, std::uint64_t* sorted_key, const std::uint32_t* value,
                  std::uint32_t* sorted_value, std::uint32_t n);

  /// The first time launches as it is told, the second time records a graph: for a single batch that would not pay.
  template <class Enqueue>
  void replay(const void* owner, int number, const Enqueue& enqueue) {
    const Key key{owner, number};
    if (const auto known = graphs_.find(key); known != graphs_.end()) {
      check(cudaGraphLaunch(known->second.get(), stream_.get()), "cudaGraphLaunch");
      return;
    }
    if (seen_.insert(key).second) {
      enqueue();
      return;
    }
    check(cudaStreamBeginCapture(stream_.get(), cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
    cudaGraph_t raw = nullptr;
    try {
      enqueue();
    } catch (...) {
      cudaStreamEndCapture(stream_.get(), &raw);  // the first error is the one to tell
      if (raw != nullptr) cudaGraphDestroy(raw);
      throw;
    }
    check(cudaStreamEndCapture(stream_.get(), &raw), "cudaStreamEndCapture");
    const std::unique_ptr<std::remove_pointer_t<cudaGraph_t>, DestroyGraph> graph(raw);
    cudaGraphExec_t executable = nullptr;
    check(cudaGraphInstantiateWithFlags(&executable, graph.get(), 0), "cudaGraphInstantiate");
    const auto placed = graphs_.emplace(key, Executable(executable)).first;
    check(cudaGraphLaunch(placed->second.get(), stream_.get()), "cudaGraphLaunch");
  }
  void forget(const void* owner) {
    std::erase_if(graphs_, [&](const auto& known) { return known.first.first == owner; });
    std::erase_if(seen_, [&](const Key& key) { return key.first == owner; });
  }
  cudaStream_t stream() const { return stream_.get(); }

 private:
  using Key = std::pair<const void*, int>;

  void reserve(std::size_t bytes) {
    if (bytes <= scratch_.size()) return;
    graphs_.clear();  // they know the memory that goes
    scratch_.reset(bytes);
  }

  struct DestroyStream {
    void operator()(cudaStream_t stream) const { cudaStreamDestroy(stream); }
  };
  struct DestroyGraph {
    void operator()(cudaGraph_t graph) const { cudaGraphDestroy(graph); }
  };
  struct DestroyExecutable {
    void operator()(cudaGraphExec_t executable) const { cudaGraphExecDestroy(executable); }
  };
  using Executable = std::unique_ptr<std::remove_pointer_t<cudaGraphExec_t>, DestroyExecutable>;

  std::unique_ptr<std::remove_pointer_t<cudaStream_t>, DestroyStream> stream_;
  Buffer<unsigned char> scratch_;  // of CUB
  std::map<Key, Executable> graphs_;
  std::set<Key> seen_;
};

}  // namespace abn::sph_cuda
