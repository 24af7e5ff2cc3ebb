#pragma once

// Counts and names as messages say them: "1 triangle", "2 triangles"; "/meshes/0 floor", or, where the file gives no
// place, "mesh 0 floor", or "mesh 0" without a name.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace pertev {

/// Of a `thing` whose plural ends in s; what follows in the message has no verb, which would have a plural too.
inline std::string counted(uint64_t count, const char* thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// The verb of so many things.
inline const char* is_or_are(uint64_t count) { return count == 1 ? "is" : "are"; }

/// Place `i` of a list of the scene; `origin` says where the file describes it.
inline std::string numbered(const char* kind, std::size_t i, const std::string& name, const std::string& origin = "") {
    const std::string place = origin.empty() ? fmt::format("{} {}", kind, i) : origin;
    return fmt::format("{}{}{}", place, name.empty() ? "" : " ", name);
}

/// Text of a file as a message repeats it: as much as a line has room for.
inline std::string shortened(std::string_view text) {
    constexpr std::size_t kMost = 200;
    return text.size() <= kMost ? std::string(text) : fmt::format("{}...", text.substr(0, kMost));
}

} // namespace pertev
