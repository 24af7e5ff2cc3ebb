#pragma once

// Pictures of infinite lights as panoramas of a scene.
//
// Source: Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", JGT 13(3), 2008.

#include <optional>

#include "base/sink.h"
#include "formats/described/parts.h"
#include "image/image.h"
#include "math/double_transform.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev::described {

/// Returns where the equal-area octahedron has the unit direction d, in [0, 1] from its first row and column.
Vec2 octahedral_place(Vec3 d);

/// Returns the environment of a light. `local_from_scene` leads from the directions of the scene to those of the
/// light. A picture that cannot be read is left out with a warning: nothing.
std::optional<Environment> make_environment(const InfiniteLight& light, const DoubleTransform& local_from_scene,
                                            Sink& sink);

} // namespace pertev::described
