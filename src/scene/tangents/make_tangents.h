#pragma once

// Adds tangents to meshes with a normal map whose file has none, by MikkTSpace over the texture coordinates of that
// map, as glTF 2.0 section 3.7.2.1 requires.

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Adds tangents to each mesh that an instance shows with a normal map, if it has texture coordinates for that map
/// and no tangents. Vertices are split if their corners differ; triangles keep their order. A mesh whose instances
/// have normal maps over both sets of coordinates becomes two meshes. Tangents of a mesh with a skin or morph targets
/// are computed from its undeformed vertices and deform with them; each morph target stores the difference to the
/// tangents of the mesh at that target. Every index of `scene` is in range and every number finite (validate() calls
/// this).
void make_tangents(Scene& scene, Sink& sink = nobody());

} // namespace pertev
