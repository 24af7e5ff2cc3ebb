#pragma once

// A scene at a time. All animations play at once from time 0 (scene/animation.h); what they place is written into the
// scene: instances, the vertices of meshes, cameras, lights. The result is a function of the scene at rest and the time
// alone, to the bit on every machine, whatever times came before.
//
// What a transform does that is singular or not finite at a time: it hides its instance; a camera whose direction it
// loses stands as at rest, a light gives no light.

#include <vector>

#include "scene/scene.h"
#include "scene/scene_update.h"

namespace pertev {

class PosedScene {
public:
    /// `rest` has been through validate(). It stays at rest until the first set_time.
    explicit PosedScene(Scene rest);

    /// At rest or at the time set last. It stays at one place in memory as long as this object does.
    const Scene& scene() const { return scene_; }
    /// Whether any time differs from rest.
    bool is_animated() const;

    /// Moves the scene to `time_s` and returns what that has changed (of cameras nothing is returned). Throws
    /// Error(BadInput) for a time that is not finite, Error(OverLimit) where something lies further out than
    /// kMaxCoordinate then; the scene may then be anywhere, and the next set_time tells all that has changed since the
    /// last that returned.
    SceneUpdate set_time(double time_s);

private:
    void drop_shapes_at_rest();
    void read_channels(double time_s);
    void place_nodes();
    void place_instances(double time_s);
    void shape_meshes();
    void place_cameras();
    void place_lights();
    SceneUpdate take_changes();

    Scene scene_;
    std::vector<Camera> cameras_at_rest_;
    std::vector<Light> lights_at_rest_;
    std::vector<uint32_t> parents_first_;
    std::vector<bool> node_moves_, instance_moves_;

    // Of each node at the time.
    std::vector<NodePose> poses_; // of those that are no matrix
    std::vector<Transform> world_from_node_;
    std::vector<std::vector<float>> morph_weights_;
    std::vector<float> fovs_;      // of each camera
    std::vector<Rgb> intensities_; // of each light

    // What the vertices in scene_ are made with, by shape.
    struct Applied {
        std::vector<float> morph_weights;
        std::vector<Transform> joints;
    };
    Applied wanted(const MeshShape& shape) const;
    std::vector<Applied> applied_;
    std::vector<Bounds3> bounds_; // of each mesh, local space
    std::vector<float> value_;    // of one channel

    // Since the last set_time that returned.
    std::vector<bool> moved_, deformed_, replaced_;
    bool lights_changed_ = false;
};

} // namespace pertev
