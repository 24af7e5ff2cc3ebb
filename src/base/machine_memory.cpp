#include "base/machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <string>
#include <system_error>

namespace pertev {
namespace {

/// The number at the start of a file; SIZE_MAX if there is none, as in a group without a limit ("max").
std::size_t number_in(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string text;
    std::getline(in, text);
    std::size_t bytes = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bytes);
    return error == std::errc() ? bytes : SIZE_MAX;
}

/// Returns the minimum limit, in bytes, of a group and all of its ancestors.
std::size_t min_limit(const std::filesystem::path& root, std::filesystem::path group, const char* file) {
    std::size_t least = SIZE_MAX;
    for (; !group.empty(); group = group.parent_path()) least = std::min(least, number_in(root / group / file));
    return std::min(least, number_in(root / file));
}

std::size_t of_whole_machine() {
    const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && bytes > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(bytes) : SIZE_MAX;
}

std::size_t of_group() { return group_memory_bytes("/proc/self/cgroup", "/sys/fs/cgroup"); }

} // namespace

std::size_t group_memory_bytes(const std::filesystem::path& groups, const std::filesystem::path& folder) {
    std::size_t least = std::min(number_in(folder / "memory.max"), number_in(folder / "memory/memory.limit_in_bytes"));
    std::ifstream in(groups);
    for (std::string line; std::getline(in, line);) { // number:controllers:/group
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const std::filesystem::path group = std::filesystem::path(line.substr(second + 1)).relative_path();
        if (controllers == ",,") least = std::min(least, min_limit(folder, group, "memory.max"));
        if (controllers.find(",memory,") != std::string::npos) {
            least = std::min(least, min_limit(folder / "memory", group, "memory.limit_in_bytes"));
        }
    }
    return least;
}

std::size_t machine_memory_bytes() { return std::min(of_whole_machine(), of_group()); }

bool is_memory_of_group() { return of_group() < of_whole_machine(); }

} // namespace pertev
