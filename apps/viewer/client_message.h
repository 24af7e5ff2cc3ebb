#pragma once

// Messages of a page to the viewer: one JSON object each. Parsing is strict: an unknown kind, an unknown, missing or
// repeated key, a number out of range or of the wrong type, or a text that is too long is an error. Everything that
// reaches the renderer has been checked.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace pertev {

inline constexpr std::size_t kMaxMessageBytes = 1024;

enum class MessageKind : uint8_t {
    Hello,          // the first message of a client: its key, by which it is recognised after a reconnect
    Move,           // keys held for a while
    Orbit,          // around the orbit's centre
    Look,           // around the eye
    Pan,            // across the view
    Zoom,           // towards the orbit's centre
    Speed,          // speed of Move
    Pick,           // query at a position of the picture
    Home,           // back to the initial camera
    Camera,         // to one of the scene's cameras
    Set,            // changes a setting
    Meter,          // exposure by the light meter
    Play,           // starts or stops time
    Time,           // sets the scene's time
    Key,            // adds the current view as a key of the camera's path
    Unkey,          // removes a key
    Follow,         // starts the camera's path from its beginning
    Rate,           // refresh rate of the page's screen
    Shape,          // size of the page's window
    Ack,            // a picture was drawn
    RequestControl, // requests control
    Hand,           // hands control to another client
};

enum class Pace : uint8_t { Normal, Fast, Slow };
enum class PickUse : uint8_t { Show, Orbit, Focus };

struct ClientMessage {
    MessageKind kind = MessageKind::Hello;
    uint32_t input = 0;                      // number of the input, which the first picture returns that shows its
                                             // effect
    float right = 0, up = 0, forward = 0;    // Move: [-1, 1]
    float seconds = 0;                       // Move: duration, [0, 0.25]
    Pace pace = Pace::Normal;                // Move
    float dx = 0, dy = 0;                    // Orbit, Look, Pan: in picture heights, [-4, 4]
    float steps = 0;                         // Zoom, Speed: steps of the mouse wheel, [-20, 20]
    float x = 0, y = 0;                      // Pick: fraction of the picture's width and height, [0, 1]
    PickUse use = PickUse::Show;             // Pick
    uint32_t index = 0;                      // Camera, Unkey
    bool on = false, loops = false;          // Play
    float speed = 1;                         // Play: speed of time, [0, 64]
    float at = 0;                            // Time, Key: seconds, [0, 1e9]
    float hertz = 0;                         // Rate: pictures per second, [1, 1000]
    uint32_t width = 0, height = 0;          // Shape: screen pixels, [1, 65535]
    uint32_t frame = 0;                      // Ack
    float milliseconds = 0;                  // Ack: time of decoding and drawing, [0, 1e6]
    uint32_t client = 0;                     // Hand
    std::string key;                         // Hello
    std::string name;                        // Set
    std::variant<double, std::string> value; // Set: finite
};

/// Parses a message; does not throw. Thread-safe.
std::optional<ClientMessage> parse_client_message(std::string_view text);

/// Returns whether a message of this kind changes the view or the time, which makes the previous picture useless.
bool moves_the_picture(MessageKind kind);

/// Returns the meaning of a message as the end of a sentence that begins with "viewer 2 would like to"; empty if it
/// steers nothing.
const char* request_of(MessageKind kind);

} // namespace pertev
