#pragma once

// Owns the small pictures by which a change of light is found (light_change_view.h).

#include "denoise/light_change_view.h"
#include "render/noisy_frame.h"

namespace pertev {

class LightChange {
public:
    /// Of frames of this size. `splits_light`: NoisyFrame's.
    LightChange(Queue& queue, uint32_t frame_width, uint32_t frame_height, bool splits_light);

    /// Of the small pictures: a fourth of the frame's sides.
    uint32_t width() const { return before_.width(); }
    uint32_t height() const { return before_.height(); }
    /// Whether they are of frames like that.
    bool fits(const NoisyFrame& frame) const {
        return frame_width_ == frame.width() && frame_height_ == frame.height() &&
               before_.splits_light() == frame.splits_light();
    }

    /// Take the scene as it was and as it is, seen by one camera and sampled by the same numbers.
    NoisyFrame& before() { return before_; }
    NoisyFrame& after() { return after_; }
    /// Of both pictures. Holds until it is called again.
    LightChangeView compare();

private:
    Queue* queue_;
    uint32_t frame_width_, frame_height_;
    NoisyFrame before_, after_;
    Buffer<Float4> numbers_;
};

} // namespace pertev
