#pragma once

// What is wrong with a command line that CLI11 refuses, in words of ours: it lists what it does not know from right to
// left, after whatever else is wrong, and has no suggestions.

#include <string>

#include <CLI/CLI.hpp>

namespace pertev {

struct UsageError {
    std::string text;
    std::string help; // the command line that lists what there is: "pertev render --help"
};

/// Of `app` that has just thrown `error`. Unknown flags come first, in their order, each with the flag that was perhaps
/// meant: the rest may follow from them.
UsageError describe_usage_error(const CLI::App& app, const CLI::ParseError& error);

} // namespace pertev
