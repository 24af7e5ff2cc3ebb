#pragma once

// The frames of pertev render --frames and --turntable: one after the other by one session, which takes over from frame
// to frame what does not move.

#include "apps/cli/render_flags.h"
#include "session/moving_scene.h"
#include "session/opening/moving_camera.h"
#include "session/session.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

/// Where the camera is at each frame.
struct FrameCamera {
    const MovingCamera& camera;
    FrameSequence sequence;
};

/// Takes the session's scene to a time; none: it stays. Throws as MovingScene::set_time and Session::update_scene.
void go_to(std::optional<double> time_s, MovingScene& moving, Session& session, Messages& messages);
/// The camera at a time, and after a share of a turn.
CameraSource camera_at(const MovingCamera& camera, const Scene& scene, std::optional<double> time_s, double turn);
/// Gives `record` the camera and the time of `frame`; `moving` is at that time. Where there is a shutter the camera
/// moves while it is open.
void place_frame(uint32_t frame, MovingScene& moving, const FrameCamera& camera, PictureRecord& record);
/// Takes scene, camera and record to `frame`. Throws as go_to.
void go_to_frame(uint32_t frame, const FrameCamera& camera, MovingScene& moving, Session& session,
                 PictureRecord& record, Messages& messages);

/// The first frame in real time of a sequence that these flags ask for.
ReconstructedFrame reconstructed_frame(const RenderFlags& flags, const FrameSequence& sequence);

/// `moving`, `session` and `record` are those of the first frame, exposed as all frames will be. Where record.frame is
/// there, frames are in real time: the first one comes after a cut. Ctrl-C ends after the last whole frame. Returns the
/// exit status. Throws Error.
int render_frames(const RenderFlags& flags, const FrameCamera& camera, MovingScene& moving, PictureRecord& record,
                  Session& session, Reporter& reporter);

} // namespace pertev
