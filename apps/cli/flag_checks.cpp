#include "apps/cli/flag_checks.h"

#include "settings/parse_values.h"

namespace pertev {

// Nothing of them stands in the help, because each flag's own text says it.

CLI::Validator number_above_zero(float high) {
    return {[high](const std::string& text) { return why_not_above(text, 0, high); }, ""};
}

CLI::Validator whole_between(uint32_t low, uint32_t high) {
    return {[low, high](const std::string& text) { return why_not_whole(text, low, high); }, ""};
}

CLI::Validator file_name() {
    return {[](const std::string& text) { return std::string(text.empty() ? "the name is empty" : ""); }, ""};
}

CLI::Validator picture_size() {
    return {[](const std::string& text) { return std::string(text.empty() ? "expected WIDTHxHEIGHT" : ""); }, ""};
}

CLI::Validator one_of(std::vector<std::string> names) {
    return {[names = std::move(names)](const std::string& text) { return why_no_choice(text, names); }, ""};
}

} // namespace pertev
