#include "base/remove_leftovers.h"

#include <signal.h>

#include <cerrno>
#include <charconv>
#include <optional>
#include <string>

namespace pertev {
namespace {

/// Returns the number of the process in a name that begins with `prefix` and goes on with PROCESS.NUMBER.
std::optional<int> process_of(const std::string& name, const std::string& prefix) {
    if (!name.starts_with(prefix)) return std::nullopt;
    int process = 0, number = 0;
    const char* const end = name.data() + name.size();
    const auto [dot, fault] = std::from_chars(name.data() + prefix.size(), end, process);
    if (fault != std::errc() || dot == end || *dot != '.' || process <= 0) return std::nullopt;
    const auto [last, other_fault] = std::from_chars(dot + 1, end, number);
    return other_fault == std::errc() && last == end ? std::optional(process) : std::nullopt;
}

} // namespace

void remove_leftovers(const std::filesystem::path& path) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    const std::string prefix = "." + path.filename().string() + ".";
    std::error_code fault, ignored;
    for (std::filesystem::directory_iterator file(folder, fault), end; !fault && file != end; file.increment(fault)) {
        const std::optional<int> process = process_of(file->path().filename().string(), prefix);
        if (process && ::kill(*process, 0) != 0 && errno == ESRCH) std::filesystem::remove(file->path(), ignored);
    }
}

} // namespace pertev
