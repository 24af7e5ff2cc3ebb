#pragma once

// The amount of memory, for refusing work that would not fit, and byte counts for people.

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace pertev {

inline double mebibytes(uint64_t bytes) { return static_cast<double>(bytes) / 0x1p20; }
inline double gibibytes(uint64_t bytes) { return static_cast<double>(bytes) / 0x1p30; }

/// Memory of this machine or, if that is less, of the container or the service of this process; bytes. SIZE_MAX if
/// unknown.
std::size_t machine_memory_bytes();

/// Returns whether machine_memory_bytes() is the limit of a container or a service rather than of the machine.
bool is_memory_of_group();

/// Least memory limit of a process's control groups, bytes; SIZE_MAX: none. `groups` is its /proc/self/cgroup;
/// `folder` is the mount point of groups, /sys/fs/cgroup. Files that are missing or contain "max" limit nothing. A
/// container may list its group under the host's name and yet see it as the root of `folder`, which is therefore
/// always read. Source: Linux, "Control Group v2" (memory.max), and "Memory Resource Controller"
/// (memory.limit_in_bytes) of v1.
std::size_t group_memory_bytes(const std::filesystem::path& groups, const std::filesystem::path& folder);

} // namespace pertev
