#include "base/remark.h"

#include <fmt/format.h>

namespace pertev {
namespace {

std::string marked(std::string_view setting, std::string_view value) {
    return fmt::format("`{}{}{}`", setting, value.empty() ? "" : "=", value);
}

} // namespace

std::string text_of(const FileLocation& location) {
    if (location.line > 0) return fmt::format("{}:{}", location.file, location.line);
    if (!location.pointer) return location.file;
    return fmt::format("{}: {}", location.file, location.pointer->empty() ? "/" : *location.pointer);
}

std::string_view before_reason(std::string_view reason) { return reason.starts_with("not ") ? " is " : ": "; }

std::string Remark::text() const {
    std::string text;
    if (location) text += text_of(*location) + ": ";
    if (!setting.empty()) text += fmt::format("{}{}", marked(setting, value), before_reason(reason));
    return text + reason;
}

Remark Remark::and_then(std::string_view more) const {
    Remark longer = *this;
    longer.reason += more;
    return longer;
}

} // namespace pertev
