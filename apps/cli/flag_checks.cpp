#include "apps/cli/flag_checks.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "apps/cli/parse_values.h"
#include "formats/files/parse_number.h"

namespace pertev {
namespace {

/// `accepts` says whether the text is a value, `wanted` what would be right.
template <class Accepts>
CLI::Validator checked(Accepts accepts, std::string wanted) {
    const auto check = [accepts, wanted = std::move(wanted)](std::string& text) {
        return accepts(text) ? std::string() : fmt::format("{} is not {}", text, wanted);
    };
    return CLI::Validator(check, ""); // nothing in --help: the flag's own text tells
}

/// Before the exponent, other than 0.
bool has_digits(const std::string& number) { return number.find_first_of("123456789") < number.find_first_of("eE"); }

} // namespace

CLI::Validator number_between(float low, float high) {
    const auto accepts = [low, high](const std::string& text) {
        const auto value = number_in(text);
        return value && *value >= low && *value <= high;
    };
    return checked(accepts, fmt::format("a number from {} to {}", low, high));
}

CLI::Validator number_above_zero(float high) {
    const auto check = [high](std::string& text) {
        const auto value = number_in(text);
        if (value && *value > 0 && *value <= high) return std::string();
        const bool is_rounded = value && *value == 0 && has_digits(text);
        return fmt::format("{} is {}not a number above 0 and at most {}", text,
                           is_rounded ? "so near 0 that it counts as 0, which is " : "", high);
    };
    return {check, ""};
}

CLI::Validator whole_between(uint32_t low, uint32_t high) {
    const auto accepts = [low, high](const std::string& text) {
        const auto value = parse_whole_number(text);
        return value && *value >= low && *value <= high;
    };
    return checked(accepts, fmt::format("a whole number from {} to {}", low, high));
}

CLI::Validator file_name() {
    return {[](std::string& text) { return std::string(text.empty() ? "the name is empty" : ""); }, ""};
}

CLI::Validator one_of(std::vector<std::string> names) {
    const std::string wanted = fmt::format("one of {}", fmt::join(names, ", "));
    const auto accepts = [names = std::move(names)](const std::string& text) {
        return std::ranges::find(names, text) != names.end();
    };
    return checked(accepts, wanted);
}

} // namespace pertev
