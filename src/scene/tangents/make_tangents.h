#pragma once

// Gives tangents to meshes with a normal map whose file has none, by MikkTSpace over the texture coordinates of that
// map, as glTF 2.0 section 3.7.2.1 asks.

#include "scene/scene.h"

namespace pertev {

/// Of each mesh that an instance shows with a normal map, and that has texture coordinates for it and no tangents.
/// Vertices are split where their corners differ: the mesh gets more of them, its triangles keep their order. A mesh
/// whose instances have normal maps over both sets of coordinates becomes two. What a skin or morph targets move gets
/// tangents of its vertices before any of that, and those move with it; so do those that each morph target adds. Every
/// index of `scene` is in range and every number finite (validate() calls this).
void make_tangents(Scene& scene);

} // namespace pertev
