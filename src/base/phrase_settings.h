#pragma once

// Replaces names of settings in a text (base/remark.h) by a front end's terms.

#include <functional>
#include <string>
#include <string_view>

namespace pertev {

/// Returns a front end's text for a setting. The value is empty if the text has none.
using PhraseSetting = std::function<std::string(std::string_view name, std::string_view value)>;

/// Returns `text` with `phrase` applied to each `name` and `name=value` between backquotes. The rest is unchanged.
std::string phrase_settings(std::string_view text, const PhraseSetting& phrase);

} // namespace pertev
