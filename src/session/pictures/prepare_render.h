#pragma once

// Prepares everything that a picture needs before its first sample: reads the scene and sets its time, chooses its
// camera, builds its trees, takes the device's queue.

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/sink.h"
#include "device/queue.h"
#include "session/moving_scene.h"
#include "session/opening/moving_camera.h"
#include "session/opening/open_scene.h"
#include "session/pictures/render_sequence.h"
#include "session/pictures/solve_scene.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct RenderSetup {
    RenderSettings settings;
    FrameRange sequence;                // the requested frames, else a single one; the scene is at the first
    std::optional<MovingCamera> camera; // Never empty after prepare_render().
    std::vector<ListedCamera> list;     // cameras of a file, of which `camera` is the first
    std::optional<MovingScene> moving;
    Ground ground = Ground::Off;      // whether a ground was added, or might have been
    Messages reading;                 // messages of reading the scene, which belong to each picture of it
    Messages of_light, of_camera;     // messages of choosing them, which belong to each picture that keeps them
    bool must_choose = false;         // the scene was edited since they were chosen
    uint32_t changed_parts = 0;       // parts of the scene (ScenePart) that have changed since its owner took them
    std::string hash;                 // scene_hash() when it was read
    std::vector<FileOfPicture> files; // files_of_scene() when it was read
    double load_s = 0;                // seconds of reading
    std::size_t bytes = 0;            // that rendering takes on the device, as predicted
    std::shared_ptr<Queue> queue;     // whoever keeps arrays on the device shares it
    std::vector<std::shared_ptr<Queue>> queues; // the devices that render a picture together; the first is `queue`

    const Scene& scene() const { return moving->scene(); }
    const PreparedScene& prepared() const { return moving->prepared(); }
    std::string device_name() const; // with their number if there are several
};

/// The caller makes or changes a scene in memory. Each function may be empty.
struct SceneInMemory {
    ReadScene read;                   // makes it, as for open_scene
    std::function<void(Scene&)> edit; // changes numbers of the opened scene, which stays valid
};

/// Checks the options (check_options), prepares everything and reports progress to `sink`. Adds to `options` what the
/// scene's file suggests for the settings of `verbs`. If the integrator is radiosity, the scene is solved, of which
/// `report` shows the progress of solving. Throws Error, especially Error(OutOfMemory) if there is no room for the
/// picture, or less than the options allow, and Error(Interrupted) if the sink stops it.
std::unique_ptr<RenderSetup> prepare_render(PictureOptions& options, uint32_t verbs, Sink& sink,
                                            const SolveReport& report = {}, const SceneInMemory& in_memory = {});

/// Changes what prepare_render made by the options `before` to a picture by `options`, with its scene, trees and
/// device, and returns true; or returns false, without any effect, if one of these would change otherwise than by the
/// time of the scene. Throws as prepare_render; the setup is then to be adapted or made again.
bool adapt_setup(RenderSetup& ready, const PictureOptions& before, PictureOptions& options, uint32_t verbs, Sink& sink);

/// Records all given settings and their sources in a record that is otherwise complete; `frame` as settings_of_frame.
void record_settings(const PictureOptions& options, const Scene& scene, uint32_t frame, PictureRecord& record);

/// Returns the bytes that the picture, or a frame in real time, takes on the device. Throws Error(OutOfMemory).
std::size_t bytes_to_render(const PictureOptions& options, const PreparedScene& prepared,
                            const RenderSettings& settings, const Queue& queue);

/// Says at which times the scene moves if the options show it at rest, and which options have no effect because
/// nothing moves.
void report_motion(const PictureOptions& options, const MovingScene& moving, Sink& sink);

/// Returns the record of the first frame's picture, with its camera but without its display. Frames in real time begin
/// with it.
PictureRecord picture_record(const PictureOptions& options, RenderSetup& ready, const Messages& messages);

} // namespace pertev
