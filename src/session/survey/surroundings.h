#pragma once

// Is a scene a thing to be looked at from outside, or a place to be in? Told by rays from points around its middle, in
// bundles along the six axes: what bundles hit, and whether they meet the surfaces' front sides.

#include "scene/scene.h"

namespace pertev {

enum class SurroundingsKind {
    Object, // seen from outside
    Stage,  // a room that one horizontal side is open of, as a Cornell box: seen through it
    Room,   // walls all around; perhaps open at the top, as a courtyard
};

struct Surroundings {
    SurroundingsKind kind = SurroundingsKind::Object;
    Bounds3 bounds;       // of the scene, world space
    Vec3 inside;          // Room: a point with free sight
    Vec3 open_side;       // Stage: unit, horizontal, the way out
    bool is_dark = false; // Room: no ray finds a way out, so no light from outside comes in
};

/// The scene has been through validate(). Scenes of very many triangles are called Object unseen.
Surroundings look_around(const Scene& scene);

} // namespace pertev
