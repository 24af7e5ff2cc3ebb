#pragma once

// The render's thread: takes what clients ask for, lets time pass, steps the camera, asks the frame source for pictures
// and publishes them. It renders only while somebody looks and there is something left to do.

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
    /// All outlive it.
    RenderLoop(const ViewerStart& start, FrameSource& source, Inbox& inbox, Audience& audience, const Packer& packer,
               std::function<double()> now_s);

    /// Until `goes_on` says no. Throws Error(DeviceFault).
    void run(const std::function<bool()>& goes_on);

private:
    void handle(const Command& command);
    void steer(const Steer& steer);
    void steer_time(const ClientMessage& message);
    void steer_path(const Steer& steer);
    void pick(const Steer& steer);
    void tell_error(uint32_t client, const Error& error);
    void set(const Steer& steer);
    void let_time_pass();
    void follow_time();
    std::optional<ShownFrame> next_frame(const FrameRequest& request);
    void show_next();
    void save_pictures();
    PictureRecord record() const;
    void tell_state();
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
    ViewState shown_; // of the last picture: what to go back to where a setting cannot be had
    ViewCamera camera_;
    SceneClock clock_;
    std::optional<double> followed_s_, shown_s_; // time that scene and camera are at, and that of the last picture
    double clocked_at_s_ = 0;
    float speed_;
    uint32_t input_ = 0, steerer_ = 0; // number of the last input, and the client that it came from
    double moved_at_s_ = -1e9, told_at_s_ = -1e9, framed_at_s_ = -1e9;
    double frames_per_second_ = 0;
    double made_share_ = 1;          // of what the picture under way needs before its samples
    double budget_s_ = 0.1;          // of the next picture at rest
    bool is_new_ = true;             // something was asked for since the last picture
    bool is_done_ = false;           // nothing is left to be rendered for this state
    std::optional<ShownFrame> last_; // without its pixels, but for their number
    std::vector<Save> saves_;
};

} // namespace pertev
