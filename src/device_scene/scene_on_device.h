#pragma once

// A prepared scene in a device's memory, but for its trees, which are a tracer's (tracer/scene_tracer.h): owns
// the buffers, hands out the view. It lies there in parts, one buffer each, that are updated each on its own; an update
// that needs no more room than the part has takes no memory.

#include "device/buffer.h"
#include "device_scene/deforming_meshes.h"
#include "device_scene/opacity_micromaps.h"
#include "device_scene/placed_scene.h"
#include "device_scene/scene_view.h"

namespace pertev {

/// What may change of a scene by itself. A set of them is an uint32_t.
enum ScenePart : uint32_t {
    kPartGeometry = 1,     // meshes
    kPartInstances = 2,    // where they are and how they move, and the world's centre; of their materials, whether they
                           // have alpha and hide their backs
    kPartMaterials = 4,    // all else of materials; what they emit is in the lights too
    kPartTextures = 8,     // images
    kPartLights = 16,      // near and far ones, and how often each is drawn, but for the environment's own
    kPartTrees = 32,       // not here: a tracer's (tracer/)
    kPartEnvironment = 64, // its pixels, and the tables that draw one; with another environment go the lights too
    kPartShapes = 128, // what the vertices of meshes that move are made of, which never changes; geometry goes with it
    kPartPoses = 256,  // PlacedScene::poses: how these vertices stand
    kAllParts = 511,
};

/// An update copies parts of the scene (ScenePart): what it is given may go away afterwards. The view, and each copy of
/// it, is void after an update: view() has the new one. Work that was queued before an update still sees the scene as
/// it was. All throw Error(OutOfMemory), after which the part is empty and no view may be used until it is updated
/// again.
class SceneOnDevice {
public:
    SceneOnDevice(Queue& queue, const PlacedScene& prepared);

    const SceneView& view() const { return view_; }

    void update(Queue& queue, const PlacedScene& prepared, uint32_t parts);

    /// Meshes whose vertices were moved here, for trees that are fitted to them.
    std::vector<DeformedMesh> deformed(const PlacedScene& prepared) const {
        return deforming_.deformed(prepared, meshes_);
    }
    /// The meshes' positions as they are now are those of meshes_before() until the next call.
    void keep_positions() { deforming_.keep_positions(); }
    const MeshView* meshes_before() const { return deforming_.is_empty() ? view_.meshes : deforming_.before(); }

private:
    // One part each (ScenePart says what is in it).
    void update_geometry(Queue& queue, const PlacedScene& prepared);
    void update_instances(Queue& queue, const PlacedScene& prepared);
    void update_materials(Queue& queue, const Scene& scene);
    void update_textures(Queue& queue, const Scene& scene);
    void update_lights(Queue& queue, const PlacedScene& prepared);
    void update_environment(Queue& queue, const PlacedScene& prepared);
    void update_shapes(Queue& queue, const PlacedScene& prepared); // before geometry
    void update_poses(const PlacedScene& prepared) { deforming_.set_poses(prepared); }
    void update_micromaps(Queue& queue, const Scene& scene, uint32_t parts); // after all of these

    SceneView view_{};
    std::vector<MeshView> meshes_; // where none deforms: empty
    DeformingMeshes deforming_;
    OpacityMicromaps micromaps_;
    Buffer<std::byte> geometry_, instances_, materials_, lights_, environment_, textures_;
};

/// What SceneView::known will be.
MaterialsKnown materials_known(const Scene& scene);

/// Bytes that SceneOnDevice asks for.
std::size_t predicted_bytes(const PlacedScene& prepared, bool on_cuda);

} // namespace pertev
