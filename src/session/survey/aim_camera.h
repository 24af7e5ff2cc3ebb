#pragma once

// Where a camera looks, and where it focuses, when nothing says so.

#include <optional>

#include "scene/scene.h"

namespace pertev {

struct Target {
    Vec3 position; // metres
    bool is_middle = true;
};

/// What to look at from `eye`: the middle of the scene's box; for an eye that is there itself, the middle of a side of
/// the box, along the longer of x and z. The scene has been through validate().
Target target_from(const Scene& scene, Vec3 eye);

/// Distance along the camera's axis to what stands in the middle of its picture, metres; none where that is the
/// background. Any surface stands in the way, holes and what is half transparent too, but for backs that the camera
/// looks through (Material::double_sided). The scene has been through validate().
std::optional<float> distance_in_the_middle(const Scene& scene, const Camera& camera);

} // namespace pertev
