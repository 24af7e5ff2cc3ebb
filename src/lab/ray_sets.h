#pragma once

// Ray sets on which tracers are compared: camera rays, shadow rays and up to eight diffuse bounces, in the order in
// which a wavefront renderer would trace them. docs/ray_sets.md defines the record's sets so that any tracer can
// reproduce them. Each ray is a function of the scene, the camera and its number; its bits are equal on every machine
// and device and for any number of threads.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lab/trace_rays.h"
#include "math/bounds3.h"
#include "math/random.h"
#include "scene/scene.h"

namespace pertev {

struct RaySet {
    std::string name;
    bool any_hit = false; // any-hit rays: only whether there is a hit counts
    std::vector<Ray> rays;
};

/// The scene and camera that rays are made for. `trace` returns closest hits among all triangles, none transparent.
struct RaySetJob {
    const Scene& scene;
    Camera camera;
    uint32_t width, height; // size of a frame
    RayTracer trace;
};

struct FrameSize {
    uint32_t width = 0, height = 0;
};
/// Returns the largest 16:9 frame of whole tiles that fits into `count` rays four times: 1920 x 1080 for 8,294,400
/// rays. It has at least 64 x 36 pixels, of which a smaller count uses a part.
FrameSize record_frame(uint32_t count);

/// Makes the record's five sets: "primary", "shadow", "diffuse1", "diffuse2" and "diffuse3". Primary rays are whole
/// frames with one sample per pixel until there are `count` rays. Other sets start at the hits of the set before, in
/// order. If these are fewer than `count`, the hits of a second such set with other random numbers follow; if both
/// together are fewer, the set is smaller.
std::vector<RaySet> make_record_ray_sets(const RaySetJob& job, uint32_t count);

/// Makes two sets. "along_axes" has the rays of `from`, turned to each one's nearest axis. "beside_axes" has the same
/// rays tilted by a thousandth to both sides, so that they hit nearly the same surfaces. A traversal takes equal time
/// for both unless zero components of the direction slow it down.
std::vector<RaySet> make_axis_ray_sets(const RaySet& from);

inline constexpr int kMaxFrameDepth = 8;

/// Makes the sets of one frame: "primary" with one ray per pixel, "shadow" and "diffuse1" from its hits, and so on to
/// "diffuse<depth>", each from the hits of the set before. Rays that leave the scene end, so sets shrink. `depth` is in
/// [0, kMaxFrameDepth].
std::vector<RaySet> make_frame_ray_sets(const RaySetJob& job, int depth);

// Building blocks of the sets.

/// Replaces the state by its hash and returns the hash's upper 24 bits as a number in [0, 1). Zero occurs once in
/// 2^24 draws.
inline float draw(uint32_t& state) {
    state = hash_word(state);
    return static_cast<float>(state >> 8) * 0x1p-24f;
}

inline uint32_t primary_state(uint32_t pixel, uint32_t sample) {
    return hash_word(9781u * pixel + 6271u * sample + 1u);
}
inline uint32_t secondary_state(uint32_t ray, uint32_t seed) { return hash_word(2654435761u * ray + seed); }

inline constexpr uint32_t kShadowTargets = 64;

/// Returns the targets of the shadow rays: fixed points in the middle 80 % of the box in x and z, and from 15 to 85 %
/// of its height.
std::array<Vec3, kShadowTargets> shadow_targets(const Bounds3& box);

} // namespace pertev
