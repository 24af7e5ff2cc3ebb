#include "denoise/light_change.h"

#include "denoise/compare_light.h"
#include "device/launch.h"

namespace pertev {
namespace {

constexpr uint32_t kBlock = 4;     // pixels of the frame, along each side, for one of the small pictures
constexpr std::size_t kArrays = 5; // guide; light as it was and as it is, twice
constexpr uint32_t kPasses = 2;    // of SpreadLight: its means reach over 12 pixels of the frame to each side

uint32_t small_side(uint32_t side) { return (side + kBlock - 1) / kBlock; }

} // namespace

LightChange::LightChange(Queue& queue, uint32_t frame_width, uint32_t frame_height, bool splits_light)
    : queue_(&queue), frame_width_(frame_width), frame_height_(frame_height),
      before_(queue, small_side(frame_width), small_side(frame_height), splits_light),
      after_(queue, before_.width(), before_.height(), splits_light),
      numbers_(queue, kArrays * before_.width() * before_.height(), "change of light") {}

LightChangeView LightChange::compare() {
    const uint32_t pixels = width() * height();
    Float4* const guide = numbers_.data();
    Float4 *was = guide + pixels, *is = was + pixels, *free_was = is + pixels, *free_is = free_was + pixels;
    launch(*queue_, "compare_light", pixels, CompareLight{before_.view(), after_.view(), guide, was, is});
    for (uint32_t pass = 0; pass < kPasses; ++pass) {
        launch(*queue_, "spread_light", pixels,
               SpreadLight{guide, was, is, free_was, free_is, width(), height(), 1 << pass});
        std::swap(was, free_was);
        std::swap(is, free_is);
    }
    return {guide,
            was,
            is,
            width(),
            height(),
            static_cast<float>(width()) / static_cast<float>(frame_width_),
            static_cast<float>(height()) / static_cast<float>(frame_height_)};
}

} // namespace pertev
