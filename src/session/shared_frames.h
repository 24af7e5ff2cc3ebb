#pragma once

// The seam to what makes real-time frames by several devices together (session/devices/). A sequence asks for it
// through PictureRenderer::sharing_frames().

#include <cstdint>
#include <vector>

#include "base/sink.h"
#include "denoise/reconstruction_settings.h"
#include "render/row_exchange.h"
#include "restir/restir_settings.h"
#include "scene/camera.h"
#include "session/picture_renderer.h"

namespace pertev {

class FrameSequence;

/// A frame to be made.
struct FrameTask {
    uint32_t number; // number of its sample
    const Camera& camera;
    const RenderSettings& settings;
    ReconstructionSettings reconstruction;
    RestirSettings restir;
};

/// Rays and invalid samples of a frame.
struct FrameCounts {
    RayCounts rays;
    uint64_t invalid_samples = 0;
};

class SharedFrames {
public:
    virtual ~SharedFrames() = default;

    /// Replaces `parts` (ScenePart) of the scene at the next frame; the scene must not change until then.
    virtual void change_scene(const PreparedScene& scene, uint32_t parts) = 0;
    /// Gives the other devices the scene as it is now, because the next frame of `leader` has a history though they
    /// have made none. One that fails is left out, with a warning.
    virtual void take_scene(FrameSequence& leader, const RenderSettings& settings, Sink& sink) = 0;
    /// Makes the next frame of `leader`, the caller's sequence, which gets the picture. Returns as
    /// FrameSequence::render. Throws Error(DeviceFault) if a device fails in the middle: the next frame is made by the
    /// others, after a cut.
    virtual bool render(FrameSequence& leader, const FrameTask& task, Sink& sink) = 0;
    /// Takes rows of the last frame that the others have made for the leader.
    virtual void collect(FrameSequence& leader, std::vector<RowArray> (FrameSequence::*arrays)() const) = 0;
    /// Counts of the last frame on devices other than the leader's.
    virtual FrameCounts counts_of_others() = 0;
};

} // namespace pertev
