#pragma once

// The small pictures from which temporal gradients of light are computed (temporal_gradients_view.h). They use memory
// that a reconstruction does not need at that time.

#include <cstddef>
#include <span>
#include <vector>

#include "denoise/temporal_gradients_view.h"
#include "render/noisy_frame.h"

namespace pertev {

/// Memory of the small pictures, which have one pixel per 4x4 (kSide) of the frame.
struct TemporalGradientsMemory {
    Float4* before;  // used from one frame to the next
    Float4* after;   // used until they are compared
    Float4* numbers; // aims while `after` is made; used afterwards

    static constexpr uint32_t kSide = 4; // pixels of the frame per one of a small picture, on each side
    /// Float4s per pixel of a small picture; `numbers` holds aims, then the guide, and twice the light before and
    /// after.
    static constexpr std::size_t kPicture = NoisyFrame::arrays(true), kNumbers = 5;
    static constexpr uint32_t side(uint32_t of_frame) { return (of_frame + kSide - 1) / kSide; }
    static std::size_t pixels(uint32_t frame_width, uint32_t frame_height) {
        return std::size_t(side(frame_width)) * side(frame_height);
    }
};

class TemporalGradients {
public:
    /// Makes the pictures for frames of this size. `splits_light` is that of NoisyFrame.
    TemporalGradients(Queue& queue, uint32_t frame_width, uint32_t frame_height, bool splits_light,
                      const TemporalGradientsMemory& memory);

    /// Returns whether the pictures fit frames like this one.
    bool fits(const NoisyFrame& frame) const {
        return frame_width_ == frame.width() && frame_height_ == frame.height() &&
               before_.splits_light() == frame.splits_light();
    }

    // The scene as it was and as it is, with the same camera and random numbers.
    NoisyFrame& before() { return before_; }
    NoisyFrame& after() { return after_; }
    /// Aims the camera rays of after() at what before() shows, until both are compared (aim_at_moved.h).
    void follow(const SceneView& scene, const PreviousScene& scene_before);
    /// Returns whether restored `rows` of before() refer only to triangles that exist. `triangle_counts` are those of
    /// the scene's instances.
    static bool are_of_scene(std::span<const std::vector<std::byte>> rows, std::span<const uint32_t> triangle_counts);
    /// Compares both pictures and returns the gradients.
    TemporalGradientsView compare();

private:
    Queue* queue_;
    uint32_t frame_width_, frame_height_;
    NoisyFrame before_, after_;
    Float4* numbers_;
};

} // namespace pertev
