#pragma once

// These validators say what a flag takes. CLI11's own Range lets NaN through.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/messages.h"

namespace pertev {

/// Throws Error(BadInput) where it is.
inline void refuse(bool is_wrong, const std::string& why) {
    if (is_wrong) throw Error(ErrorCode::BadInput, why);
}

/// "a.png,b.exr" is one file's name, which hardly anybody means. Throws Error(BadInput).
void refuse_list(const std::string& output);

/// Says, where an output that is one file has # in its name, `when` that stands for a number.
void note_number_signs(const std::string& output, const char* when, Messages& messages);

/// A finite number above 0 and at most `high`.
CLI::Validator number_above_zero(float high = std::numeric_limits<float>::max());
/// A whole number in [low, high], in decimal digits.
CLI::Validator whole_between(uint32_t low, uint32_t high);

/// Adds a flag that takes such a number.
template <class Whole>
CLI::Option* add_whole(CLI::App& verb, const std::string& name, Whole& value, const std::string& text, uint32_t low,
                       uint32_t high) {
    return verb.add_option(name, value, text)->type_name("N")->check(whole_between(low, high));
}

/// The name of a file: not empty.
CLI::Validator file_name();

/// The size of a picture, which is read further where it is used: not empty.
CLI::Validator picture_size();

/// One of these names.
CLI::Validator one_of(std::vector<std::string> names);

} // namespace pertev
