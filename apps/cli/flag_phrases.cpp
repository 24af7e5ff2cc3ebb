#include "apps/cli/flag_phrases.h"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "base/json_text.h"
#include "base/phrase_settings.h"
#include "base/shell_word.h"

namespace pertev {
namespace {

/// Settings whose flags are not made of their names.
constexpr std::pair<std::string_view, std::string_view> kOtherFlags[] = {{"output", "-o"}, {"scene", "SCENE"}};

std::string flag_and_value(std::string_view setting, std::string_view value) {
    return shown_flag(setting) + (value.empty() ? "" : ' ' + shell_word(value));
}

std::string location_json(const FileLocation& location) {
    std::string json = fmt::format(R"({{"file":{})", json_string(location.file));
    if (location.line > 0) json += fmt::format(R"(,"line":{})", location.line);
    if (location.pointer) json += fmt::format(R"(,"pointer":{})", json_string(*location.pointer));
    return json + '}';
}

/// The settings that a reason names, as an object; a value is null if the reason has none.
std::string named_settings_json(const std::string& reason) {
    std::map<std::string, std::string, std::less<>> named;
    phrase_settings(reason, [&](std::string_view name, std::string_view value) {
        std::string& known = named[std::string(name)];
        if (!value.empty()) known = value;
        return std::string();
    });
    std::string json;
    for (const auto& [name, value] : named) {
        json += fmt::format("{}{}:{}", json.empty() ? "" : ",", json_string(name),
                            value.empty() ? "null" : json_string(value));
    }
    return json;
}

} // namespace

std::string shown_flag(std::string_view setting) {
    for (const auto& [name, flag] : kOtherFlags) {
        if (setting == name) return std::string(flag);
    }
    return flag_of(setting);
}

std::string phrase(const Remark& remark) {
    std::string text;
    if (remark.location) text += text_of(*remark.location) + ": ";
    if (!remark.setting.empty()) {
        text += fmt::format("{}{}", flag_and_value(remark.setting, remark.value), before_reason(remark.reason));
    }
    return text + phrase_settings(remark.reason, flag_and_value);
}

std::string json_parts(const Remark& remark) {
    std::string json;
    if (remark.location) json += fmt::format(R"(,"place":{})", location_json(*remark.location));
    if (!remark.setting.empty()) json += fmt::format(R"(,"setting":{})", json_string(remark.setting));
    if (!remark.value.empty()) json += fmt::format(R"(,"value":{})", json_string(remark.value));
    json += fmt::format(R"(,"reason":{})", json_string(remark.reason));
    const std::string named = named_settings_json(remark.reason);
    return json + (named.empty() ? "" : fmt::format(R"(,"settings":{{{}}})", named));
}

} // namespace pertev
