#pragma once

// The small pictures by which a change of light is found (light_change_view.h). They lie in memory that a
// reconstruction has no use for then.

#include "denoise/light_change_view.h"
#include "render/noisy_frame.h"

namespace pertev {

/// Where the small pictures lie, which have one pixel for 4x4 of the frame.
struct LightChangeRoom {
    Float4* before;  // from one frame to the next
    Float4* after;   // until they are compared
    Float4* numbers; // from then on

    /// Float4 of each for a pixel of the small pictures. `kNumbers`: guide; light as it was and as it is, twice.
    static constexpr std::size_t kPicture = NoisyFrame::arrays(true), kNumbers = 5;
    static constexpr uint32_t side(uint32_t of_frame) { return (of_frame + 3) / 4; }
    static std::size_t pixels(uint32_t frame_width, uint32_t frame_height) {
        return std::size_t(side(frame_width)) * side(frame_height);
    }
};

class LightChange {
public:
    /// Of frames of this size. `splits_light`: NoisyFrame's.
    LightChange(Queue& queue, uint32_t frame_width, uint32_t frame_height, bool splits_light,
                const LightChangeRoom& room);

    /// Whether they are of frames like that.
    bool fits(const NoisyFrame& frame) const {
        return frame_width_ == frame.width() && frame_height_ == frame.height() &&
               before_.splits_light() == frame.splits_light();
    }

    // Take the scene as it was and as it is, seen by one camera and sampled by the same numbers.
    NoisyFrame& before() { return before_; }
    NoisyFrame& after() { return after_; }
    /// Of both pictures.
    LightChangeView compare();

private:
    Queue* queue_;
    uint32_t frame_width_, frame_height_;
    NoisyFrame before_, after_;
    Float4* numbers_;
};

} // namespace pertev
