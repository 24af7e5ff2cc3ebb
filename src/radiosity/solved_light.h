#pragma once

// What the light of a solution was solved for, as hashes by which a file is held to the scene that it is shown with.
// Neither knows anything of cameras and pictures, nor of what the solution does not: what mirrors, metal and glass look
// like, roughness, normal maps, which backs the camera sees, names, and materials that no instance has.

#include "base/hash.h"
#include "scene/scene.h"

namespace pertev {

struct SolvedLight {
    Hash128 surfaces; // what instances reflect diffusely, emit and let through: materials, textures, vertices' colours
    Hash128 lights;   // point, spot and directional lights, the environment

    bool operator==(const SolvedLight&) const = default;
};

/// Of the scene as it is, at its time.
SolvedLight solved_light(const Scene& scene);

} // namespace pertev
