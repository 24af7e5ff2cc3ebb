#pragma once

// A session whose pictures, real-time frames, or both are rendered by one device, or by several together.

#include <memory>
#include <optional>
#include <span>

#include "session/devices/frames_on_devices.h"
#include "session/devices/render_on_devices.h"
#include "session/session.h"

namespace pertev {

/// The results that several devices render together; the first device renders the others alone.
struct SharedWork {
    bool pictures = false, frames = false;
    AfterLoss after_loss = AfterLoss::Throw; // for frames
};

class SessionOnDevices {
public:
    /// Makes the session on the first queue. Queues and scene outlive this. Throws Error as Session does.
    SessionOnDevices(std::span<const std::shared_ptr<Queue>> queues, const PreparedScene& scene, const Camera& camera,
                     const RenderSettings& settings, const SharedWork& shared);

    Session& session() { return session_; }
    /// Returns what renders pictures by several devices, or null.
    RenderOnDevices* together() { return together_ ? &*together_ : nullptr; }
    /// Lets further films be rendered by the first device alone, or again by all that share pictures.
    void share_pictures(bool by_all);
    /// Passes on changed parts of the scene.
    void update_scene(const PreparedScene& scene, uint32_t parts);

private:
    std::optional<RenderOnDevices> together_;
    std::optional<FramesOnDevices> frames_together_;
    Session session_;
};

} // namespace pertev
