#pragma once

// Prepares everything that a picture needs before its first sample: reads the scene and sets its time, chooses its
// camera, builds its trees, takes the device's queue.

#include <functional>
#include <memory>
#include <optional>

#include "base/sink.h"
#include "device/queue.h"
#include "session/moving_scene.h"
#include "session/opening/moving_camera.h"
#include "session/pictures/render_sequence.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct RenderSetup {
    RenderSettings settings;
    FrameRange sequence;                // the requested frames, else a single one; the scene is at the first
    std::optional<MovingCamera> camera; // Never empty after prepare_render().
    std::optional<MovingScene> moving;
    double load_s = 0; // seconds of reading
    std::unique_ptr<Queue> queue;

    const Scene& scene() const { return moving->scene(); }
    const PreparedScene& prepared() const { return moving->prepared(); }
};

/// A function that computes the radiosity solution of a scene.
using SolveRadiosity = std::function<RadiosityDisplay(RenderSetup& ready)>;

/// Prepares everything and reports progress to `sink`. Adds to `options` what the scene's file suggests for the
/// settings of `verbs`. Calls `solve` if the integrator is radiosity. Throws Error, and
/// Error(Interrupted) if the sink stops it.
std::unique_ptr<RenderSetup> prepare_render(PictureOptions& options, uint32_t verbs, Sink& sink,
                                            const SolveRadiosity& solve);

/// Records all given settings and their sources, with the resulting size and number of samples, in `source`.
void record_settings(PictureOptions options, const RenderSettings& settings, const Scene& scene, SceneSource& source);

/// Returns the record of the first frame's picture, with its camera but without its display.
PictureRecord picture_record(const PictureOptions& options, RenderSetup& ready, const Messages& messages);

} // namespace pertev
