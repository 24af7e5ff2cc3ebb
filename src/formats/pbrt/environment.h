#pragma once

// Pictures of infinite lights as panoramas of a scene: pbrt-v4's equal-area octahedron, and pbrt-v3's latitudes and
// longitudes around the light's +z.
//
// Source: Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", JGT 13(3), 2008.

#include <filesystem>

#include "formats/pbrt/lights.h"
#include "image/image.h"
#include "math/double_transform.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev::pbrt {

/// Returns where the equal-area octahedron has the unit direction d, in [0, 1] from its first row and column.
Vec2 octahedral_place(Vec3 d);

/// Returns the environment of a light. `picture` is its file; `local_from_scene` leads from the directions of the
/// scene to those of the light. A picture that cannot be read is left out with a warning: nothing.
std::optional<Environment> make_environment(const InfiniteLight& light, const std::filesystem::path& picture,
                                            const DoubleTransform& local_from_scene, Sink& sink);

} // namespace pertev::pbrt
