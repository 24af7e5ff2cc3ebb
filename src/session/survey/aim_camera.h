#pragma once

// Default target and focus of a camera.

#include <optional>

#include "scene/scene.h"

namespace pertev {

struct Target {
    Vec3 position; // metres
    bool is_middle = true;
};

/// Target for `eye`: the middle of the scene's box; if the eye is there, the middle of a side of the box, along the
/// longer of x and z. The scene has passed validate().
Target target_from(const Scene& scene, Vec3 eye);

/// Distance along the camera's axis to the surface in the middle of its picture, metres; none if that is the
/// background. Every surface counts, even with holes or transparency, except for culled backs
/// (Material::double_sided). The scene has passed validate().
std::optional<float> distance_in_the_middle(const Scene& scene, const Camera& camera);

} // namespace pertev
