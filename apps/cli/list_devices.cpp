// pertev --list-devices

#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "base/machine_memory.h"
#include "base/parallel_for.h"
#include "base/processor.h"
#include "base/processor_name.h"
#include "device/backend.h"
#include "device/device_identity.h"

namespace pertev {

std::string list_devices() {
    std::string list;
    int index = 0;
    const std::string version = driver_version(), driver = version.empty() ? "" : ", driver " + version;
    const std::vector<DeviceIdentity> identities = device_identities();
    for (const CudaDevice& device : cuda_devices()) {
        const std::string why_not = why_no_cuda(index);
        list += fmt::format("cuda:{:<3} {}, {:.0f} MiB, compute capability {}.{}{}, {}{}\n", index, device.name,
                            mebibytes(device.bytes), device.major, device.minor, driver,
                            identities.at(static_cast<std::size_t>(index)).uuid,
                            why_not.empty() ? "" : fmt::format("; it cannot be used: {}", why_not));
        ++index;
    }
    if (index == 0) list += fmt::format("no CUDA device: {}\n", why_no_cuda(0));
    const std::string name = processor_name();
    return list + fmt::format("cpu      {}, {:.0f} MiB, {} threads, {} lanes\n", name.empty() ? "CPU" : name,
                              mebibytes(machine_memory_bytes()), thread_count(),
                              has_sixteen_lanes() ? kMaxLanes : kMaxLanes / 2);
}

} // namespace pertev
