#pragma once

// Selects the pixels that a pixel reuses: its position in the previous frame, or nearby ones that see a similar
// surface. The choice depends only on surfaces, never on light, so it introduces no bias.

#include "math/sampling.h"
#include "render/reproject.h"
#include "restir/light_reservoir.h"

namespace pertev {

inline constexpr uint32_t kNoPixel = 0xffffffffu;
inline constexpr uint32_t kMaxNeighbours = 3;

/// Up to kMaxNeighbours pixels, followed by kNoPixel.
struct alignas(16) Neighbours {
    uint32_t pixels[kMaxNeighbours] = {kNoPixel, kNoPixel, kNoPixel};
    float max_count = kInfinity; // maximum count of their reservoirs
};

/// The largest changed share of light, in [0, 1], around each pixel of a small picture of the previous frame's view.
struct ChangedLight {
    const float* share = nullptr; // null: no light has changed
    uint32_t width = 0, height = 0;
    float columns = 0, rows = 0; // columns and rows of the small picture per one of the frame

    /// Returns the share around a pixel of the frame that lies inside it.
    HD float at(Vec2 pixel) const {
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = to_int(pixel.x * columns, 0, w - 1), y = to_int(pixel.y * rows, 0, h - 1);
        return share[y * w + x];
    }
};

/// Temporal neighbours: pixels of the previous frame. Visibility of this frame's samples from them is tested in the
/// scene as it is now. Where light has changed, this was not the visibility when their reservoirs were filled, and one
/// that found no light would count as one that could have found the new light. So the more has changed, the less they
/// count. The change is measured with random numbers of its own (denoise/temporal_gradients.h), and balance weights
/// may have any counts that do not depend on the samples, so this introduces no bias.
struct FindBefore {
    SceneView scene;
    PreviousScene scene_before;
    FrameCameras cameras;
    GBufferView now, last; // last: only hits and normals
    ChangedLight change;
    float max_count; // where no light has changed
    Neighbours* to;

    HD void operator()(uint32_t pixel) const {
        Neighbours found;
        const uint32_t object = bits_of(now.hit[pixel].x), width = cameras.width, height = cameras.height;
        if (object != kNoHit) {
            const Vec2 centre = {static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f};
            const Reprojection at =
                reproject_surface(with_straight_lenses(cameras), scene, scene_before, centre, now.hit[pixel]);
            const Vec2 p = at.pixel;
            if (p.x >= 0 && p.y >= 0 && p.x < static_cast<float>(width) && p.y < static_cast<float>(height)) {
                const uint32_t there = static_cast<uint32_t>(to_int(p.y, 0, static_cast<int>(height) - 1)) * width +
                                       static_cast<uint32_t>(to_int(p.x, 0, static_cast<int>(width) - 1));
                if (bits_of(last.hit[there].x) == object && at.depth > 0 &&
                    is_similar_surface(last.normal[there], at.depth, vec3_of(now.normal[pixel]))) {
                    found.pixels[0] = there;
                    found.max_count = max_count;
                    if (change.share != nullptr) {
                        constexpr float kLeft =
                            3; // equal to that of frames_in_change (denoise/temporal_gradients_view.h)
                        const float changed = change.at(p);
                        found.max_count *= square(1.0f - changed) / fma(kLeft * changed, max_count, 1.0f);
                    }
                }
            }
        }
        to[pixel] = found;
    }
};

/// Spatial neighbours: pixels of the same frame.
struct FindNeighbours {
    /// Returns how many rows away the neighbours may be.
    static uint32_t reach(float radius) { return static_cast<uint32_t>(radius) + 2; }

    PixelSurfaces here;
    uint32_t neighbours;
    float radius;
    Neighbours* to;

    HD void operator()(uint32_t pixel) const {
        Neighbours found;
        if (here.is_there(pixel)) {
            const int width = static_cast<int>(here.camera.width), height = static_cast<int>(here.camera.height);
            const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
            const Float4* const normal = here.g_buffer.normal;
            const Float4 own = normal[pixel];
            uint32_t count = 0;
            for (uint32_t k = 0; k < neighbours && k < kMaxNeighbours; ++k) {
                const Vec2 u = sample_2d(here.sampler, here.key(pixel), kGroupNeighbours + k);
                const Vec2 offset = radius * sample_uniform_disk_concentric(u);
                const int to_x = x + to_int(floor(offset.x + 0.5f), -width, width),
                          to_y = y + to_int(floor(offset.y + 0.5f), -height, height);
                if ((to_x == x && to_y == y) || to_x < 0 || to_y < 0 || to_x >= width || to_y >= height) continue;
                const uint32_t there = static_cast<uint32_t>(to_y * width + to_x);
                if (!here.is_there(there) || !is_similar_surface(normal[there], own.w, vec3_of(own))) continue;
                found.pixels[count++] = there;
            }
        }
        to[pixel] = found;
    }
};

} // namespace pertev
