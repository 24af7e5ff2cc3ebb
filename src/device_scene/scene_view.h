#pragma once

// The whole scene as device code sees it: plain pointers into buffers that device_scene/scene_on_device.h owns.

#include <cstdint>

#include "device_scene/crossed_surfaces.h"
#include "device_scene/interior_list.h"
#include "device_scene/micro_triangle.h"
#include "math/rigid_motion.h"
#include "math/transform.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"
#include "shading/light_selection.h"
#include "shading/light_set.h"
#include "shading/shading_variant.h"
#include "shading/texture_lookup.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// Geometry of one mesh, local space. Optional arrays are null.
struct MeshView {
    const Vec3* positions;
    const Vec3* normals;
    const Vec4* tangents;
    const Vec2* uv[kTextureSets];
    const Vec4* colors;
    const uint32_t* indices; // [3 * triangles]
};

struct InstanceView {
    Transform world_from_local;
    Transform local_from_world;
    uint32_t mesh;
    uint32_t material;
    uint16_t has_alpha;    // 1 if alpha may reject a hit
    uint16_t hides_back;   // 1 if camera rays pass through the back
    uint16_t is_mirrored;  // 1 if world_from_local reverses winding
    uint16_t is_hidden;    // 1 if it does not exist and world_from_local is undefined
    uint16_t is_baked;     // 1 if its triangles are traversed in the world, 0 if in its own space
    uint16_t layers_above; // Instance::layers_above
    uint16_t is_thin_wall; // 1 if it is one of SceneView::thin_walls
};

/// Solids of a scene that absorb by distance: none, some, or also one that emits.
enum class SolidAbsorption : uint8_t { None, Some, OfEmitters };

struct SceneView {
    const InstanceView* instances;
    const uint32_t* passing;              // one bit each, 32 per word: 1 if rays may pass a surface of the instance
    const OpacityMicromapView* micromaps; // [instance_count]; null: none
    const MeshView* meshes;
    const MaterialParameters* materials;
    const uint8_t* shading_groups; // [materials] (shading/shading_groups.h)
    ShadingVariant variant;        // shading variant of all materials
    SolidAbsorption absorption;    // by distance in solids
    const TextureImageView* images;
    const float* linear_from_srgb; // [kSrgbBytes], and [kSrgbWords] if there is an image of depth Srgb16
    LightSetView lights;
    uint32_t any_alpha;       // 0 if hits need not check their instance for alpha
    uint32_t any_unlit;       // 0 if no surface is unlit, which rays find though it is no light
    uint32_t any_hidden_back; // 0 if hits of camera rays need not check their instance for culled backs
    Vec3 centre;              // origin of the translated world, in the scene's coordinates, metres
                              // (device_scene/place_meshes.h)
    Vec3 position_shift;      // offset of the layer of positions relative to the translated world, metres
    // Triangles of all instances are numbered consecutively: those of instance i are from first_triangle[i] to
    // first_triangle[i + 1]. Null if their number exceeds 32 bits.
    const uint32_t* first_triangle; // [instance_count + 1]
    uint32_t instance_count;
    uint32_t background;     // 1 + the instance that layers show as background (Instance::is_background); 0: none
    uint64_t triangle_count; // total of all instances
    MotionsView motions;     // while the shutter is open
    NestingView nesting;     // solids that lie in each other; then `variant` is General
    uint32_t has_media;      // 1 if a medium fills any part of space
    const MaterialParameters* surroundings; // its medium fills what no solid fills; null without media
    CrossedSurfacesView boundaries;         // clear boundaries of media
    CrossedSurfacesView thin_walls;         // through which light goes straight to surfaces (thin_walls.h)
};

/// Returns whether a camera ray that hits this instance shows the background; true for kNoHit too.
HD inline bool shows_background(const SceneView& scene, uint32_t instance) {
    return instance == kNoHit || instance + 1 == scene.background;
}

/// The three vertex numbers of a triangle, and how coarsely its textures are looked up.
struct TriangleIndices {
    uint32_t a, b, c;
    float footprint = 0; // area of the ray's cone where it meets the triangle, in twice the triangle's; 0: no cone
};

HD inline TriangleIndices triangle_indices(const MeshView& mesh, uint32_t primitive) {
    const uint32_t* i = mesh.indices + 3 * static_cast<uint64_t>(primitive);
    return {i[0], i[1], i[2]};
}

/// Vertex attribute at barycentrics (u, v), the weights of the second and third vertex.
template <class T>
HD T interpolate(const T* values, TriangleIndices i, float u, float v) {
    return (1.0f - u - v) * values[i.a] + u * values[i.b] + v * values[i.c];
}

/// Returns whether next-event estimation selects the scene's lights by its tree.
inline bool uses_light_tree(LightSelection selection, const SceneView& scene) {
    return uses_light_tree(selection, scene.lights.tree.light_count, scene.motions.is_there());
}

} // namespace pertev
