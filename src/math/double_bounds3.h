#pragma once

// Axis-aligned box in double, for the coordinates of files; empty (lo > hi) by default. Host only.

#include <algorithm>
#include <cmath>

#include "math/bounds3.h"
#include "math/double_vec3.h"

namespace pertev {

struct DoubleBounds3 {
    DoubleVec3 lo = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    /// Extends the box to a point; one that is not finite is ignored.
    void extend(DoubleVec3 p) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return;
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    void extend(const DoubleBounds3& box) {
        extend(box.lo);
        extend(box.hi);
    }
    bool is_empty() const { return !(lo.x <= hi.x); }
};

} // namespace pertev
