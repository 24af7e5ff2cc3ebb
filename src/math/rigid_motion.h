#pragma once

// Rigid motion while a shutter is open: the position of a rotating and translating object at a time, relative to its
// position at rest. Time goes from 0 (the shutter opens) to 1 (it closes). Between keys the pivot moves linearly; the
// rotation is the normalised mean of both quaternions (nlerp), about one axis.
//
// The motion at a time, forwards and back, is one portable function with the same bits on both devices. Lengths,
// angles and ray parameters do not change, up to rounding.

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec3.h"
#include "math/vec4.h"

namespace pertev {

inline constexpr uint32_t kNoMotion = 0xffffffffu;
inline constexpr float kAtRest = -1; // stands for a time: everything is at its position at rest

struct MotionKey {
    Vec4 turn;     // unit quaternion (x, y, z, w), at less than a quarter turn in four dimensions from adjacent keys
    Vec3 position; // position of the pivot, metres
    float unused = 0;
    bool operator==(const MotionKey&) const = default;
};
static_assert(sizeof(MotionKey) == 32);

/// A motion at one time: p maps to rotate(p - pivot) + position.
struct RigidMotion {
    Vec3 row0 = {1, 0, 0}, row1 = {0, 1, 0}, row2 = {0, 0, 1}; // rows of the rotation
    Vec3 pivot = {0, 0, 0}, position = {0, 0, 0};

    HD Vec3 rotate(Vec3 v) const { return {dot(row0, v), dot(row1, v), dot(row2, v)}; }
    HD Vec3 rotate_back(Vec3 v) const { return v.x * row0 + v.y * row1 + v.z * row2; }
    HD Vec3 rotate_extents(Vec3 v) const { return {dot(abs(row0), v), dot(abs(row1), v), dot(abs(row2), v)}; }
    HD Vec3 move(Vec3 p) const { return rotate(p - pivot) + position; }
    HD Vec3 move_back(Vec3 p) const { return rotate_back(p - position) + pivot; }

    /// Bound of the rounding error of move() for `p` followed by move_back(), for all components, metres: for each of
    /// the two, rows are off by 6 units of 2^-24, a rotation adds 3 and the sums 2, of at most the sum of all
    /// lengths.
    HD float error(Vec3 p) const {
        const auto size = [](Vec3 v) { return abs(v.x) + abs(v.y) + abs(v.z); };
        return 0x1p-19f * (size(p) + size(pivot) + size(position));
    }
};

/// Makes a motion with the rotation `q`, a quaternion with any length but 0.
HD inline RigidMotion rigid_motion(Vec4 q, Vec3 pivot, Vec3 position) {
    // Two divided by the squared length gives the rows of the unit quaternion.
    const float s = 2.0f / (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    const float xx = s * q.x * q.x, yy = s * q.y * q.y, zz = s * q.z * q.z;
    const float xy = s * q.x * q.y, xz = s * q.x * q.z, yz = s * q.y * q.z;
    const float xw = s * q.x * q.w, yw = s * q.y * q.w, zw = s * q.z * q.w;
    return {{1.0f - (yy + zz), xy - zw, xz + yw},
            {xy + zw, 1.0f - (xx + zz), yz - xw},
            {xz - yw, yz + xw, 1.0f - (xx + yy)},
            pivot,
            position};
}

/// Motion of one object. `keys`, at least two, are at the times 0, 1 / segments, ..., 1.
HD inline RigidMotion motion_at(const MotionKey* keys, uint32_t segments, Vec3 pivot, float time) {
    const float at = time * static_cast<float>(segments);
    const uint32_t first = static_cast<uint32_t>(to_int(at, 0, static_cast<int>(segments) - 1));
    const float f = at - static_cast<float>(first);
    const MotionKey &a = keys[first], &b = keys[first + 1];
    return rigid_motion((1.0f - f) * a.turn + f * b.turn, pivot, (1.0f - f) * a.position + f * b.position);
}

/// The motion of one object; without keys it does not move.
struct MotionTrack {
    const MotionKey* keys = nullptr;
    Vec3 pivot = {0, 0, 0};
    uint32_t segments = 0;

    HD bool moves() const { return keys != nullptr; }
    HD RigidMotion at(float time) const {
        return moves() && time >= 0 ? motion_at(keys, segments, pivot, time) : RigidMotion{};
    }
};

/// Motions of a scene's instances, as plain pointers of host or device; null if nothing moves.
struct MotionsView {
    const MotionKey* keys = nullptr;       // [motions * (segments + 1)]
    const Vec3* pivots = nullptr;          // [motions]
    const uint32_t* of_instance = nullptr; // [instances] index of its motion, or kNoMotion
    uint32_t segments = 0;

    HD bool is_there() const { return keys != nullptr; }
    HD uint32_t of(uint32_t instance) const { return is_there() ? of_instance[instance] : kNoMotion; }
    /// Returns motion number `motion` at `time`, which is in [0, 1], or kAtRest.
    HD RigidMotion at(uint32_t motion, float time) const {
        return MotionTrack{keys + std::size_t(motion) * (segments + 1), pivots[motion], segments}.at(time);
    }
    HD RigidMotion of_instance_at(uint32_t instance, float time) const {
        const uint32_t motion = of(instance);
        return motion == kNoMotion ? RigidMotion{} : at(motion, time);
    }
};

} // namespace pertev
