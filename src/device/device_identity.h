#pragma once

// A GPU's identity: its UUID, its driver, and the place where it is connected. Backends need none of them.

#include <string>
#include <vector>

namespace pertev {

struct DeviceIdentity {
    std::string uuid; // GPU-8c4d7a52-...
    std::string bus;  // place on PCI by the kernel's name: 0000:3b:00.0
};

/// Returns the identities of all CUDA devices, in the order of their indices. That starts the driver.
std::vector<DeviceIdentity> device_identities();

/// Returns the version of the driver of NVIDIA's GPUs; empty without one.
std::string driver_version();

/// Returns the processors of the socket to which the device at `bus` is connected, as the kernel lists them
/// ("0-15,64"); empty if that is unknown.
std::string processors_near(const std::string& bus);

/// Lets the calling thread run on the processors of such a list alone. Does nothing if the list is empty or none of
/// them may be used.
void stay_on_processors(const std::string& list);

} // namespace pertev
