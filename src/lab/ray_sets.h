#pragma once

// Sets of rays that tracers are compared on: camera rays, shadow rays and up to eight diffuse bounces, in the order in
// which a wavefront would trace them. docs/ray_sets.md defines the record's sets so that any tracer can make them; each
// ray is a function of the scene, the camera and its number, the same bits on every machine and device and for any
// number of threads.

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
    bool any_hit = false; // whether there is a hit is asked, not which
    std::vector<Ray> rays;
};

/// Where the rays go. `trace` gives their closest hits: of all triangles of the scene, none transparent.
struct RaySetJob {
    const Scene& scene;
    Camera camera;
    uint32_t width, height; // of a frame
    RayTracer trace;
};

struct FrameSize {
    uint32_t width = 0, height = 0;
};
/// The largest frame of 16 x 9, of whole tiles, that is in `count` rays four times: 1920 x 1080 in 8,294,400. At least
/// 64 x 36, of which fewer rays are a part.
FrameSize record_frame(uint32_t count);

/// The five sets of the record, "primary", "shadow", "diffuse1", "diffuse2", "diffuse3". Primary: whole frames, one
/// sample a pixel each, until there are `count` rays. The others start at the hits of those before them, in order;
/// where these are fewer than `count`, at the hits of a second such set with other random numbers; where both together
/// are fewer, the set is that much smaller.
std::vector<RaySet> make_record_ray_sets(const RaySetJob& job, uint32_t count);

/// "along_axes": the rays of `from`, turned to the axis that each is nearest to. "beside_axes": the same a thousandth
/// of their way off to both sides, so that they meet nearly the same. A walk takes as long for both unless it stumbles
/// over directions with components of 0.
std::vector<RaySet> make_axis_ray_sets(const RaySet& from);

inline constexpr int kMaxFrameDepth = 8;

/// One frame: "primary" with one ray a pixel, "shadow" from its hits, "diffuse1" from them too, and so on to
/// "diffuse<depth>", each from the hits of the one before. A ray that leaves the scene ends there, so sets get smaller.
/// `depth` in [0, kMaxFrameDepth].
std::vector<RaySet> make_frame_ray_sets(const RaySetJob& job, int depth);

// What the sets are made of.

/// Replaces the state by its hash; the hash's upper 24 bits as a number in [0, 1). Zero is possible, once in 2^24.
inline float draw(uint32_t& state) {
    state = hash_word(state);
    return static_cast<float>(state >> 8) * 0x1p-24f;
}

inline uint32_t primary_state(uint32_t pixel, uint32_t sample) {
    return hash_word(9781u * pixel + 6271u * sample + 1u);
}
inline uint32_t secondary_state(uint32_t ray, uint32_t seed) { return hash_word(2654435761u * ray + seed); }

inline constexpr uint32_t kShadowTargets = 64;

/// Where shadow rays go: fixed points in the middle 80 % of the box in x and z and from 15 to 85 % of its height.
std::array<Vec3, kShadowTargets> shadow_targets(const Bounds3& box);

} // namespace pertev
