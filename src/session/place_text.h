#pragma once

// Places of a scene as notices write them: in the coordinates of its file, with as many digits as tell places of the
// scene apart.

#include <string>

#include "scene/scene.h"

namespace pertev {

/// "X,Y,Z" as settings take it. `digits`: of the numbers of a scene that lies at the file's origin; one that lies
/// elsewhere has as many behind the point as its own size leaves of these.
std::string place_text(const Scene& scene, Vec3 p, int digits);

/// The place that place_text() says, in the coordinates of the file.
DoubleVec3 told_place(const Scene& scene, Vec3 p, int digits);

} // namespace pertev
