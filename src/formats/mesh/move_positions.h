#pragma once

// Translates the positions of a file that are far from its origin, while they are still in double.

#include <span>

#include "base/parallel_for.h"
#include "scene/scene_origin.h"

namespace pertev {

/// Subtracts origin_for() the returned box from `exact`, in the coordinates of the file, and writes the result to
/// `positions`. `box` contains the vertices of the faces in float precision. `bounds_of_faces()` computes it for the
/// present `positions`. Returns that box in the coordinates of the file, as precise as positions near 0.
template <class BoundsOfFaces>
DoubleBounds3 move_positions(DoubleBounds3 box, std::span<const DoubleVec3> exact, std::span<Vec3> positions,
                             const BoundsOfFaces& bounds_of_faces) {
    const auto take_off = [&](DoubleVec3 origin) {
        parallel_for(exact.size(), 4096, [&](uint64_t i) { positions[i] = to_float(exact[i] - origin); });
    };
    for (int step = 0; step < 2; ++step) { // the first box may have rounded positions
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
