#pragma once

// How errors leave the program: a line on stderr for people or, with --json, an object on stdout, where all else is.

#include <string>

#include "base/error.h"

namespace pertev {

/// {"event":"error","code":"bad_input","status":2,"interrupted":false,"text":...,"reason":...} with the remark's other
/// parts, and "help":... where `help` is not empty: the command line that lists what there is.
std::string error_object(ErrorCode code, const Remark& remark, const std::string& help = "");

/// Says it; with `json` on stdout, or on stderr where stdout takes nothing. Gives the exit status.
int report_error(bool json, ErrorCode code, const Remark& remark, const std::string& help = "");

} // namespace pertev
