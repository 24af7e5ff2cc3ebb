#pragma once

// Shapes of pbrt as meshes. Equal spheres, disks, cylinders and PLY files share one mesh. ReverseOrientation
// turns a surface round.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "formats/described/parameters.h"
#include "formats/described/parts.h"
#include "formats/pbrt/context.h"
#include "math/double_transform.h"

namespace pertev::pbrt {

/// The mesh of a Shape statement.
struct ReadShape {
    uint32_t mesh;             // index into the meshes
    DoubleTransform from_mesh; // this shape's own, before ShapeMesh::shape_from_mesh
};

class Shapes {
public:
    /// Meshes are added to `meshes`. The arguments must outlive this object.
    Shapes(const Context& context, std::vector<ShapeMesh>& meshes) : context_(context), meshes_(meshes) {}

    /// Reads a shape except its alpha. Returns nothing, with a warning, for a type that is left out. Throws
    /// Error(BadInput) if it is unreadable.
    std::optional<ReadShape> read(const std::string& type, bool is_reversed, Parameters& parameters);

    /// Reads the PLY files in parallel, and completes all meshes. An unreadable file leaves an empty mesh, with a
    /// warning.
    void finish();

private:
    ReadShape add_mesh(ShapeMesh mesh, bool is_tessellated);
    ReadShape triangle_mesh(bool is_subdivision, bool is_reversed, Parameters& parameters);
    ReadShape bilinear_mesh(bool is_reversed, Parameters& parameters);
    ReadShape ply_mesh(bool is_reversed, Parameters& parameters);
    ReadShape quadric(const std::string& type, bool is_reversed, Parameters& parameters);
    ShapeMesh read_vertices(bool is_reversed, Parameters& parameters);
    void read_ply_file(ShapeMesh& to, Sink& sink) const;

    const Context& context_;
    std::vector<ShapeMesh>& meshes_;
    std::map<std::string, uint32_t, std::less<>> shared_; // by what makes them
    uint64_t tessellated_ = 0;                            // triangles
};

} // namespace pertev::pbrt
