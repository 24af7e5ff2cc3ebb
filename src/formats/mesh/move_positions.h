#pragma once

// Moves the positions of a file that lie away from its origin there, while they are still in double.

#include <span>

#include "base/parallel_for.h"
#include "scene/scene_origin.h"

namespace pertev {

/// Writes `exact`, in the coordinates of the file, less origin_for() what is returned to `positions`. `box`: of what
/// the faces name, as floats have it. `bounds_of_faces()`: the same of `positions` as they are then. Returns that box
/// in the coordinates of the file, as positions near 0 have it.
template <class BoundsOfFaces>
DoubleBounds3 move_positions(DoubleBounds3 box, std::span<const DoubleVec3> exact, std::span<Vec3> positions,
                             const BoundsOfFaces& bounds_of_faces) {
    const auto take_off = [&](DoubleVec3 origin) {
        parallel_for(exact.size(), 4096, [&](uint64_t i) { positions[i] = to_float(exact[i] - origin); });
    };
    for (int step = 0; step < 2; ++step) { // the first box may be one of rounded places
        const DoubleVec3 origin = origin_for(box);
        take_off(origin);
        const Bounds3 near = bounds_of_faces();
        DoubleBounds3 now;
        now.extend(origin + to_double(near.lo));
        now.extend(origin + to_double(near.hi));
        box = now;
        if (origin_for(box) == origin) return box;
    }
    take_off(origin_for(box));
    return box;
}

} // namespace pertev
