#pragma once

// A map statement of an .mtl file: a file's name with options, which stand before it by the format's rule and behind it
// in the files of some exporters.

#include <string>
#include <string_view>

#include "formats/obj/parse_mtl.h"

namespace pertev {

/// What is behind the key of a map statement, but for the line's number. Throws MtlFault for an option before the name
/// that lacks a value. Words behind the name that look like an option but are none are part of the name.
MtlTexture parse_mtl_texture(std::string_view text);

struct MtlFault {
    std::string what;
};

/// The number at the start of `text`, which is cut behind it. Throws MtlFault where there is none or it is not finite.
float take_mtl_number(std::string_view& text, std::string_view of);

/// Whether there is nothing but a comment in the rest of a statement.
bool is_mtl_end(std::string_view text);

} // namespace pertev
