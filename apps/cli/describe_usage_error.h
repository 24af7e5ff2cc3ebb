#pragma once

// Describes a command line that CLI11 refuses in our own words. CLI11 lists unknown words from right to left, after
// other errors, and makes no suggestions.

#include <string>

#include <CLI/CLI.hpp>

#include "base/remark.h"

namespace pertev {

struct UsageError {
    Remark remark;    // about a flag, if it begins with one
    std::string help; // the command line that lists the possibilities: "pertev render --help"
};

/// Describes the error that `app` has just thrown. Unknown flags come first, in order, each with a suggestion,
/// because the other errors may follow from them.
UsageError describe_usage_error(const CLI::App& app, const CLI::ParseError& error);

} // namespace pertev
