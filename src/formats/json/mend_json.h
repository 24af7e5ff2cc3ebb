#pragma once

// JSON that simdjson refuses, though its meaning is plain, is rewritten so that it can be read.

#include <string>
#include <string_view>
#include <vector>

namespace pertev::gltf {

enum class MendJson {
    Numbers, // what RFC 8259 allows: whole numbers beyond 64 bits, and numbers beyond the largest double, which become
             // it
    All, // also what it does not: NaN (null), Infinity, bytes that are not UTF-8, half a surrogate pair (U+FFFD), tabs
};

/// Returns the text as simdjson reads it; the same text where nothing of that is in it. Appends to `said` what was no
/// JSON, as the ends of warnings.
std::string mend_json(std::string_view text, MendJson mend, std::vector<std::string>* said = nullptr);

} // namespace pertev::gltf
