#pragma once

// Text of scene positions for notices: in the coordinates of the scene's file, with as many digits as distinguish
// positions in the scene.

#include <string>

#include "scene/scene.h"

namespace pertev {

/// Returns a position as "X,Y,Z", in the syntax of settings. `digits` applies to a scene at the file's origin; a scene
/// elsewhere has as many decimals as its own size would have.
std::string position_text(const Scene& scene, Vec3 p, int digits);

/// The position that position_text() states, in the coordinates of the file.
DoubleVec3 stated_position(const Scene& scene, Vec3 p, int digits);

/// Returns the numbers that state `p` of a scene with this origin in its file, to the bit: those of a float's shortest
/// text if the origin is 0.
DoubleVec3 stated_position(Vec3 p, DoubleVec3 origin);

} // namespace pertev
