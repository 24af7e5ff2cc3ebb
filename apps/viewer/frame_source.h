#pragma once

// The interface between the viewer and the maker of its pictures: takes time, camera, settings and a time budget, and
// returns a picture for display with its statistics. It is called by one thread, the one that owns the device's
// queue.

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/viewer/view_state.h"
#include "image/image.h"
#include "integrators/integrator.h"
#include "settings/render_settings.h"

namespace pertev {

struct FrameRequest {
    Camera camera;
    ViewState view;
    bool is_moving = false; // camera or time is changing: the frame should come soon, at a lower resolution if needed
    double budget_s = 0.1;  // approximate time limit of next(); it renders at least one sample of all pixels
    /// Called occasionally by next() during precomputation, with the share that is done, [0, 1).
    std::function<void(double share)> on_progress;
};

/// Milliseconds by name, in the order of the stages.
using StageTimes = std::vector<std::pair<std::string, double>>;

struct ShownFrame {
    Rgba8Image image;
    uint32_t full_width = 0, full_height = 0; // size of the picture at rest
    uint32_t samples = 0;                     // per pixel, in this image
    bool is_final = false;                    // all requested samples are done at full size, so nothing more will
                                              // come
    bool is_reference = false;                // whether it shows the picture of pertev render
    std::string hash;                         // hash of the film if known; else empty
    std::string caption;                      // meaning of a layer's colours
    float exposure_stops = 0;                 // exposure of the shown picture
    float found_stops = 0;                    // the part of these stops that automatic exposure found
    RayCounts rays;                           // rays traced for this frame
    double render_s = 0;                      // time of these rays and of shading
    SceneTracer::Seconds kind_seconds;        // times of these rays, if they were timed by kind
    float scale = 1;                          // scale relative to the full size
    double kept_rate = 0;                     // frames per second for which this scale was chosen; 0: it was set by
                                              // the user
    bool keeps_rate = true;                   // according to earlier frames; false: no scale is small enough
    StageTimes stages;
};

/// Result of a query at a position of the picture.
struct PickedPoint {
    uint32_t instance = 0, primitive = 0, material = 0;
    float distance = 0;    // from the eye, metres
    Vec3 position, normal; // in the scene's coordinates
    Rgb albedo;
    std::optional<Rgb> light; // linear colour of the pixel, if the picture at rest exists
};

class FrameSource {
public:
    virtual ~FrameSource() = default;

    /// Moves the scene to this time; until then it is at rest, or at its initial time. Throws Error(OverLimit) if
    /// something is too far out then; the next set_time repairs the state. Throws as next().
    virtual void set_time(double time_s) = 0;
    /// Returns the next picture: at rest more samples are added to the previous one; if a sample takes long, smaller
    /// pictures come before the first. Returns nothing if `abandon` or `hurry` stopped it, which happens only at
    /// rest, because moving pictures are short. Throws Error(OutOfMemory, OverLimit, DeviceFault).
    virtual std::optional<ShownFrame> next(const FrameRequest& request) = 0;
    /// While it is true, the current picture at rest is no longer needed.
    virtual std::atomic<bool>& abandon() = 0;
    /// While it is true, someone waits for next() to return, but its samples are still needed: if a sample takes
    /// long, the current one is abandoned and earlier ones are kept.
    virtual std::atomic<bool>& hurry() = 0;

    /// Surface at (x, y) of the picture, [0, 1] each from the upper left; nothing for the background.
    virtual std::optional<PickedPoint> pick(const Camera& camera, float x, float y) = 0;
    /// Stops from the light meter for this view.
    virtual float meter(const FrameRequest& request) = 0;
    /// The picture at rest in linear light, with everything that a file of it contains.
    virtual RenderResult result() = 0;
};

} // namespace pertev
