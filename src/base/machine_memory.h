#pragma once

// How much memory there is, for what refuses to begin what would not fit.

#include <cstddef>
#include <filesystem>

namespace pertev {

/// Memory that this machine has, or, where that is less, the container or the service that this process runs in; bytes.
/// SIZE_MAX where it does not say.
std::size_t machine_memory_bytes();

/// Whether that is the limit of a container or a service, and not all that the machine has.
bool is_memory_of_group();

/// The least limit of the control groups that a process is in, bytes; SIZE_MAX: none. `groups`: its /proc/self/cgroup;
/// `folder`: where groups are mounted, /sys/fs/cgroup. Files that are missing or say "max" limit nothing. A container
/// may name its group as the host does and yet see it as the root of `folder`, which is looked at in any case.
/// Source: Linux, "Control Group v2" (memory.max), and "Memory Resource Controller" (memory.limit_in_bytes) of v1.
std::size_t group_memory_bytes(const std::filesystem::path& groups, const std::filesystem::path& folder);

} // namespace pertev
