#include "apps/viewer/client_message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <simdjson.h>

namespace pertev {
namespace {

namespace dom = simdjson::dom;

bool read_number(dom::element value, double low, double high, double& number) {
    if (!value.is_number()) return false;
    return value.get_double().get(number) == simdjson::SUCCESS && std::isfinite(number) && number >= low &&
           number <= high;
}

template <float ClientMessage::*Field, int Low, int High>
bool read_float(dom::element value, ClientMessage& message) {
    double number = 0;
    if (!read_number(value, Low, High, number)) return false;
    message.*Field = static_cast<float>(number);
    return true;
}

template <bool ClientMessage::*Field>
bool read_bool(dom::element value, ClientMessage& message) {
    return value.get_bool().get(message.*Field) == simdjson::SUCCESS;
}

template <uint32_t ClientMessage::*Field>
bool read_whole(dom::element value, ClientMessage& message) {
    uint64_t number = 0;
    if (value.get_uint64().get(number) != simdjson::SUCCESS || number > UINT32_MAX) return false;
    message.*Field = static_cast<uint32_t>(number);
    return true;
}

template <uint32_t ClientMessage::*Field>
bool read_side(dom::element value, ClientMessage& message) {
    return read_whole<Field>(value, message) && message.*Field >= 1 && message.*Field <= 65535;
}

bool read_text(dom::element value, std::size_t longest, std::string& text) {
    std::string_view found;
    if (value.get_string().get(found) != simdjson::SUCCESS || found.size() > longest) return false;
    for (const char c : found) {
        if (c < ' ' || c > '~') return false;
    }
    text = found;
    return true;
}

template <std::string ClientMessage::*Field, std::size_t Longest>
bool read_string(dom::element value, ClientMessage& message) {
    return read_text(value, Longest, message.*Field);
}

template <class Enum, Enum ClientMessage::*Field, std::size_t Count>
bool read_name(dom::element value, ClientMessage& message, const char* const (&names)[Count]) {
    std::string_view found;
    if (value.get_string().get(found) != simdjson::SUCCESS) return false;
    for (std::size_t i = 0; i < Count; ++i) {
        if (found == names[i]) {
            message.*Field = static_cast<Enum>(i);
            return true;
        }
    }
    return false;
}

constexpr const char* kPaces[] = {"normal", "fast", "slow"};
constexpr const char* kUses[] = {"show", "orbit", "focus"};

bool read_pace(dom::element value, ClientMessage& message) {
    return read_name<Pace, &ClientMessage::pace>(value, message, kPaces);
}

bool read_use(dom::element value, ClientMessage& message) {
    return read_name<PickUse, &ClientMessage::use>(value, message, kUses);
}

bool read_value(dom::element value, ClientMessage& message) {
    double number = 0;
    if (read_number(value, -1e12, 1e12, number)) {
        message.value = number;
        return true;
    }
    std::string text;
    if (!read_text(value, 64, text)) return false;
    message.value = std::move(text);
    return true;
}

struct Key {
    const char* name;
    bool (*read)(dom::element, ClientMessage&);
};

constexpr Key kInput = {"n", read_whole<&ClientMessage::input>};
constexpr Key kDx = {"dx", read_float<&ClientMessage::dx, -4, 4>}, kDy = {"dy", read_float<&ClientMessage::dy, -4, 4>};
constexpr Key kSteps = {"steps", read_float<&ClientMessage::steps, -20, 20>};

constexpr Key kHelloKeys[] = {{"key", read_string<&ClientMessage::key, 64>}};
constexpr Key kMoveKeys[] = {kInput,
                             {"right", read_float<&ClientMessage::right, -1, 1>},
                             {"up", read_float<&ClientMessage::up, -1, 1>},
                             {"forward", read_float<&ClientMessage::forward, -1, 1>},
                             {"ms", read_float<&ClientMessage::milliseconds, 0, 250>},
                             {"pace", read_pace}};
constexpr Key kDragKeys[] = {kInput, kDx, kDy};
constexpr Key kStepKeys[] = {kInput, kSteps};
constexpr Key kPickKeys[] = {
    kInput, {"x", read_float<&ClientMessage::x, 0, 1>}, {"y", read_float<&ClientMessage::y, 0, 1>}, {"use", read_use}};
constexpr Key kPlainKeys[] = {kInput};
constexpr Key kCameraKeys[] = {kInput, {"index", read_whole<&ClientMessage::index>}};
constexpr Key kAt = {"at", read_float<&ClientMessage::at, 0, 1000000000>};
constexpr Key kTimeKeys[] = {kInput, kAt};
constexpr Key kPlayKeys[] = {kInput,
                             {"on", read_bool<&ClientMessage::on>},
                             {"loops", read_bool<&ClientMessage::loops>},
                             {"speed", read_float<&ClientMessage::speed, 0, 64>}};
constexpr Key kSetKeys[] = {kInput, {"name", read_string<&ClientMessage::name, 32>}, {"value", read_value}};
constexpr Key kAckKeys[] = {{"frame", read_whole<&ClientMessage::frame>},
                            {"ms", read_float<&ClientMessage::milliseconds, 0, 1000000>}};
constexpr Key kRateKeys[] = {{"hz", read_float<&ClientMessage::hertz, 1, 1000>}};
constexpr Key kShapeKeys[] = {{"width", read_side<&ClientMessage::width>},
                              {"height", read_side<&ClientMessage::height>}};
constexpr Key kHandKeys[] = {{"to", read_whole<&ClientMessage::client>}};

struct Form {
    const char* type;
    MessageKind kind;
    std::span<const Key> keys; // each must be present exactly once
    const char* request = "";  // request of a client that does not steer
    bool moves_the_picture = false;
};

constexpr Form kForms[] = {
    {"hello", MessageKind::Hello, kHelloKeys},
    {"move", MessageKind::Move, kMoveKeys, "move the camera", true},
    {"orbit", MessageKind::Orbit, kDragKeys, "orbit the view", true},
    {"look", MessageKind::Look, kDragKeys, "look around", true},
    {"pan", MessageKind::Pan, kDragKeys, "pan the view", true},
    {"zoom", MessageKind::Zoom, kStepKeys, "zoom", true},
    {"speed", MessageKind::Speed, kStepKeys, "change the speed of the camera"},
    {"pick", MessageKind::Pick, kPickKeys, "focus on a surface"},
    {"home", MessageKind::Home, kPlainKeys, "return to the initial camera", true},
    {"camera", MessageKind::Camera, kCameraKeys, "look through another camera", true},
    {"set", MessageKind::Set, kSetKeys, "change a setting"},
    {"meter", MessageKind::Meter, kPlainKeys, "meter the light"},
    {"play", MessageKind::Play, kPlayKeys, "play time"},
    {"time", MessageKind::Time, kTimeKeys, "go to another time", true},
    {"key", MessageKind::Key, kTimeKeys, "change the camera path"},
    {"unkey", MessageKind::Unkey, kCameraKeys, "change the camera path"},
    {"follow", MessageKind::Follow, kPlainKeys, "play the camera path", true},
    {"rate", MessageKind::Rate, kRateKeys},
    {"shape", MessageKind::Shape, kShapeKeys},
    {"ack", MessageKind::Ack, kAckKeys},
    {"ask", MessageKind::RequestControl, {}},
    {"hand", MessageKind::Hand, kHandKeys},
};

static_assert(std::size(kForms) == static_cast<std::size_t>(MessageKind::Hand) + 1);

const Form& form_of(MessageKind kind) { return *std::ranges::find(kForms, kind, &Form::kind); }

const Form* form_of(dom::object object) {
    std::string_view type;
    if (object["type"].get_string().get(type) != simdjson::SUCCESS) return nullptr;
    for (const Form& form : kForms) {
        if (type == form.type) return &form;
    }
    return nullptr;
}

bool read_keys(dom::object object, const Form& form, ClientMessage& message) {
    std::array<bool, 8> seen{}; // the form's keys, then "type"
    std::size_t count = 0;
    for (const auto [name, value] : object) {
        std::size_t i = 0;
        while (i < form.keys.size() && name != form.keys[i].name) ++i;
        if (i == form.keys.size() && name != "type") return false;
        if (seen[i]) return false;
        seen[i] = true;
        ++count;
        if (i < form.keys.size() && !form.keys[i].read(value, message)) return false;
    }
    return count == form.keys.size() + 1;
}

} // namespace

std::optional<ClientMessage> parse_client_message(std::string_view text) {
    if (text.empty() || text.size() > kMaxMessageBytes) return std::nullopt;
    dom::parser parser(kMaxMessageBytes + simdjson::SIMDJSON_PADDING);
    dom::object object;
    if (parser.parse(text.data(), text.size()).get_object().get(object) != simdjson::SUCCESS) return std::nullopt;
    const Form* form = form_of(object);
    if (form == nullptr) return std::nullopt;
    ClientMessage message;
    message.kind = form->kind;
    if (!read_keys(object, *form, message)) return std::nullopt;
    if (message.kind == MessageKind::Move) message.seconds = message.milliseconds / 1000;
    return message;
}

bool moves_the_picture(MessageKind kind) { return form_of(kind).moves_the_picture; }
const char* request_of(MessageKind kind) { return form_of(kind).request; }

} // namespace pertev
