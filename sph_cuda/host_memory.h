// What stands for a device's memory where the device is a loop on the host: as strict as the real one. It is not
// zeroed, the host cannot read it between launches (the address sanitizer sees to that), and kernels are told of
// nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <string>
#include <type_traits>

#ifdef __SANITIZE_ADDRESS__  // what the sanitizer's own header says
extern "C" void __asan_poison_memory_region(void const volatile* memory, std::size_t bytes);
extern "C" void __asan_unpoison_memory_region(void const volatile* memory, std::size_t bytes);
#endif

namespace abn::sph_cuda {

class HostMemory {
 public:
  static void* take(std::size_t bytes) {
    void* memory = ::operator new(bytes);
    std::memset(memory, garbage, bytes);
    arrays()[reinterpret_cast<std::uintptr_t>(memory)] = bytes;
    lock(memory, bytes);
    return memory;
  }
  static void give_back(void* memory) noexcept {
    const auto array = arrays().find(reinterpret_cast<std::uintptr_t>(memory));
    unlock(memory, array->second);
    arrays().erase(array);
    ::operator delete(memory);
  }

  /// While one lives, all of the memory may be read and written, or one array of it.
  class Access {
   public:
    Access() { each(unlock); }
    Access(const void* memory, std::size_t bytes) : memory_(memory), bytes_(bytes) { unlock(memory, bytes); }
    ~Access() {
      if (memory_ == nullptr) each(lock);
      if (memory_ != nullptr) lock(memory_, bytes_);
    }
    Access(const Access&) = delete;
    Access& operator=(const Access&) = delete;

   private:
    const void* memory_ = nullptr;
    std::size_t bytes_ = 0;
  };

  /// Ends the program if a kernel is given the address of anything else of this process: on a device nothing is there.
  template <class Body>
  static void check_pointers(const Body& body) {
    static_assert(std::is_trivially_copyable_v<Body>, "a kernel's parameters are copied to the device byte by byte");
#if __has_builtin(__builtin_clear_padding)
    Body copy = body;
    __builtin_clear_padding(&copy);  // what lies between members may be anything
    const auto* bytes = reinterpret_cast<const unsigned char*>(&copy);
    for (std::size_t at = 0; at + sizeof(std::uintptr_t) <= sizeof(Body); at += sizeof(std::uintptr_t)) {
      std::uintptr_t word = 0;
      std::memcpy(&word, bytes + at, sizeof word);
      if (word < lowest_address || holds(word) || !is_mapped(word)) continue;
      std::fprintf(stderr, "a kernel was given a pointer to the host's memory: byte %zu of its parameters\n%s\n", at,
                   __PRETTY_FUNCTION__);
      std::abort();
    }
#else
    static_cast<void>(body);
#endif
  }

 private:
  static constexpr int garbage = 0xCD;
  // Below lie neither program, heap nor stack of a 64-bit Linux process; counts and sizes side by side do.
  static constexpr std::uintptr_t lowest_address = 0x550000000000;

  using Arrays = std::map<std::uintptr_t, std::size_t>;  // address, bytes
  static Arrays& arrays() {
    static Arrays all;
    return all;
  }
  static bool holds(std::uintptr_t address) {
    auto after = arrays().upper_bound(address);
    return after != arrays().begin() && address <= std::prev(after)->first + std::prev(after)->second;
  }
  static bool is_mapped(std::uintptr_t address) {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
      char* rest = nullptr;
      const std::uintptr_t begin = std::strtoull(line.c_str(), &rest, 16);
      if (address >= begin && address < std::strtoull(rest + 1, nullptr, 16)) return true;
    }
    return false;
  }
  static void each(void (*act)(const void*, std::size_t)) {
    for (const auto& [address, bytes] : arrays()) act(reinterpret_cast<const void*>(address), bytes);
  }
#ifdef __SANITIZE_ADDRESS__
  static void lock(const void* memory, std::size_t bytes) { __asan_poison_memory_region(memory, bytes); }
  static void unlock(const void* memory, std::size_t bytes) { __asan_unpoison_memory_region(memory, bytes); }
#else
  static void lock(const void*, std::size_t) {}
  static void unlock(const void*, std::size_t) {}
#endif
};

}  // namespace abn::sph_cuda
