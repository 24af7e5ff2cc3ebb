#include "denoise/temporal_gradients.h"

#include "denoise/compare_light.h"
#include "device/launch.h"

namespace pertev {
namespace {

constexpr uint32_t kPasses = 2; // passes of SpreadLight, whose means reach 12 pixels of the frame in each direction

} // namespace

TemporalGradients::TemporalGradients(Queue& queue, uint32_t frame_width, uint32_t frame_height, bool splits_light,
                                     const TemporalGradientsMemory& memory)
    : queue_(&queue), frame_width_(frame_width), frame_height_(frame_height),
      before_(queue, memory.side(frame_width), memory.side(frame_height), splits_light, memory.before),
      after_(queue, before_.width(), before_.height(), splits_light, memory.after), numbers_(memory.numbers) {}

TemporalGradientsView TemporalGradients::compare() {
    const uint32_t width = before_.width(), height = before_.height(), pixels = width * height;
    Float4* const guide = numbers_;
    Float4 *was = guide + pixels, *is = was + pixels, *free_was = is + pixels, *free_is = free_was + pixels;
    launch(*queue_, "compare_light", pixels, CompareLight{before_.view(), after_.view(), guide, was, is});
    for (uint32_t pass = 0; pass < kPasses; ++pass) {
        launch(*queue_, "spread_light", pixels,
               SpreadLight{guide, was, is, free_was, free_is, width, height, 1 << pass});
        std::swap(was, free_was);
        std::swap(is, free_is);
    }
    auto* const share = reinterpret_cast<float*>(free_was);
    launch(*queue_, "find_changed_share", pixels, FindChangedShare{guide, share, width, height});
    return {guide,
            was,
            is,
            share,
            width,
            height,
            static_cast<float>(width) / static_cast<float>(frame_width_),
            static_cast<float>(height) / static_cast<float>(frame_height_)};
}

} // namespace pertev
