#pragma once

// A scene at a time. All of Scene::animations play at once from time 0 (scene/animation.h); what they place is written
// into the scene: instances, the vertices of meshes, cameras, lights. The result is a function of the scene at rest and
// the time alone, to the bit on every machine, whatever times came before.
//
// Vertices of skins and morph targets are made here, or left to whoever renders (device_scene/deforming_meshes.h), who
// makes the same. Left are, where the constructor is told to, those of a mesh that gives no light, unless at the time a
// joint of it mirrors or one of its instances is baked (is_skewed).
//
// What a transform does that is singular or not finite at a time: it hides its instance; a camera whose direction it
// loses stands as at rest, a light gives no light.

#include <optional>
#include <vector>

#include "scene/scene.h"
#include "scene/scene_update.h"

namespace pertev {

class PosedScene {
public:
    /// `rest` has been through validate(). It stays at rest until the first set_time.
    explicit PosedScene(Scene rest, bool leaves_vertices = false);

    /// At rest or at the time set last. It stays at one place in memory as long as this object does.
    const Scene& scene() const { return scene_; }
    /// By Scene::shapes: how the vertices stand that animations may move.
    const std::vector<MeshPose>& poses() const { return poses_; }
    /// Whether any time differs from rest.
    bool is_animated() const;

    /// Moves the scene to `time_s` and returns what that has changed (of cameras nothing is returned). Where vertices
    /// are left, how far out they lie is not known here. Throws
    /// Error(BadInput) for a time that is not finite, Error(OverLimit) where something lies further out than
    /// kMaxCoordinate then; the scene may then be anywhere, and the next set_time tells all that has changed since the
    /// last that returned.
    SceneUpdate set_time(double time_s);

    /// Where things are at a time, without going there.
    struct Places {
        /// Of each instance, metres; none: it does not move by a transform, or has a singular one then.
        std::vector<std::optional<Transform>> instances;
        std::vector<Camera> cameras;
    };
    Places places_at(double time_s);

private:
    void drop_shapes_at_rest();
    void find_shapes_to_leave();
    void read_channels(double time_s);
    void place_nodes();
    void place_instances();
    void shape_meshes();
    void check_places(double time_s) const;
    void place_cameras();
    void place_lights();
    SceneUpdate take_changes();

    Scene scene_;
    std::vector<Camera> cameras_at_rest_;
    std::vector<Light> lights_at_rest_;
    std::vector<uint32_t> parents_first_;
    std::vector<bool> node_moves_, instance_moves_;

    // Of each node at the time.
    std::vector<NodePose> node_poses_; // of those that are no matrix
    std::vector<NodePlace> places_;
    std::vector<Transform> world_from_node_; // by places_, relative to the scene's origin
    std::vector<std::vector<float>> morph_weights_;
    std::vector<Camera> cameras_; // of which the angle of view and the height count
    std::vector<Light> lights_;   // of which intensity, range and cone count

    // Of each shape.
    MeshPose wanted(std::size_t shape) const;
    bool leaves_vertices_;
    std::vector<bool> may_be_left_;                   // by whoever renders
    std::vector<MeshPose> poses_, on_host_, at_rest_; // at the time; of the vertices in scene_
    std::vector<Bounds3> bounds_;                     // of each mesh as it lies in scene_, local space
    std::vector<float> value_;                        // of one channel

    // Since the last set_time that returned.
    std::vector<bool> moved_, deformed_, replaced_;
    bool lights_changed_ = false, poses_changed_ = false;
};

} // namespace pertev
