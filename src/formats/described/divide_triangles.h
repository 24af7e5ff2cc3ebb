#pragma once

// Triangles small enough for coordinates of spherical and cylindrical mappings, which are linear across each triangle.

#include <memory>
#include <vector>

#include "formats/described/texture_mapping.h"
#include "scene/mesh.h"

namespace pertev::described {

/// Divides edges at their middles until coordinates that are linear along them are off by less than a thousandth of the
/// texture. Neighbours share the new vertices, so that no gaps appear. Near the axis, where no edge is short enough, it
/// ends with edges of a thousandth of the first ones. Returns whether `most_triangles` were enough; if not, the
/// triangles of the passes before are kept.
bool divide_triangles(Mesh& mesh, const std::vector<std::shared_ptr<const TextureMapping>>& mappings,
                      const DoubleTransform& world_from_mesh, std::size_t most_triangles);

} // namespace pertev::described
