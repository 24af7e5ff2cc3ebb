#pragma once

// Makes real-time frames by several devices together. Each has the scene and makes a band of rows: their samples and
// their reconstruction. It takes the rows beside them that filters read from the devices that made them, and before
// the next frame, while samples are taken, all rows of the history. The frame has the bytes of one device's.
//
// A device that fails in the middle of a frame takes the history of its rows along. That frame is an error, and the
// next one, made by the others, begins a new sequence. Without a history, and where that may be cut, the others make
// the frame again.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "session/devices/device_thread.h"
#include "session/devices/row_team.h"
#include "session/devices/scene_copy.h"
#include "session/frame_sequence.h"

namespace pertev {

/// Hooks for tests. The device's thread calls them; a test throws in them what a failing device would.
struct FrameHooks {
    std::function<void(std::size_t device)> before_frame;
};

/// The choice of what happens when a device fails in a frame that has a history.
enum class AfterLoss {
    Throw, // the frame is an error
    Cut,   // the frame begins a new sequence
};

class FramesOnDevices final : public SharedFrames {
public:
    /// Takes the devices, of which the first is that of the caller's PictureRenderer; the others copy its scene at the
    /// first frame. The queues and the scene outlive this, and the scene must not change without change_scene().
    FramesOnDevices(std::span<const std::shared_ptr<Queue>> queues, const PreparedScene& scene,
                    AfterLoss after_loss = AfterLoss::Throw, FrameHooks hooks = {});
    ~FramesOnDevices() override;

    void change_scene(const PreparedScene& scene, uint32_t parts) override;
    void take_scene(FrameSequence& leader, const RenderSettings& settings, Sink& sink) override;
    bool render(FrameSequence& leader, const FrameTask& task, Sink& sink) override;
    void collect(FrameSequence& leader, std::vector<RowArray> (FrameSequence::*arrays)() const) override;
    FrameCounts counts_of_others() override;

    /// Number of devices that have not failed.
    std::size_t devices() const { return followers_.size() + 1; }

private:
    struct Follower;
    struct Part;

    void form_team();
    bool render_together(FrameSequence& leader, const FrameTask& task, Sink& sink, std::vector<Part>& parts);
    void leave_out_failed(const std::vector<Part>& parts, Sink& sink);

    Queue& queue_; // the leader's
    AfterLoss after_loss_;
    FrameHooks hooks_;
    std::vector<std::unique_ptr<Follower>> followers_; // without those that were lost
    std::unique_ptr<RowTeam> team_;                    // null until the first frame, and after a loss
};

} // namespace pertev
