#pragma once

// Fits rigid motions on the host: keys for positions that are known at any time (math/rigid_motion.h).

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "math/bounds3.h"
#include "math/rigid_motion.h"
#include "math/transform.h"

namespace pertev {

inline constexpr uint32_t kFewestMotionSegments = 8, kMaxMotionSegments = 64;

/// An object whose motion is fitted: a box in its own space, and its transform at rest.
struct PlacedBox {
    Transform world_from_local; // invertible
    Bounds3 box;                // in its own space; not empty
};

/// The motion of one object; without keys it does not move.
struct Motion {
    std::vector<MotionKey> keys;
    Vec3 pivot;
};

struct FittedMotions {
    uint32_t segments = 0; // segments of each motion, which has one key more
    std::vector<Motion> motions;
};

/// Returns, per object, PlacedBox::world_from_local at a time in [0, 1]; nothing if it is that of the previous key.
using TransformsAt = std::function<std::vector<std::optional<Transform>>(double time)>;

/// Fits the rigid motions that move each object from its position at rest to its position at a time. Non-rigid
/// changes (scale, shear) are ignored: the nearest rotation is used. The number of segments is the least power of two
/// that keeps all corners within 2^-11 of the box's size, at several times between the keys and at the times
/// `check_times`, but at most kMaxMotionSegments.
FittedMotions fit_motions(std::span<const PlacedBox> things, const TransformsAt& transforms_at,
                          std::span<const double> check_times = {});

/// The motions of a scene's instances.
struct MotionKeys {
    uint32_t segments = 0;
    std::vector<MotionKey> keys;       // [motions * (segments + 1)]
    std::vector<Vec3> pivots;          // [motions]
    std::vector<uint32_t> of_instance; // [instances] index of its motion, or kNoMotion

    MotionsView view() const { return {keys.data(), pivots.data(), of_instance.data(), segments}; }
};

/// Box of all positions of `box_in_world`, given at rest, during motion number `motion`, rounded outwards.
Bounds3 swept_bounds(const MotionKeys& motions, uint32_t motion, const Bounds3& box_in_world);

} // namespace pertev
