#include "apps/cli/flag_checks.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "base/write_file_atomically.h"
#include "image/image_format.h"
#include "settings/parse_values.h"

namespace pertev {

// They do not appear in the help, because each flag's text states its range.

namespace {

/// Refuses a text for which there is a reason, "not a number from 0 to 1".
CLI::Validator refused_by(std::function<std::string(const std::string&)> why_not) {
    return {[why_not = std::move(why_not)](const std::string& text) {
                const std::string why = why_not(text);
                return why.empty() ? why : fmt::format("{}{}{}", text, before_reason(why), why);
            },
            ""};
}

} // namespace

CLI::Validator number_above_zero(float high) {
    return refused_by([high](const std::string& text) { return why_not_above(text, 0, high); });
}

CLI::Validator number_from_zero() {
    return refused_by(
        [](const std::string& text) { return why_no_number(text, 0, std::numeric_limits<float>::max()); });
}

CLI::Validator whole_between(uint32_t low, uint32_t high) {
    return refused_by([low, high](const std::string& text) { return why_not_whole(text, low, high); });
}

CLI::Validator file_name() {
    return {[](const std::string& text) { return std::string(text.empty() ? "the name is empty" : ""); }, ""};
}

CLI::Validator one_of(std::vector<std::string> names) {
    return refused_by([names = std::move(names)](const std::string& text) { return why_no_choice(text, names); });
}

void refuse_list(const std::string& output) {
    const std::size_t comma = output.find(',');
    if (comma == std::string::npos) return;
    const std::string first = output.substr(0, comma);
    const std::filesystem::path extension = std::filesystem::path(first).extension();
    if (!is_picture_name(first) && extension != ".rad" && extension != ".pvf") return;
    std::string each = output;
    for (std::size_t at = 0; (at = each.find(',', at)) != std::string::npos; at += 4) each.replace(at, 1, " -o ");
    throw Error(ErrorCode::BadInput, "output", output,
                fmt::format("is the name of one file; give each file its own -o: -o {}", each));
}

void name_standard_output(const std::string& format, bool is_json, std::vector<std::string>& outputs) {
    const auto output = std::ranges::find(outputs, "-");
    refuse(output == outputs.end() && !format.empty(), {"output_format", format, "needs `output=-`"});
    if (output == outputs.end()) return;
    refuse(format.empty(), {"output", "-", "needs `output_format`, which a file's name states by its extension"});
    refuse(is_json, {"output", "-", "cannot be combined with `json`, which takes the standard output"});
    std::ranges::replace(outputs, "-", standard_output(format).string());
}

} // namespace pertev
