#pragma once

// The render's thread: handles requests of clients, advances time, moves the camera, gets pictures from the frame
// source and publishes them. It renders only while a client watches and there is something to do.

#include <functional>
#include <optional>
#include <vector>

#include "apps/viewer/packer.h"
#include "apps/viewer/view_camera.h"
#include "apps/viewer/viewer.h"
#include "base/error.h"

namespace pertev {

class RenderLoop {
public:
    /// The arguments must outlive this object.
    RenderLoop(const ViewerStart& start, FrameSource& source, Inbox& inbox, Audience& audience, const Packer& packer,
               std::function<double()> now_s);

    /// Runs until `goes_on` returns false. Throws Error(DeviceFault).
    void run(const std::function<bool()>& goes_on);

private:
    void handle(const Command& command);
    void steer(const Steer& steer);
    void reshape(const ClientMessage& message);
    void steer_time(const ClientMessage& message);
    void steer_path(const Steer& steer);
    void pick(const Steer& steer);
    void report_error(uint32_t client, const Error& error);
    void set(const Steer& steer);
    void advance_time();
    void follow_time();
    std::optional<ShownFrame> next_frame(const FrameRequest& request);
    void show_next();
    void save_pictures();
    PictureRecord record() const;
    PictureOptions options_for(const PictureRecord& record) const;
    void report_state();
    bool time_matters() const;
    bool time_runs() const;
    bool is_moving() const;
    FrameRequest request() const;

    const ViewerStart& start_;
    FrameSource& source_;
    Inbox& inbox_;
    Audience& audience_;
    const Packer& packer_;
    std::function<double()> now_s_;

    ViewState view_;
    ViewState shown_; // state of the last picture, to which the view returns if a setting fails
    ViewCamera camera_;
    SceneClock clock_;
    std::optional<double> followed_s_, shown_s_; // time of scene and camera, and that of the last picture
    double clocked_at_s_ = 0;
    float speed_;
    uint32_t input_ = 0, steerer_ = 0; // number of the last input, and its client
    double moved_at_s_ = -1e9, reported_at_s_ = -1e9, framed_at_s_ = -1e9;
    double frames_per_second_ = 0;
    double made_share_ = 1;          // progress of the precomputation for the current picture
    double budget_s_ = 0.1;          // for the next picture at rest
    bool is_new_ = true;             // something was requested since the last picture
    bool is_done_ = false;           // nothing is left to render for this state
    std::optional<ShownFrame> last_; // without its pixels, except for their number
    std::vector<Save> saves_;
};

} // namespace pertev
