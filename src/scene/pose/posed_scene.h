#pragma once

// A scene at a time. All of Scene::animations play at once from time 0 (scene/animation.h), and their results are
// written into the scene: instances, vertices of meshes, cameras, lights, materials. The result depends only on the
// scene at rest and the time, to the bit on every machine, not on earlier times.
//
// Vertices with skins and morph targets are computed here or left to the renderer (device_scene/deforming_meshes.h),
// which computes the same. If the constructor requests it, the vertices of meshes without emission are left, unless
// at that time a joint mirrors or an instance is baked (is_skewed).
//
// A transform that is singular or not finite at a time, or a node that is not visible then, hides its instance, and a
// light gives no light. A camera whose direction is lost keeps its pose at rest.

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "scene/scene.h"
#include "scene/scene_update.h"

namespace pertev {

class PosedScene {
public:
    /// Takes a scene that has passed validate(). The scene is at rest until the first set_time.
    explicit PosedScene(Scene rest, bool leaves_vertices = false);

    /// The scene at rest or at the last time. Its address does not change.
    const Scene& scene() const { return scene_; }
    /// [Scene::shapes] the poses of vertices that animations may move.
    const std::vector<MeshPose>& poses() const { return poses_; }
    /// Returns whether the scene differs from rest at any time.
    bool is_animated() const;

    /// Moves the scene to `time_s` and returns the changes (except for cameras). The extent of vertices that are left
    /// to the renderer is not known here. Throws Error(BadInput) for a time that is not finite, Error(OverLimit) if
    /// something lies beyond kMaxCoordinate then. After that the scene is in an undefined state, and the next
    /// set_time returns all changes since the last one that succeeded.
    SceneUpdate set_time(double time_s);

    /// Changes numbers of the scene by `edit`, to which lights and cameras are at rest. It returns what it changed, as
    /// SceneUpdate allows, and nothing that an animation changes. A scene at a time must then be moved there again by
    /// set_time(), whose changes come in addition. If `edit` throws, it has changed nothing.
    SceneUpdate edit(const std::function<SceneUpdate(Scene&)>& edit);

    /// Positions of things at a time, without moving the scene there.
    struct Placements {
        /// [instance]; metres; nothing if no transform moves it, or if its transform is singular then.
        std::vector<std::optional<Transform>> instances;
        std::vector<Camera> cameras;
    };
    Placements placements_at(double time_s);

private:
    void drop_shapes_at_rest();
    void find_shapes_to_leave();
    void read_channels(double time_s);
    void update_nodes();
    void update_instances();
    void shape_meshes();
    void check_placements(double time_s) const;
    void update_cameras();
    void update_lights();
    void update_materials();
    SceneUpdate collect_changes();

    Scene scene_;
    std::vector<Camera> cameras_at_rest_;
    std::vector<Light> lights_at_rest_;
    std::vector<uint32_t> parents_first_;
    std::vector<bool> node_moves_, instance_moves_;

    // Per node, at the time.
    std::vector<NodePose> node_poses_; // for nodes without a matrix
    std::vector<NodeTransform> node_transforms_;
    std::vector<Transform> world_from_node_;  // from places_, relative to the scene's origin
    std::vector<bool> is_visible_, is_shown_; // by itself, and with all its ancestors
    std::vector<std::vector<float>> morph_weights_;
    std::vector<Camera> cameras_; // only field of view and height are used
    std::vector<Light> lights_;   // only intensity, range and cone are used
    /// A material that an animation changes, at rest and at the time.
    struct MovingMaterial {
        uint32_t index;
        MaterialParameters rest, now;
        std::map<uint8_t, TextureTransform> textures; // the transforms that channels change, by slot
    };
    std::vector<MovingMaterial> materials_;
    MovingMaterial* material_at(uint32_t index);

    // Per shape.
    MeshPose wanted(std::size_t shape) const;
    bool leaves_vertices_;
    std::vector<bool> may_be_left_;                   // vertices may be left to the renderer
    std::vector<MeshPose> poses_, on_host_, at_rest_; // at the time; of the vertices in scene_; at rest
    std::vector<Bounds3> bounds_;                     // [mesh] as in scene_, local space
    std::vector<float> value_;                        // value of one channel

    // Changes since the last set_time that succeeded.
    std::vector<bool> moved_, deformed_, replaced_;
    bool lights_changed_ = false, poses_changed_ = false, materials_changed_ = false;
};

} // namespace pertev
