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
    uint32_t unused = 0;
};

/// Temporal neighbours: pixels of the previous frame.
struct FindBefore {
    SceneView scene;
    PreviousScene scene_before;
    FrameCameras cameras;
    GBufferView now, last; // last: only hits and normals
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
