#pragma once

// All that the reader of a described scene has read, before it becomes a scene (formats/described/assemble.h).

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/limits.h"
#include "formats/described/combine_textures.h"
#include "formats/described/surface.h"
#include "formats/described/texture_value.h"
#include "formats/sun_sky/sun_sky.h"
#include "math/double_transform.h"
#include "scene/light.h"
#include "scene/medium.h"
#include "scene/mesh.h"
#include "scene/scene.h"

namespace pertev::described {

/// A mesh, and where it lies in the coordinates of its shape. The front of a surface is where its normals point, or
/// where its corners run counter-clockwise.
struct ShapeMesh {
    Mesh mesh;
    std::vector<DoubleVec3> exact; // positions, until finish_meshes() subtracts their middle
    DoubleTransform shape_from_mesh;
    std::string file; // path of the file that finish_meshes() reads
    FileLocation location;
    bool is_reversed = false;
    std::vector<bool> is_turned; // whether finish_meshes() has exchanged corners 1 and 2 of a triangle
    bool is_quadric = false;     // one surface for pbrt, not many triangles
};

/// The emission of shapes.
struct AreaLight {
    FileLocation location;
    Rgb radiance;       // W/(sr m2), times the image
    TextureValue image; // if it has one
    bool is_two_sided = false;
    double power = 0; // above 0: of each triangle or other shape; `radiance` is then its colour
};

enum class PanoramaLayout {
    Octahedron, // pbrt-v4's equal-area octahedron
    AroundZ,    // pbrt-v3's latitudes and longitudes around +z
    AroundY,    // Mitsuba's around +y
};

/// A light at infinity around the scene.
struct InfiniteLight {
    FileLocation location;
    Rgb scale;           // W/(sr m2), times the picture
    std::string picture; // path; empty: uniform
    PanoramaLayout layout = PanoramaLayout::Octahedron;
    double illuminance = 0; // above 0: on a surface that faces +z of the light
    DoubleTransform world_from_light;
    std::optional<SunSky> sky;  // in place of a picture, in the light's directions
    double lumens_per_watt = 0; // that a watt of the sky has
};

/// A light with its position before it is rounded.
struct PlacedLight {
    Light light;
    DoubleVec3 position;
    FileLocation location;
};

/// A shape, placed once. The members are indices into Parts.
struct Placed {
    std::string name;
    uint32_t mesh = 0, surface = 0;
    std::optional<uint32_t> area_light, alpha;
    std::optional<uint32_t> medium, outside; // media that fill it, and on its other side
    uint32_t layers_above = 0;               // Instance::layers_above
    DoubleTransform world_from_mesh;         // before ShapeMesh::shape_from_mesh
};

/// Returns the most instances of a scene whose files have `file_bytes`.
inline uint64_t max_placed(uint64_t file_bytes) {
    return std::min<uint64_t>(kMaxInstances,
                              justified_bytes(kFreeMeshBytes, file_bytes) / (sizeof(Instance) + sizeof(Placed)));
}

struct Parts {
    std::vector<ShapeMesh> meshes;
    std::vector<Surface> surfaces;
    std::vector<AreaLight> area_lights;
    std::vector<TextureValue> alphas;
    std::vector<MediumParameters> media;
    std::optional<uint32_t> around; // the medium around everything
    std::vector<Placed> placed;
    std::vector<InfiniteLight> infinite_lights;
    std::vector<PlacedLight> lights;
    std::vector<TextureImage> made;               // images that are not from files
    std::vector<CombinedTexture> combined;        // makes the images that are still empty
    std::array<Vec2, 3> missing_coordinates = {}; // texture coordinates of each triangle of a mesh without any
};

} // namespace pertev::described
