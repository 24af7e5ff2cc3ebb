#pragma once

// Quotes text for a shell.

#include <string>
#include <string_view>

namespace pertev {

/// Returns `text` as one word of a shell, in quotes if a shell would split or expand it.
std::string shell_word(std::string_view text);

} // namespace pertev
