#pragma once

// The frames of a moving scene, one after the other by one session, which takes over from frame to frame what does not
// move. A frame is to the byte the picture of its time, or in real time the next frame of its sequence.

#include "session/frame_range.h"
#include "session/moving_scene.h"
#include "session/opening/moving_camera.h"
#include "session/session.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

/// Where the camera is at each frame.
struct FrameCamera {
    const MovingCamera& camera;
    FrameRange sequence;
};

/// Takes the session's scene to a time; it stays if there is none. Throws as MovingScene::set_time and
/// Session::update_scene.
void go_to(std::optional<double> time_s, MovingScene& moving, Session& session, Messages& messages);
/// Returns the camera at a time, and after a share of a turn.
CameraSource camera_at(const MovingCamera& camera, const Scene& scene, std::optional<double> time_s, double turn);
/// Gives `record` the camera and the time of `frame`; `moving` is at that time. The camera moves while a shutter is
/// open.
void place_frame(uint32_t frame, MovingScene& moving, const FrameCamera& camera, PictureRecord& record);
/// Takes scene, camera and record to `frame`. Throws as go_to.
void go_to_frame(uint32_t frame, const FrameCamera& camera, MovingScene& moving, Session& session,
                 PictureRecord& record, Messages& messages);

/// What every frame is rendered with. `record` tells of the last one.
struct SequenceOfFrames {
    const FrameCamera& camera;
    MovingScene& moving;
    PictureRecord& record;
    Session& session;
};
struct RenderedFrame {
    RenderResult result; // with fewer samples than were asked for if `keep_going` ended it
    double update_s = 0; // seconds that it took to move the scene
};
/// Goes to `frame` and renders it: in real time if the record has a frame, and else as a picture of its samples. Throws
/// as go_to and Session::render.
RenderedFrame render_frame(uint32_t frame, const SequenceOfFrames& frames, Messages& messages,
                           const FilmRender::KeepGoing& keep_going);

} // namespace pertev
