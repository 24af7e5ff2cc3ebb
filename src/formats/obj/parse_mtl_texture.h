#pragma once

// Parses a map statement of an .mtl file: a file's name with options, which precede it by the format's rule and
// follow it in the files of some exporters.

#include <string>
#include <string_view>

#include "formats/obj/parse_mtl.h"

namespace pertev {

/// Parses the statement after its key, without the line number. Throws MtlFault for an option before the name without
/// a value. Words after the name that look like options but are none are part of the name.
MtlTexture parse_mtl_texture(std::string_view text);

struct MtlFault {
    std::string what;
};

/// Parses the number at the start of `text` and removes it. Throws MtlFault if there is none or it is not finite.
float take_mtl_number(std::string_view& text, std::string_view of);

/// Returns whether the rest of a statement is empty or a comment.
bool is_mtl_end(std::string_view text);

} // namespace pertev
