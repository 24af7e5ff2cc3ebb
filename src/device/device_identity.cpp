#include "device/device_identity.h"

#include <sched.h>

#include <charconv>
#include <fstream>

namespace pertev {

std::string driver_version() {
    std::ifstream file("/sys/module/nvidia/version");
    std::string version;
    std::getline(file, version);
    return version;
}

std::string processors_near(const std::string& bus) {
    std::ifstream file("/sys/bus/pci/devices/" + bus + "/local_cpulist");
    std::string list;
    std::getline(file, list);
    return list;
}

void stay_on_processors(const std::string& list) {
    cpu_set_t allowed, wanted;
    CPU_ZERO(&wanted);
    if (list.empty() || ::sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
    const char* at = list.data();
    const char* const end = at + list.size();
    while (at < end) {
        int first = 0;
        const auto [after, fault] = std::from_chars(at, end, first);
        if (fault != std::errc() || first < 0) return;
        int last = first;
        at = after;
        if (at < end && *at == '-') {
            const auto [after_last, other_fault] = std::from_chars(at + 1, end, last);
            if (other_fault != std::errc()) return;
            at = after_last;
        }
        for (int cpu = first; cpu <= last && cpu < CPU_SETSIZE; ++cpu) {
            if (CPU_ISSET(cpu, &allowed)) CPU_SET(cpu, &wanted);
        }
        if (at < end) ++at; // the comma
    }
    if (CPU_COUNT(&wanted) > 0) ::sched_setaffinity(0, sizeof wanted, &wanted);
}

#if !defined(PERTEV_HAS_CUDA)

std::vector<DeviceIdentity> device_identities() { return {}; }

#endif

} // namespace pertev
