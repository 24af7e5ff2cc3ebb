#pragma once

// pertev view without its flags: pictures of a scene in browsers, until it is told to end. Three threads besides those
// that render: the caller's steers and renders, one speaks with the network, one packs pictures.

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
    uint16_t port = 8080; // 0: any that is free
    WebLimits limits;
    Queue* jpeg_queue = nullptr; // of a GPU, for nothing but packing pictures; outlives the viewer. Null: the CPU packs
};

/// What is looked at, and how it begins.
struct ViewerStart {
    const Scene* scene = nullptr;  // outlives the viewer; at the time that the frame source was put to
    bool is_animated = false;      // whether time moves it
    std::string why_still;         // for people: why time does not move a scene with animations; empty: nothing to say
    std::optional<double> still_s; // the time that it is then at, seconds; none: at rest
    ViewState view;
    StartCamera camera;
    SceneClock clock;
    PictureRecord record; // for pictures that are saved
    float speed = 1;      // metres a second of keys
    /// The panel says this of the scene beside its name: a label and its value a row, in the group "Scene".
    std::vector<std::pair<std::string, std::string>> about;
};

/// Listens, calls `listening` with the address that lets in whoever has it, and goes on as long as `goes_on` says so;
/// it is asked often. Throws Error(BadInput) where it cannot listen, Error(DeviceFault).
void run_viewer(const ViewerOptions& options, const ViewerStart& start, FrameSource& source,
                const std::function<void(const std::string& address)>& listening, const std::function<bool()>& goes_on);

} // namespace pertev
