#include "apps/viewer/wish_text.h"

#include <fmt/format.h>

#include "apps/viewer/view_state.h"

namespace pertev {
namespace {

std::string setting_wish(const ClientMessage& message) {
    for (const ViewSetting& setting : view_settings()) {
        if (setting.name != message.name) continue;
        const double* number = std::get_if<double>(&message.value);
        return fmt::format("set \"{}\" to {}", setting.label,
                           number != nullptr ? fmt::format("{:g}", *number) : std::get<std::string>(message.value));
    }
    return "change a setting";
}

} // namespace

std::string wish_text(const ClientMessage& message) {
    switch (message.kind) {
    case MessageKind::Move:
        return "move the camera";
    case MessageKind::Orbit:
        return "turn the view";
    case MessageKind::Look:
        return "look around";
    case MessageKind::Pan:
        return "pan the view";
    case MessageKind::Zoom:
        return "come closer or go away";
    case MessageKind::Speed:
        return "change the speed of the camera";
    case MessageKind::Pick:
        return message.use == PickUse::Focus ? "bring something into focus" : "turn about another place";
    case MessageKind::Home:
        return "go back to the camera of the start";
    case MessageKind::Camera:
        return "look through another camera";
    case MessageKind::Set:
        return setting_wish(message);
    case MessageKind::Meter:
        return "meter the light";
    case MessageKind::Play:
        return message.on ? "let time run" : "stop time";
    case MessageKind::Time:
        return "go to another time";
    case MessageKind::Key:
    case MessageKind::Unkey:
        return "change the path of the camera";
    case MessageKind::Follow:
        return "play the path of the camera";
    case MessageKind::Hello:
    case MessageKind::Rate:
    case MessageKind::Shape:
    case MessageKind::Ack:
    case MessageKind::Ask:
    case MessageKind::Hand:
        return {};
    }
    return {};
}

} // namespace pertev
