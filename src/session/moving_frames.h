#pragma once

// Real-time frames (session/frame_sequence.h) with motion vectors: each frame's layer `motion` refers to the frame
// before. It has the picture's size at any resolution of light, and the values that ordinary frames have.

#include <optional>

#include "session/frame_sequence.h"

namespace pertev {

class MovingFrames : public FrameSequence {
public:
    using FrameSequence::FrameSequence;

    // The functions of FrameSequence, which also take note of what the next frame refers to.

    bool render(uint32_t number, const Camera& camera, const RenderSettings& settings,
                const ReconstructionSettings& reconstruction, const RestirSettings& restir, Sink& sink = nobody());
    void restore(FrameHistory history, const RenderSettings& settings, Sink& sink);
    /// Adds the layer `motion`, if the settings request it: 0 after a cut.
    RenderResult result(const Camera& camera, const RenderSettings& settings);

private:
    struct Before {
        Camera camera;
        bool has_moved; // whether the scene has moved since then and holds its positions of then
    };
    Image motion_of_frame(const Camera& camera, const RenderSettings& settings);

    std::optional<Camera> last_;   // camera of the last frame
    std::optional<Before> before_; // the frame before the last one
};

/// Returns motion vectors as a layer.
FilmLayer motion_layer(Image motion);

} // namespace pertev
