#pragma once

// Surfaces of revolution about +z as meshes with exact normals at their vertices, for formats that have spheres, disks
// and cylinders. A full circle has kCircleSegments sides, so that no point of the mesh is further from the surface than
// 1 - cos(pi / 128) = 3.1e-4 of the radius.
//
// Texture coordinates: u follows the angle from +x towards +y; v rises with z, and on a disk from the rim inwards. As
// everywhere in a Scene the mesh holds 1 - v. The front is outside, and +z of a disk.

#include <cstdint>

#include "scene/mesh.h"

namespace pertev {

inline constexpr uint32_t kCircleSegments = 128;

/// The part of a sphere of radius 1 with z in [z_low, z_high], within [-1, 1], and an angle in [0, sweep], radians.
Mesh make_sphere(float z_low, float z_high, float sweep);
/// The part of a disk of radius 1 at z = 0 beyond the radius `inner` in [0, 1), with an angle in [0, sweep].
Mesh make_disk(float inner, float sweep);
/// A cylinder of radius 1 with z in [z_low, z_high] and an angle in [0, sweep].
Mesh make_cylinder(float z_low, float z_high, float sweep);

} // namespace pertev
