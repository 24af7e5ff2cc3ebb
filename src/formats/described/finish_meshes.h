#pragma once

// Completes the meshes of a described scene.

#include <functional>
#include <vector>

#include "base/sink.h"
#include "formats/described/parts.h"

namespace pertev::described {

/// Reads the file of a shape into its mesh.
using ReadMeshFile = std::function<void(ShapeMesh& shape, Sink& sink)>;

/// Reads the files of the meshes in parallel, moves positions far from 0, and turns triangles to the front. An
/// unreadable file leaves an empty mesh, with a warning.
void finish_meshes(std::vector<ShapeMesh>& meshes, const ReadMeshFile& read, Sink& sink);

/// Returns the mesh with vertices of its own for each face.
Mesh split_faces(const Mesh& mesh);

} // namespace pertev::described
