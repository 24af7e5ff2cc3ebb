#pragma once

// The light of a solution as hashes, by which a file is compared with the scene that it is shown with. They do not
// depend on cameras and pictures, nor on anything that does not affect the solution: mirrors, metal and glass,
// roughness, normal maps, culled backs, names, and unused materials.

#include "base/hash.h"
#include "scene/scene.h"

namespace pertev {

struct SolvedLight {
    Hash128 surfaces; // diffuse reflection, emission and transparency of instances: materials, textures, vertex
                      // colours
    Hash128 lights;   // point, spot and directional lights, the environment

    bool operator==(const SolvedLight&) const = default;
};

/// Hashes of the scene in its present state and time.
SolvedLight solved_light(const Scene& scene);

} // namespace pertev
