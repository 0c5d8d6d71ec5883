// An adaptive plane on a device that may fail, and on the CPU from there on.
#pragma once

#include <functional>
#include <string>

#include "sampling/adaptive/adaptive_plane.h"

namespace abn::harness {

/// Makes planes on the device; where that throws DeviceError, at once or in the middle of a plane (no memory left,
/// say), `tell` gets the error's words, what has been added and relaxed so far is done again on the CPU, and the plane
/// goes on there.
AdaptivePlaneFactory with_fallback(AdaptivePlaneFactory on_device, std::function<void(const std::string&)> tell);

}  // namespace abn::harness
