#pragma once

// Shapes of Mitsuba as meshes. Equal spheres, disks, cylinders and files share one mesh. The front of a surface is
// where its normals point; flip_normals turns it round. Texture coordinates are Mitsuba's, whose v points down.

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "formats/mitsuba/reading.h"
#include "math/double_transform.h"

namespace pertev::mitsuba {

/// The mesh of a shape, with its transform.
struct ReadShape {
    uint32_t mesh;              // index into Parts::meshes
    DoubleTransform world_from; // before ShapeMesh::shape_from_mesh
};

/// Lists what the surface of a shape needs of its mesh besides its geometry.
struct MeshNeeds {
    bool tangents = false; // a normal map needs them
    bool mirrors = false;  // its group is mirrored, so that these lead the other way across
    bool colors = false;   // vertex colours are the surface's
};

class Shapes {
public:
    /// `reading` must outlive this object.
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
    void read_mesh_file(const FileUse& use, ShapeMesh& to, Sink& sink);
    /// Returns the bytes of a file with many meshes, which is read once. May be called from several threads.
    const std::vector<std::byte>& serialized(const std::string& file);

    Reading& reading_;
    std::map<std::string, uint32_t, std::less<>> shared_; // by what makes them
    MeshNeeds needs_;                                     // needs of the shape that is read
    std::map<uint32_t, bool> with_tangents_;              // meshes of normal maps, and whether they are mirrored
    std::map<uint32_t, FileUse> files_;                   // by mesh
    std::mutex serialized_mutex_;
    std::map<std::string, std::vector<std::byte>> serialized_; // by path
};

/// Sets the tangents of normal maps: Mitsuba's lead along u, and its bitangents are across them and the normals in the
/// world, even where v runs the other way. `mirrors`: the world mirrors the mesh.
void set_tangents(Mesh& mesh, bool mirrors);

/// Returns the cube from -1 to 1 as Mitsuba has it, and the square from (-1, -1) to (1, 1) that faces +z.
Mesh make_cube();
Mesh make_rectangle();

} // namespace pertev::mitsuba
