#pragma once

// Remarks of the libraries (base/remark.h) as the command line phrases them: a setting becomes its flag, with a value
// that can be copied into a shell.

#include <string>
#include <string_view>

#include "base/remark.h"

namespace pertev {

/// "--max-depth" of "max_depth".
std::string flag_of(std::string_view setting);

/// All parts of it as one text: "with --integrator cast at most 12" of "with `integrator=cast` at most 12".
std::string phrase(const Remark& remark);

/// The remark's parts as members of a JSON object, each with a comma before it: "place", "setting", "value" and
/// "settings" where it has them, and "reason". Settings have their own names here, not those of flags.
std::string json_parts(const Remark& remark);

} // namespace pertev
