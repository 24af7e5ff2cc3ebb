#pragma once

// Classifies a scene as an object to be viewed from outside or a place to be in, by rays from points around its
// middle, in bundles along the six axes: what bundles hit, and whether they hit fronts of surfaces.

#include "scene/scene.h"

namespace pertev {

enum class SurroundingsKind {
    Object, // viewed from outside
    Stage,  // a room with one open horizontal side, such as a Cornell box, through which it is viewed
    Room,   // walls all around; perhaps open at the top, like a courtyard
};

struct Surroundings {
    SurroundingsKind kind = SurroundingsKind::Object;
    Bounds3 bounds;       // bounds of the scene, world space
    Vec3 inside;          // Room: a point with a free view
    Vec3 open_side;       // Stage: unit, horizontal, outwards through the open side
    bool is_dark = false; // Room: no ray finds a way out, so no outside light enters
};

/// Surveys a scene that has passed validate(). Scenes with very many triangles count as Object without a test.
Surroundings survey_surroundings(const Scene& scene);

} // namespace pertev
