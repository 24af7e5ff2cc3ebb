#pragma once

// Rewrites JSON that simdjson refuses although its meaning is clear.

#include <string>
#include <string_view>
#include <vector>

namespace pertev::gltf {

enum class RepairJson {
    Numbers, // valid by RFC 8259: whole numbers beyond 64 bits, and numbers beyond the largest double, which become
             // that
    All, // invalid values, too: NaN (null), Infinity, bytes that are not UTF-8, half a surrogate pair (U+FFFD), tabs
};

/// Returns text that simdjson can read; `text` itself if it needs no repair. Appends to `repairs` what was invalid, as
/// ends of warnings.
std::string repair_json(std::string_view text, RepairJson repair, std::vector<std::string>* repairs = nullptr);

} // namespace pertev::gltf
