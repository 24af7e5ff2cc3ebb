#pragma once

// Output of errors: a line on stderr for people or, with --json, an object on stdout with all other output.

#include <string>

#include "base/error.h"

namespace pertev {

/// The object {"event":"error","code":"bad_input","status":2,"interrupted":false,"text":...,"reason":...} with the
/// remark's other parts, and "help":... if `help` is not empty: the command line that lists the possibilities.
std::string error_object(ErrorCode code, const Remark& remark, const std::string& help = "");

/// Reports an error; with `json` on stdout, or on stderr if stdout fails. Returns the exit status.
int report_error(bool json, ErrorCode code, const Remark& remark, const std::string& help = "");

} // namespace pertev
