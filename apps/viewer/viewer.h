#pragma once

// pertev view without its flags: shows pictures of a scene in browsers until it is ended. It has three threads
// besides those that render: the caller's steers and renders, one handles the network, one encodes pictures.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "apps/viewer/frame_source.h"
#include "apps/viewer/scene_clock.h"
#include "apps/viewer/view_camera.h"
#include "apps/viewer/web_server.h"
#include "scene/scene.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct ViewerOptions {
    std::string host = "127.0.0.1";
    uint16_t port = 8080; // 0: any free port
    std::string token;    // empty: a new random one
    bool embed = false;   // pages of others, such as notebooks, may show the viewer in a frame
    WebLimits limits;
    Queue* jpeg_queue = nullptr; // GPU queue only for encoding pictures; outlives the viewer. Null: the CPU encodes
};

/// The scene of a viewer and its initial state.
struct ViewerStart {
    const Scene* scene = nullptr;  // outlives the viewer; at the time of the frame source
    bool is_animated = false;      // whether time moves it
    std::string why_still;         // for people: why time does not move a scene with animations; empty: no message
    std::optional<double> still_s; // fixed time of a scene that does not move, in seconds; none: at rest
    ViewState view;
    StartCamera camera;
    SceneClock clock;
    PictureRecord record;   // for saved pictures
    PictureOptions options; // the picture's, which the panel changes
    float speed = 1;        // metres per second of keys
    /// Rows about the scene in the panel's group "Scene": labels with values.
    std::vector<std::pair<std::string, std::string>> about;
};

/// Listens, calls `listening` with the address that grants access (a given token is to be added to its end), and
/// continues while `goes_on` returns true; it is called often. Throws Error(BadInput) if it cannot listen,
/// Error(DeviceFault).
void run_viewer(const ViewerOptions& options, const ViewerStart& start, FrameSource& source,
                const std::function<void(const std::string& address)>& listening, const std::function<bool()>& goes_on);

} // namespace pertev
