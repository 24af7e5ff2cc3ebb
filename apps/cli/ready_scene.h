#pragma once

// From flags to all that a picture needs before its first sample: the scene read and put to its time, its camera
// chosen, its trees built, the device's queue. What render and view begin with alike.

#include <memory>
#include <optional>

#include "apps/cli/render_flags.h"
#include "device/queue.h"
#include "session/moving_scene.h"
#include "session/opening/moving_camera.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct ReadyScene {
    RenderSettings settings;
    FrameSequence sequence;             // the one asked for, else a single frame; the scene is at its first
    std::optional<MovingCamera> camera; // always there, as the next
    std::optional<MovingScene> moving;
    double load_s = 0; // to read it
    std::unique_ptr<Queue> queue;

    const Scene& scene() const { return moving->scene(); }
    const PreparedScene& prepared() const { return moving->prepared(); }
};

/// Says what there is to say on the way. Throws Error.
std::unique_ptr<ReadyScene> make_ready(const RenderFlags& flags, Reporter& reporter);

/// Says what a time would show where none is given, or that one shows nothing.
void say_what_moves(const RenderFlags& flags, const MovingScene& moving, Messages& messages);

/// How the picture of the first frame is made, but for how it is displayed; with its camera.
PictureRecord picture_record(const PictureOptions& options, ReadyScene& ready, const Messages& messages);

} // namespace pertev
