#pragma once

// Formats remarks of the libraries (base/remark.h) for the command line: a setting becomes its flag, with a value
// that can be copied into a shell.

#include <string>
#include <string_view>

#include "base/remark.h"
#include "settings/picture_flags.h"

namespace pertev {

/// Returns the flag of a setting, -o for the output, and SCENE for the scene, which has no flag.
std::string shown_flag(std::string_view setting);

/// All parts as one text: "with --integrator cast at most 12" for "with `integrator=cast` at most 12".
std::string phrase(const Remark& remark);

/// The remark's parts as members of a JSON object, each preceded by a comma: "place", "setting", "value" and
/// "settings" if present, and "reason". Settings have their own names here, not those of flags.
std::string json_parts(const Remark& remark);

} // namespace pertev
