#include "device/device_identity.h"

#include <cuda_runtime.h>

#include <cctype>
#include <cstdint>

#include <fmt/format.h>

namespace pertev {

std::vector<DeviceIdentity> device_identities() {
    std::vector<DeviceIdentity> identities;
    int count = 0;
    if (cudaGetDeviceCount(&count) != cudaSuccess) count = 0;
    for (int index = 0; index < count; ++index) {
        DeviceIdentity identity;
        cudaDeviceProp properties{};
        if (cudaGetDeviceProperties(&properties, index) == cudaSuccess) {
            identity.uuid = "GPU-";
            for (int i = 0; i < 16; ++i) {
                if (i == 4 || i == 6 || i == 8 || i == 10) identity.uuid += '-';
                identity.uuid += fmt::format("{:02x}", static_cast<uint8_t>(properties.uuid.bytes[i]));
            }
        }
        char bus[32] = "";
        if (cudaDeviceGetPCIBusId(bus, sizeof bus, index) == cudaSuccess) identity.bus = bus;
        for (char& letter : identity.bus) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
        identities.push_back(std::move(identity));
    }
    return identities;
}

} // namespace pertev
