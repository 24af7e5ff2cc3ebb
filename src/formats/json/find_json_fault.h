#pragma once

// Finds the location of a JSON syntax error, which simdjson's DOM does not report: scans the brackets, commas and
// colons of a refused text and lets simdjson check each name, number, string and word separately. Nothing recurses.
//
// Source: RFC 8259.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "formats/json/repair_json.h"

namespace pertev::gltf {

struct JsonFault {
    std::size_t byte;     // offset in the text
    std::string expected; // expected there, for messages
};

/// The first fault of `text`; nothing if it is valid JSON after mending.
std::optional<JsonFault> find_json_fault(std::string_view text, RepairJson repair);

/// Returns the place of a byte, such as "line 3, column 14": both from 1, columns in characters.
std::string line_and_column(std::string_view text, std::size_t byte);

} // namespace pertev::gltf
