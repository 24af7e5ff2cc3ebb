#pragma once

// Axis-aligned box; empty (lo > hi) by default.

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

struct Bounds3 {
    Vec3 lo = {kInfinity, kInfinity, kInfinity};
    Vec3 hi = {-kInfinity, -kInfinity, -kInfinity};
    bool operator==(const Bounds3&) const = default;

    HD void extend(Vec3 p) {
        lo = min(lo, p);
        hi = max(hi, p);
    }
    HD void extend(const Bounds3& b) {
        lo = min(lo, b.lo);
        hi = max(hi, b.hi);
    }
    HD bool is_empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
    HD Vec3 centre() const { return 0.5f * (lo + hi); }
    HD Vec3 size() const { return hi - lo; }
    /// Half the surface area; 0 when empty.
    HD float half_area() const {
        if (is_empty()) return 0;
        const Vec3 d = size();
        return d.x * d.y + d.y * d.z + d.z * d.x;
    }
    /// Largest |coordinate| of the box.
    HD float max_abs() const { return max(max_component(abs(lo)), max_component(abs(hi))); }
};

} // namespace pertev
