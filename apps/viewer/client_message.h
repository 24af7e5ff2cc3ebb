#pragma once

// What a page says to the viewer: one JSON object a message. Parsing is strict: an unknown kind, an unknown or missing
// key, a key that stands twice, a number out of range or of the wrong type, a text too long: no message. Nothing of it
// reaches the renderer unchecked.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace pertev {

inline constexpr std::size_t kMaxMessageBytes = 1024;

enum class MessageKind : uint8_t {
    Hello,  // the first of a client: its key, by which a reconnect is known
    Move,   // keys held for a while
    Orbit,  // about the orbit's centre
    Look,   // about the eye
    Pan,    // across the view
    Zoom,   // towards the orbit's centre
    Speed,  // of Move
    Pick,   // what is at a place of the picture
    Home,   // back to the camera of the start
    Camera, // to one of the scene's cameras
    Set,    // one setting
    Meter,  // exposure by the light meter
    Play,   // time runs or stands, and how
    Time,   // to a time of the scene
    Key,    // the present view becomes a key of the camera's path
    Unkey,  // a key goes
    Follow, // the camera goes its path, from its beginning
    Rate,   // of the page's screen
    Shape,  // of the page's window
    Ack,    // a picture was drawn
    Ask,    // for the wheel
    Hand,   // the wheel, to another client
};

enum class Pace : uint8_t { Normal, Fast, Slow };
enum class PickUse : uint8_t { Show, Orbit, Focus };

struct ClientMessage {
    MessageKind kind = MessageKind::Hello;
    uint32_t input = 0;                      // its number, which comes back with the first picture that shows it
    float right = 0, up = 0, forward = 0;    // Move: [-1, 1]
    float seconds = 0;                       // Move: how long, [0, 0.25]
    Pace pace = Pace::Normal;                // Move
    float dx = 0, dy = 0;                    // Orbit, Look, Pan: in heights of the picture, [-4, 4]
    float steps = 0;                         // Zoom, Speed: of the wheel, [-20, 20]
    float x = 0, y = 0;                      // Pick: of the picture's width and height, [0, 1]
    PickUse use = PickUse::Show;             // Pick
    uint32_t index = 0;                      // Camera, Unkey
    bool on = false, loops = false;          // Play
    float speed = 1;                         // Play: of time, [0, 64]
    float at = 0;                            // Time, Key: seconds, [0, 1e9]
    float hertz = 0;                         // Rate: pictures a second, [1, 1000]
    uint32_t width = 0, height = 0;          // Shape: pixels of the screen, [1, 65535]
    uint32_t frame = 0;                      // Ack
    float milliseconds = 0;                  // Ack: of decoding and drawing, [0, 1e6]
    uint32_t client = 0;                     // Hand
    std::string key;                         // Hello
    std::string name;                        // Set
    std::variant<double, std::string> value; // Set: finite
};

/// Throws nothing. Not for use from several threads at once with one parser's state: it has none.
std::optional<ClientMessage> parse_client_message(std::string_view text);

/// Whether it asks for another view or another time: the picture before it is of no use any more.
bool moves_the_picture(MessageKind kind);

/// Returns what it asks for, as the end of a sentence that begins with "viewer 2 would like to". It is empty where it
/// steers nothing.
const char* wish_of(MessageKind kind);

} // namespace pertev
