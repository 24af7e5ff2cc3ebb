#pragma once

// Where a text stops being JSON. simdjson's DOM only says that it does; this walks over the brackets, commas and colons
// of a text that was refused and has simdjson judge each name, number, string and word alone. Nothing recurses.
//
// Source: RFC 8259.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "formats/json/mend_json.h"

namespace pertev::gltf {

struct JsonFault {
    std::size_t byte;     // of the text
    std::string expected; // there, for messages
};

/// The first fault of `text`; nothing when it is JSON once it is mended.
std::optional<JsonFault> find_json_fault(std::string_view text, MendJson mend);

/// "line 3, column 14", both from 1, columns in characters.
std::string line_and_column(std::string_view text, std::size_t byte);

} // namespace pertev::gltf
