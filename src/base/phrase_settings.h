#pragma once

// Names of settings in a text (base/remark.h) become what a front end calls them.

#include <functional>
#include <string>
#include <string_view>

namespace pertev {

/// What stands for a setting of this name. The value is empty where the text gives none.
using PhraseSetting = std::function<std::string(std::string_view name, std::string_view value)>;

/// `text` with `phrase` in place of each `name` and `name=value` between backquotes. All else stays as it is.
std::string phrase_settings(std::string_view text, const PhraseSetting& phrase);

} // namespace pertev
