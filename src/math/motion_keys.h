#pragma once

// Rigid motions as the host makes them: keys fitted to places that are known at any time (math/rigid_motion.h).

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "math/bounds3.h"
#include "math/rigid_motion.h"
#include "math/transform.h"

namespace pertev {

inline constexpr uint32_t kFewestMotionSegments = 8, kMostMotionSegments = 64;

/// Something whose motion is asked for: a box in its own space, and where it has been put.
struct PlacedBox {
    Transform world_from_local; // invertible
    Bounds3 box;                // its own space; not empty
};

/// The motion of one thing; without keys it stands still.
struct Motion {
    std::vector<MotionKey> keys;
    Vec3 pivot;
};

struct FittedMotions {
    uint32_t segments = 0; // of each motion: it has one key more
    std::vector<Motion> motions;
};

/// Where each thing is at a time in [0, 1], as PlacedBox::world_from_local; none: it is as at the key before.
using PlacesAt = std::function<std::vector<std::optional<Transform>>(double time)>;

/// The rigid motions that take each thing from where it has been put to where it is. What is no rigid motion of it (its
/// scale, its shear) stays as it has been put: the nearest rotation is taken. Segments are as many, a power of two, as
/// keep all corners within 2^-11 of the box's size of where they are, at several times between the keys and at the
/// times `looks`, but at most kMostMotionSegments.
FittedMotions fit_motions(std::span<const PlacedBox> things, const PlacesAt& places_at,
                          std::span<const double> looks = {});

/// The motions of a scene's instances.
struct MotionKeys {
    uint32_t segments = 0;
    std::vector<MotionKey> keys;       // [motions * (segments + 1)]
    std::vector<Vec3> pivots;          // [motions]
    std::vector<uint32_t> of_instance; // [instances] number of its motion, or kNoMotion

    MotionsView view() const { return {keys.data(), pivots.data(), of_instance.data(), segments}; }
};

/// Box of all places that what is in `box_in_world`, where it has been put, takes with motion number `motion`, rounded
/// outwards.
Bounds3 swept_bounds(const MotionKeys& motions, uint32_t motion, const Bounds3& box_in_world);

} // namespace pertev
