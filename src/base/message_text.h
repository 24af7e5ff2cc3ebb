#pragma once

// Counts and names in messages: "1 triangle", "2 triangles"; "/meshes/0 floor", or "mesh 0 floor" if the file gives
// no location, or "mesh 0" without a name.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace pertev {

/// A count with a noun whose plural ends in s. The rest of the message must have no verb, which would need a plural
/// too.
inline std::string counted(uint64_t count, const char* thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// Returns the verb for a count.
inline const char* is_or_are(uint64_t count) { return count == 1 ? "is" : "are"; }

/// Names item `i` of a list of the scene; `origin` is its location in the file.
inline std::string numbered(const char* kind, std::size_t i, const std::string& name, const std::string& origin = "") {
    const std::string location = origin.empty() ? fmt::format("{} {}", kind, i) : origin;
    return fmt::format("{}{}{}", location, name.empty() ? "" : " ", name);
}

/// Text of a file shortened to fit a line of a message.
inline std::string shortened(std::string_view text) {
    constexpr std::size_t kMaxBytes = 200;
    return text.size() <= kMaxBytes ? std::string(text) : fmt::format("{}...", text.substr(0, kMaxBytes));
}

} // namespace pertev
