#pragma once

// Shapes of pbrt as meshes. Equal spheres, disks, cylinders and PLY files share one mesh. The front of a surface is
// where its normals point, or where its corners run counter-clockwise; ReverseOrientation turns it round.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "formats/pbrt/context.h"
#include "formats/pbrt/parameters.h"
#include "math/double_transform.h"
#include "scene/mesh.h"

namespace pertev::pbrt {

/// A mesh, and where it lies in the coordinates of its shape.
struct ShapeMesh {
    Mesh mesh;
    std::vector<DoubleVec3> exact; // positions, until finish() subtracts their middle
    DoubleTransform shape_from_mesh;
    std::string ply; // path of the file that finish() reads
    FileLocation location;
    bool is_reversed = false;
    std::vector<bool> is_turned; // whether finish() has exchanged corners 1 and 2 of a triangle
    bool is_quadric = false;     // one surface for pbrt, not many triangles
};

/// The mesh of a Shape statement.
struct ReadShape {
    uint32_t mesh;             // index into Shapes::meshes()
    DoubleTransform from_mesh; // this shape's own, before ShapeMesh::shape_from_mesh
};

class Shapes {
public:
    /// `context` outlives it.
    explicit Shapes(const Context& context) : context_(context) {}

    /// Reads a shape except its alpha. Returns nothing, with a warning, for a type that is left out. Throws
    /// Error(BadInput) if it is unreadable.
    std::optional<ReadShape> read(const std::string& type, bool is_reversed, Parameters& parameters);

    /// Reads the PLY files in parallel, and completes all meshes. An unreadable file leaves an empty mesh, with a
    /// warning.
    void finish();
    std::vector<ShapeMesh>& meshes() { return meshes_; }

private:
    ReadShape add_mesh(ShapeMesh mesh, bool is_tessellated);
    ReadShape triangle_mesh(bool is_subdivision, bool is_reversed, Parameters& parameters);
    ReadShape bilinear_mesh(bool is_reversed, Parameters& parameters);
    ReadShape ply_mesh(bool is_reversed, Parameters& parameters);
    ReadShape quadric(const std::string& type, bool is_reversed, Parameters& parameters);
    ShapeMesh read_vertices(bool is_reversed, Parameters& parameters);
    void read_ply_file(ShapeMesh& to, Sink& sink) const;

    const Context& context_;
    std::vector<ShapeMesh> meshes_;
    std::map<std::string, uint32_t, std::less<>> shared_; // by what makes them
    uint64_t tessellated_ = 0;                            // triangles
};

} // namespace pertev::pbrt
