#pragma once

// A prepared scene in device memory, without its trees, which belong to a tracer (tracer/scene_tracer.h): owns the
// buffers and provides the view. It consists of parts with one buffer each, which are updated separately.

#include <memory>
#include <optional>
#include <vector>

#include "device/buffer.h"
#include "device_scene/deforming_meshes.h"
#include "device_scene/mip_map_levels.h"
#include "device_scene/nest_solids.h"
#include "device_scene/opacity_micromaps.h"
#include "device_scene/placed_scene.h"
#include "device_scene/scene_view.h"

namespace pertev {

/// Parts of a scene that may change separately, as bits of a set of type uint32_t.
enum ScenePart : uint32_t {
    kPartGeometry = 1,     // meshes
    kPartInstances = 2,    // transforms and motions, and the world's origin; whether the materials have alpha,
                           // cull back faces and are thin walls
    kPartMaterials = 4,    // everything else of materials; their emission is part of the lights too
    kPartTextures = 8,     // images
    kPartLights = 16,      // near and far lights, and their sampling, except for the environment's own tables
    kPartTrees = 32,       // trees, which belong to a tracer (tracer/)
    kPartEnvironment = 64, // pixels and sampling tables; with another environment the lights change too
    kPartShapes = 128,     // inputs of deforming vertices, which never change; needs geometry too
    kPartPoses = 256,      // PlacedScene::poses, the state of these vertices
    kAllParts = 511,
};

/// An update copies parts of the scene (ScenePart) from arguments that need not outlive it. It invalidates the view
/// and its copies; view() returns the new one. Work that was queued before an update still sees the previous scene.
/// All updates throw Error(OutOfMemory), after which the part is empty and no view may be used until it is updated
/// again.
class SceneOnDevice {
public:
    SceneOnDevice(Queue& queue, const PlacedScene& prepared);

    const SceneView& view() const { return view_; }
    const NestedSolids& nested_solids() const { return nested_; }

    /// Uploads only `parts`; reuses each part's buffer if it is large enough.
    void update(Queue& queue, const PlacedScene& prepared, uint32_t parts);

    /// Makes the mip-maps of the scene's images if there are none, which changes view(). Textures that are updated
    /// lose theirs. Throws Error(OutOfMemory), without an effect.
    void make_mip_maps(Queue& queue);

    /// Uploads the light tree, which is built at the first request, if there is none of these lights; this changes
    /// view(). Throws Error(OutOfMemory), without an effect.
    void make_light_tree(Queue& queue);

    /// Meshes whose vertices have moved on the device, for refitting trees.
    std::vector<DeformedMesh> deformed(const PlacedScene& prepared) const {
        return deforming_.deformed(prepared, meshes_);
    }
    /// Keeps the meshes' present positions for meshes_before() until the next call.
    void keep_positions() { deforming_.keep_positions(); }
    const MeshView* meshes_before() const { return deforming_.is_empty() ? view_.meshes : deforming_.before(); }

private:
    // Each function uploads one ScenePart.
    void update_geometry(Queue& queue, const PlacedScene& prepared);
    void update_instances(Queue& queue, const PlacedScene& prepared);
    void update_materials(Queue& queue, const Scene& scene);
    void update_textures(Queue& queue, const Scene& scene);
    void update_lights(Queue& queue, const PlacedScene& prepared);
    void update_environment(Queue& queue, const PlacedScene& prepared);
    void update_nesting(Queue& queue, const PlacedScene& prepared);   // after instances and materials
    void update_crossed(Queue& queue, const PlacedScene& prepared);   // after instances and materials
    void update_interiors(Queue& queue, const PlacedScene& prepared); // after nesting and media
    void update_shapes(Queue& queue, const PlacedScene& prepared);    // before geometry
    void update_poses(const PlacedScene& prepared) { deforming_.set_poses(prepared); }
    void update_micromaps(Queue& queue, const Scene& scene, uint32_t parts); // after all of these

    SceneView view_{};
    std::vector<MeshView> meshes_; // empty if none deforms
    DeformingMeshes deforming_;
    OpacityMicromaps micromaps_;
    std::vector<TextureImageView> images_; // on the device, without mip-maps
    std::vector<bool> are_srgb_;           // [images] colours are sRGB-encoded
    std::optional<MipMapLevels> mip_maps_;
    ClosedMeshes closed_meshes_; // cleared where the geometry changes
    NestedSolids nested_;
    std::vector<bool> thin_walls_;                         // find_thin_walls()
    ShadingVariant variant_ = ShadingVariant::General;     // variant of the materials alone
    std::shared_ptr<const RequestedLightTree> light_tree_; // that of the lights
    Buffer<std::byte> geometry_, instances_, materials_, lights_, light_nodes_, environment_, textures_, nesting_,
        crossed_, interiors_;
};

/// The simplest shading variant that covers the scene.
ShadingVariant shading_variant(const Scene& scene);

/// Bytes that SceneOnDevice allocates.
std::size_t predicted_bytes(const PlacedScene& prepared, bool on_cuda);

} // namespace pertev
