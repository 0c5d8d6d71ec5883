// Which CUDA devices there are. Free of CUDA headers, so that the program can ask without being compiled by nvcc.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace abn::sph_cuda {

struct Device {
  int index = 0;  // as CUDA counts
  std::string name;
  std::uint64_t memory = 0;  // [bytes], of the whole device
  int major = 0, minor = 0;  // compute capability
  int multiprocessors = 0;
  int driver = 0;  // newest CUDA version of the driver, e.g. 13000 for 13.0; 0 = none
};

/// The devices this process can use; empty if there is no device or no driver. Throws DeviceError if asking fails in
/// any other way.
std::vector<Device> list_devices();

/// "NAME, 12.0 GiB, compute capability 9.0, 132 multiprocessors, driver for CUDA 13.0".
std::string describe_device(const Device& device);

/// All devices on one line, or "no CUDA device".
/// Never throws: where asking fails, the line says why.
std::string describe_devices();

/// CUDA version of the driver as "13.0"; "none" without a driver.
std::string version_text(int version);

}  // namespace abn::sph_cuda
