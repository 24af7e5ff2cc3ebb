#pragma once

// From flags to all that a picture needs before its first sample: the scene read, its camera chosen, its trees built,
// the device's queue. What render and view begin with alike.

#include <memory>

#include "apps/cli/render_flags.h"
#include "device/queue.h"
#include "render/prepare_scene.h"
#include "session/picture_metadata.h"

namespace pertev {

struct ReadyScene {
    Scene scene;
    RenderSettings settings;
    Camera camera;
    PreparedScene prepared; // points to `scene`
    double load_s = 0;      // to read it
    std::unique_ptr<Queue> queue;
};

/// Says what there is to say on the way. `flags` get the target that an eye alone looks at (aim_eye). Throws Error.
std::unique_ptr<ReadyScene> make_ready(RenderFlags& flags, Reporter& reporter);

/// How its picture is made, but for how it is displayed.
PictureRecord picture_record(const SceneOptions& options, const ReadyScene& ready);

} // namespace pertev
