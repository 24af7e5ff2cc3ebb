#include "apps/viewer/request_text.h"

#include <fmt/format.h>

#include "apps/viewer/view_state.h"

namespace pertev {
namespace {

std::string setting_request(const ClientMessage& message) {
    for (const ViewSetting& setting : view_settings()) {
        if (setting.name != message.name) continue;
        const double* number = std::get_if<double>(&message.value);
        return fmt::format("set \"{}\" to {}", setting.label,
                           number != nullptr ? fmt::format("{:g}", *number) : std::get<std::string>(message.value));
    }
    return "change a setting";
}

} // namespace

std::string request_text(const ClientMessage& message) {
    if (message.kind == MessageKind::Set) return setting_request(message);
    if (message.kind == MessageKind::Pick && message.use != PickUse::Focus) return "set another orbit centre";
    if (message.kind == MessageKind::Play && !message.on) return "stop time";
    return request_of(message.kind);
}

} // namespace pertev
