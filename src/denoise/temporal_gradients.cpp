#include "denoise/temporal_gradients.h"

#include <cstring>

#include "denoise/aim_at_moved.h"
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

void TemporalGradients::follow(const SceneView& scene, const PreviousScene& scene_before) {
    launch(*queue_, "aim_at_moved", before_.width() * before_.height(),
           AimAtMoved{before_.view().hit, scene.instances, scene.meshes, scene_before, numbers_});
    after_.aim(numbers_);
}

bool TemporalGradients::are_of_scene(std::span<const std::vector<std::byte>> rows,
                                     std::span<const uint32_t> triangle_counts) {
    constexpr std::size_t kHits = 2; // in NoisyFrame::rows()
    const std::vector<std::byte>& hits = rows[kHits];
    for (std::size_t at = 0; at + sizeof(Float4) <= hits.size(); at += sizeof(Float4)) {
        Float4 hit;
        std::memcpy(&hit, hits.data() + at, sizeof hit);
        const uint32_t instance = bits_of(hit.x);
        if (instance == kNoHit) continue;
        if (instance >= triangle_counts.size() || bits_of(hit.y) >= triangle_counts[instance]) return false;
    }
    return true;
}

TemporalGradientsView TemporalGradients::compare() {
    after_.aim(nullptr); // the numbers take their place
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
