#pragma once

// Media inside surfaces that light passes without refraction: holes of an opacity, and thin walls.

#include "formats/described/parts.h"
#include "formats/described/surface.h"

namespace pertev::described {

/// Returns whether some light passes the surface straight, though it is no boundary of a medium itself.
bool is_passed_straight(const Surface& surface);

/// Gives each shape that a medium fills, and whose surface light passes straight, a clear boundary of that medium just
/// inside of it, in place of its own. The meshes have been read.
void add_inner_boundaries(Parts& parts);

} // namespace pertev::described
