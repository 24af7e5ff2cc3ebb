#pragma once

// From what is asked for to all that a picture needs before its first sample: the scene read and put to its time, its
// camera chosen, its trees built, the device's queue.

#include <functional>
#include <memory>
#include <optional>

#include "device/queue.h"
#include "session/moving_scene.h"
#include "session/opening/moving_camera.h"
#include "session/pictures/render_sequence.h"
#include "session/sink.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct ReadyScene {
    RenderSettings settings;
    FrameRange sequence;                // the one asked for, else a single frame; the scene is at its first
    std::optional<MovingCamera> camera; // always there, as the next
    std::optional<MovingScene> moving;
    double load_s = 0; // to read it
    std::unique_ptr<Queue> queue;

    const Scene& scene() const { return moving->scene(); }
    const PreparedScene& prepared() const { return moving->prepared(); }
};

/// Finds the light that radiosity shows of a scene.
using SolveRadiosity = std::function<RadiosityLook(ReadyScene& ready)>;

/// Makes all of it ready, and tells `sink` what goes on. Gives `options` what the scene's file suggests of the settings
/// of `verbs`. `solve` is asked for if the integrator is radiosity. Throws Error.
std::unique_ptr<ReadyScene> make_ready(PictureOptions& options, uint32_t verbs, Sink& sink,
                                       const SolveRadiosity& solve);

/// Returns how the picture of the first frame is made, with its camera, but without its display.
PictureRecord picture_record(const PictureOptions& options, ReadyScene& ready, const Messages& messages);

} // namespace pertev
