// The stand-in for a device is as strict as a device.
#include "sph_cuda/host_device.h"

#include <gtest/gtest.h>

#include <vector>

#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

struct AddOne {
  const float* from;
  float* to;
  void operator()(std::uint32_t i) const { to[i] = from[i] + 1; }
};

TEST(HostDevice, KernelsAreGivenTheDevicesMemoryOnly) {
  const HostDevice device;
  const std::vector<float> host(5, 1.0F);
  auto there = on_device(host);
  device.launch(5, AddOne{there.data(), there.data()});
  EXPECT_EQ(there.download(5), std::vector<float>(5, 2.0F));
#if __has_builtin(__builtin_clear_padding)
  EXPECT_DEATH(device.launch(5, AddOne{host.data(), there.data()}), "pointer to the host's memory: byte 0");
  const float local = 1;
  EXPECT_DEATH(device.launch(1, AddOne{&local, there.data()}), "pointer to the host's memory: byte 0");
#endif
}

TEST(HostDevice, MemoryIsNotZeroed) {
  HostDevice::Buffer<std::uint32_t> memory;
  memory.reset(3);
  EXPECT_EQ(memory.download(3), std::vector<std::uint32_t>(3, 0xCDCDCDCDU));
  memory.upload({1, 2, 3});
  memory.reset(3);
  EXPECT_EQ(memory.download(3), std::vector<std::uint32_t>(3, 0xCDCDCDCDU));
}

#ifdef __SANITIZE_ADDRESS__
TEST(HostDevice, TheHostCannotReadIt) {
  auto there = on_device(std::vector<float>(5, 1.0F));
  EXPECT_DEATH(there.data()[2] += 1, "AddressSanitizer");
}
#endif

}  // namespace
}  // namespace abn::sph_cuda
