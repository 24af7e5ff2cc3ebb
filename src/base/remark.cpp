#include "base/remark.h"

#include <fmt/format.h>

namespace pertev {
namespace {

std::string marked(std::string_view setting, std::string_view value) {
    return fmt::format("`{}{}{}`", setting, value.empty() ? "" : "=", value);
}

} // namespace

std::string text_of(const Place& place) {
    if (place.line > 0) return fmt::format("{}:{}", place.file, place.line);
    if (!place.pointer) return place.file;
    return fmt::format("{}: {}", place.file, place.pointer->empty() ? "/" : *place.pointer);
}

std::string Remark::text() const {
    std::string text;
    if (place) text += text_of(*place) + ": ";
    if (!setting.empty()) text += marked(setting, value) + ": ";
    return text + reason;
}

Remark Remark::and_then(std::string_view more) const {
    Remark longer = *this;
    longer.reason += more;
    return longer;
}

} // namespace pertev
