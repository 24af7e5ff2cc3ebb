#pragma once

// Backs of surfaces whose BSDF is not twosided. They are black in Mitsuba and reflect here.

#include <cstddef>
#include <span>

#include "formats/described/parts.h"
#include "math/double_vec3.h"

namespace pertev::mitsuba {

using described::Parts; // a device's Surface would hide Parts' own

struct VisibleBacks {
    std::size_t count = 0; // shapes
    std::size_t first = 0; // index into Parts::placed
};

/// Finds the shapes with such surfaces of which a back may show. It cannot if the shape is closed and no sensor is
/// behind its surface, or if all shapes, lights and sensors are in front of each of its triangles. The meshes have
/// been read.
VisibleBacks find_visible_backs(const Parts& parts, std::span<const DoubleVec3> sensors);

} // namespace pertev::mitsuba
