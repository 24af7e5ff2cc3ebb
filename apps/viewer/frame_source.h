#pragma once

// The seam between the viewer and whatever makes its pictures: time, camera and settings in; after a budget of time a
// picture that can be shown, and its numbers, out. Called by one thread, the one that the device's queue belongs to.

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
    bool is_moving = false; // camera or time changes now: a frame that comes soon, at a resolution that can
    double budget_s = 0.1;  // roughly how long next() may take; a sample of all pixels is the least
    /// Called by next() now and then while something is made before samples: the share of it that is done, [0, 1).
    std::function<void(double share)> tell_made;
};

/// Milliseconds by name, in the order of the stages.
using StageTimes = std::vector<std::pair<std::string, double>>;

struct ShownFrame {
    Rgba8Image image;
    uint32_t full_width = 0, full_height = 0; // of the picture at rest
    uint32_t samples = 0;                     // a pixel, in this image
    bool is_final = false;                    // all that were asked for are there, at full size: nothing more will come
    bool is_reference = false;                // of the picture that pertev render makes
    std::string hash;                         // of the film where that is known; empty otherwise
    std::string caption;                      // of a layer: what its colours mean
    float exposure_stops = 0;                 // that it is shown with
    float found_stops = 0;                    // of these, what was found where the exposure is found by itself
    RayCounts rays;                           // traced for it
    double render_s = 0;                      // of these rays, and of shading
    SceneTracer::Seconds kind_seconds;        // of these rays, where they were timed by kind
    float scale = 1;                          // of the full size
    double kept_rate = 0;                     // frames a second that this scale was chosen for; 0: it was asked for
    bool keeps_rate = true;                   // by frames before; false: no scale is small enough
    StageTimes stages;
};

/// What is at a place of the picture.
struct PickedPoint {
    uint32_t instance = 0, primitive = 0, material = 0;
    float distance = 0;    // from the eye, metres
    Vec3 position, normal; // in the scene's coordinates
    Rgb albedo;
    std::optional<Rgb> light; // of the pixel, linear, where the picture at rest is there
};

class FrameSource {
public:
    virtual ~FrameSource() = default;

    /// Puts the scene to this time; until then it is at rest, or where it began. Throws Error(OverLimit) where
    /// something lies too far out then; the next set_time makes good for it. Throws as next().
    virtual void set_time(double time_s) = 0;
    /// The next picture: at rest more samples gather in the one before; where a sample takes long, smaller pictures
    /// come before the first. Nothing where `abandon` or `hurry` broke it off, which is for pictures at rest alone: the
    /// movement's are short. Throws Error(OutOfMemory, OverLimit, DeviceFault).
    virtual std::optional<ShownFrame> next(const FrameRequest& request) = 0;
    /// While it is true, the picture at rest that is under way is not wanted any more.
    virtual std::atomic<bool>& abandon() = 0;
    /// While it is true, somebody waits for next() to return, though its samples stay wanted: where a sample takes
    /// long, the one under way is given up and those before stay.
    virtual std::atomic<bool>& hurry() = 0;

    /// What lies at (x, y) of the picture, [0, 1] each from the upper left; nothing for the background.
    virtual std::optional<PickedPoint> pick(const Camera& camera, float x, float y) = 0;
    /// Stops that the light meter finds for this view.
    virtual float meter(const FrameRequest& request) = 0;
    /// The picture in linear light as it is at rest, with all that a file of it holds.
    virtual RenderResult result() = 0;
};

} // namespace pertev
