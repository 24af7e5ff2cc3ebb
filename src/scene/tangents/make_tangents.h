#pragma once

// Gives tangents to meshes with a normal map whose file has none, by MikkTSpace over the texture coordinates of that
// map, as glTF 2.0 section 3.7.2.1 asks.

#include "scene/scene.h"

namespace pertev {

/// Gives tangents to each mesh that an instance shows with a normal map, if it has texture coordinates for that map and
/// no tangents. Vertices are split where their corners differ; triangles keep their order. A mesh whose instances have
/// normal maps over both sets of coordinates becomes two meshes. Tangents of a mesh that a skin or morph targets move
/// are made of its vertices before both, and move with them; each morph target gets the difference to the tangents of
/// the mesh that is moved to it. Every index of `scene` is in range and every number finite (validate() calls this).
void make_tangents(Scene& scene);

} // namespace pertev
