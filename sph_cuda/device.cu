#include "sph_cuda/device.h"

#include <cstdio>

#include "sph_cuda/check.h"

namespace abn::sph_cuda {

std::vector<Device> list_devices() {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaErrorNoDevice || status == cudaErrorInsufficientDriver) {
    cudaGetLastError();  // no device is an answer, not an error to be found later
    return {};
  }
  check(status, "cudaGetDeviceCount");
  int driver = 0;
  check(cudaDriverGetVersion(&driver), "cudaDriverGetVersion");
  std::vector<Device> devices;
  for (int index = 0; index < count; ++index) {
    cudaDeviceProp properties{};
    check(cudaGetDeviceProperties(&properties, index), "cudaGetDeviceProperties");
    devices.push_back({.index = index,
                       .name = properties.name,
                       .memory = properties.totalGlobalMem,
                       .major = properties.major,
                       .minor = properties.minor,
                       .multiprocessors = properties.multiProcessorCount,
                       .driver = driver});
  }
  return devices;
}

std::string describe_device(const Device& device) {
  char text[160];
  std::snprintf(text, sizeof text, ", %.1f GiB, compute capability %d.%d, %d multiprocessors, driver for CUDA %s",
                static_cast<double>(device.memory) / (1024.0 * 1024.0 * 1024.0), device.major, device.minor,
                device.multiprocessors, version_text(device.driver).c_str());
  return device.name + text;
}

std::string describe_devices() {
  try {
    std::string line;
    for (const Device& device : list_devices()) line += (line.empty() ? "" : "; ") + describe_device(device);
    return line.empty() ? "no CUDA device" : line;
  } catch (const DeviceError& error) {
    return error.what();
  }
}

std::string version_text(int version) {
  if (version == 0) return "none";
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

}  // namespace abn::sph_cuda
