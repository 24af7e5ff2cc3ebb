#pragma once

// Renders the frames of a moving scene in one session, which keeps from frame to frame whatever does not move. A
// frame equals, to the byte, the picture at its time, or in real time the next frame of its sequence.

#include <span>

#include "session/frame_range.h"
#include "session/moving_scene.h"
#include "session/opening/moving_camera.h"
#include "session/session.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

/// A camera of a list, and the size of its pictures.
struct ListedCamera {
    MovingCamera camera;
    PictureSize size;
};

/// The camera at each frame.
struct FrameCamera {
    const MovingCamera& camera;
    FrameRange sequence;
    std::span<const ListedCamera> list = {}; // camera of each frame, in place of `camera`; empty: none
};

/// Moves the session's scene to a time, if there is one. Throws as MovingScene::set_time and Session::update_scene.
void seek(std::optional<double> time_s, MovingScene& moving, Session& session, Sink& sink);
/// Returns the camera at a time, and after a fraction of a revolution.
CameraSource camera_at(const MovingCamera& camera, const Scene& scene, std::optional<double> time_s, double turn);
/// Sets the camera, its size and the time of `frame` in `record`; `moving` is at that time. The camera moves while a
/// shutter is open.
void place_frame(uint32_t frame, MovingScene& moving, const FrameCamera& camera, PictureRecord& record);
/// Moves scene, camera and record to `frame`. Throws as seek.
void seek_frame(uint32_t frame, const FrameCamera& camera, MovingScene& moving, Session& session, PictureRecord& record,
                Sink& sink);

/// Everything needed to render any frame. `record` describes the last one.
struct SequenceOfFrames {
    const FrameCamera& camera;
    MovingScene& moving;
    PictureRecord& record;
    Session& session;
};
struct RenderedFrame {
    RenderResult result; // with fewer samples than requested if the sink stopped it
    double update_s = 0; // seconds for the update of the scene
};
/// Goes to `frame` and renders it: in real time if the record has a frame, else as a picture with its samples. Throws
/// as seek and Session::render.
RenderedFrame render_frame(uint32_t frame, const SequenceOfFrames& frames, Sink& sink);

} // namespace pertev
