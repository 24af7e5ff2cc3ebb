#pragma once

// The whole scene as device code sees it: plain pointers into buffers that device_scene/scene_on_device.h owns.

#include <cstdint>

#include "device_scene/micro_triangle.h"
#include "math/rigid_motion.h"
#include "math/transform.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"
#include "shading/light_set.h"
#include "shading/materials_known.h"
#include "shading/texture_lookup.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// Geometry of one mesh, local space. Optional arrays are null.
struct MeshView {
    const Vec3* positions;
    const Vec3* normals;
    const Vec4* tangents;
    const Vec2* uv[2];
    const Vec4* colors;
    const uint32_t* indices; // [3 * triangles]
};

struct InstanceView {
    Transform world_from_local;
    Transform local_from_world;
    uint32_t mesh;
    uint32_t material;
    uint16_t has_alpha;   // 1 where a hit may be refused by its alpha
    uint16_t hides_back;  // 1 where rays from the camera pass the back
    uint16_t is_mirrored; // 1 where world_from_local turns winding over
    uint16_t is_hidden;   // 1 where it is not there, and world_from_local says nothing
    uint32_t is_baked;    // 1 where the walk has its triangles in the world, 0 where it goes into its own space
};

struct SceneView {
    const InstanceView* instances;
    const uint32_t* passing;              // a bit each, 32 a word: 1 where a ray may pass a surface of the instance
    const OpacityMicromapView* micromaps; // [instance_count]; null: none
    const MeshView* meshes;
    const MaterialParameters* materials;
    MaterialsKnown known; // of all of them
    const TextureImageView* images;
    const float* linear_from_srgb; // [256]
    LightSetView lights;
    uint32_t any_alpha;       // 0 lets every hit skip the look at its instance
    uint32_t any_hidden_back; // the same for hits of the camera's rays
    Vec3 centre;              // of the moved world, in the scene's coordinates, metres (device_scene/place_meshes.h)
    Vec3 position_shift;      // what the layer of positions adds to those of the moved world, metres
    // Triangles of all instances, numbered in their order: those of instance i are first_triangle[i] and on, up to
    // first_triangle[i + 1]. Null where there are more than 32 bits count.
    const uint32_t* first_triangle; // [instance_count + 1]
    uint32_t instance_count;
    uint32_t background;     // 1 + the instance that layers show as background (Instance::is_background); 0: none
    uint64_t triangle_count; // of all instances
    MotionsView motions;     // while the shutter is open
};

/// Whether a camera ray that meets this instance shows the background; true of kNoHit, too.
HD inline bool shows_background(const SceneView& scene, uint32_t instance) {
    return instance == kNoHit || instance + 1 == scene.background;
}

/// The three vertex numbers of a triangle.
struct TriangleIndices {
    uint32_t a, b, c;
};

HD inline TriangleIndices triangle_indices(const MeshView& mesh, uint32_t primitive) {
    const uint32_t* i = mesh.indices + 3 * static_cast<uint64_t>(primitive);
    return {i[0], i[1], i[2]};
}

/// Value of a vertex attribute at barycentrics (u, v): weights of the second and third vertex.
template <class T>
HD T interpolate(const T* values, TriangleIndices i, float u, float v) {
    return (1.0f - u - v) * values[i.a] + u * values[i.b] + v * values[i.c];
}

} // namespace pertev
