#include "apps/cli/flag_checks.h"

#include <filesystem>

#include <fmt/format.h>

#include "image/image_format.h"
#include "session/frame_range.h"
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

void refuse_list(const std::string& output) {
    const std::size_t comma = output.find(',');
    if (comma == std::string::npos) return;
    const std::string first = output.substr(0, comma);
    if (!is_picture_name(first) && std::filesystem::path(first).extension() != ".rad") return;
    std::string each = output;
    for (std::size_t at = 0; (at = each.find(',', at)) != std::string::npos; at += 4) each.replace(at, 1, " -o ");
    throw Error(ErrorCode::BadInput,
                fmt::format("-o {}: is the name of one file; give each file its own -o: -o {}", output, each));
}

void note_number_signs(const std::string& output, const char* when, Messages& messages) {
    if (!names_frames(output)) return;
    messages.note(
        fmt::format("-o {}: # stands for a frame's number {}; here it is a part of the file's name", output, when));
}

} // namespace pertev
