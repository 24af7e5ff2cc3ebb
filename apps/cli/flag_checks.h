#pragma once

// Validators that describe the values of flags. CLI11's own Range accepts NaN.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/error.h"

namespace pertev {

/// Throws Error(BadInput) if `is_wrong`.
inline void refuse(bool is_wrong, const Remark& why) {
    if (is_wrong) throw Error(ErrorCode::BadInput, why);
}

/// Refuses "a.png,b.exr", one file name by which most users mean two files. Throws Error(BadInput).
void refuse_list(const std::string& output);

/// Replaces `-` among the outputs by the standard output in the format of this setting. Throws Error(BadInput) without
/// a format, with JSON, which takes the standard output, and for a format without `-`.
void name_standard_output(const std::string& format, bool is_json, std::vector<std::string>& outputs);

/// Accepts a finite number above 0 and at most `high`.
CLI::Validator number_above_zero(float high = std::numeric_limits<float>::max());
/// Accepts a finite number of at least 0.
CLI::Validator number_from_zero();
/// Accepts a whole number in [low, high], in decimal digits.
CLI::Validator whole_between(uint32_t low, uint32_t high);

/// Adds a flag with a whole number in [low, high].
template <class Whole>
CLI::Option* add_whole(CLI::App& verb, const std::string& name, Whole& value, const std::string& text, uint32_t low,
                       uint32_t high) {
    return verb.add_option(name, value, text)->type_name("N")->check(whole_between(low, high));
}

/// Accepts a file name that is not empty.
CLI::Validator file_name();

/// Accepts one of these names.
CLI::Validator one_of(std::vector<std::string> names);

} // namespace pertev
