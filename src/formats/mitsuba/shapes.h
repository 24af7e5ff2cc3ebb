#pragma once

// Shapes of Mitsuba as meshes. Equal spheres, disks, cylinders and files share one mesh. The front of a surface is
// where its normals point; flip_normals turns it round. Texture coordinates are Mitsuba's, whose v points down.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "formats/mitsuba/reading.h"
#include "math/double_transform.h"

namespace pertev::mitsuba {

/// The mesh of a shape, and where it is.
struct ReadShape {
    uint32_t mesh;              // index into Parts::meshes
    DoubleTransform world_from; // before ShapeMesh::shape_from_mesh
};

/// Lists what the surface of a shape needs of its mesh besides its geometry.
struct MeshNeeds {
    bool tangents = false; // a normal map needs them
    bool colors = false;   // vertex colours are the surface's
};

class Shapes {
public:
    /// `reading` outlives it.
    explicit Shapes(Reading& reading) : reading_(reading) {}

    /// Reads the geometry of a shape. Shapes with other needs have other meshes. Returns nothing, with a warning,
    /// for a type that is left out. Throws Error(BadInput) if it is unreadable.
    std::optional<ReadShape> read(Object& shape, MeshNeeds needs);

    /// Reads the files and completes all meshes. An unreadable file leaves an empty mesh, with a warning.
    void finish();

private:
    /// Describes how a file becomes a mesh.
    struct FileUse {
        char kind = 0; // o, p or s: obj, ply, serialized
        bool flips_v = false, has_face_normals = false, has_colors = false;
        bool is_mirrored =
            false;          // by its transform: without normals of its own its front is that of the mirrored corners
        uint32_t index = 0; // number of the mesh in a serialized file
    };
    uint32_t add(const std::string& key, const Object& shape, bool is_reversed, Mesh mesh);
    uint32_t file_mesh(Object& shape, bool is_reversed, const DoubleTransform& to_world);
    void read_mesh_file(const FileUse& use, ShapeMesh& to, Sink& sink) const;

    Reading& reading_;
    std::map<std::string, uint32_t, std::less<>> shared_; // by what makes them
    MeshNeeds needs_;                                     // needs of the shape that is read
    std::vector<uint32_t> with_tangents_;                 // meshes of normal maps
    std::map<uint32_t, FileUse> files_;                   // by mesh
};

/// Sets the tangents of normal maps: Mitsuba's lead along u, and its bitangents are across them and the normals, even
/// where v runs the other way.
void set_tangents(Mesh& mesh);

/// Returns the cube from -1 to 1 as Mitsuba has it, and the square from (-1, -1) to (1, 1) that faces +z.
Mesh make_cube();
Mesh make_rectangle();

} // namespace pertev::mitsuba
