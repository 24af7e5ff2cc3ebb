#pragma once

// Compares words of files without their case, whatever the locale is.

#include <string>
#include <string_view>

namespace pertev {

/// Returns the text with a to z for A to Z.
inline std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return lower;
}

} // namespace pertev
