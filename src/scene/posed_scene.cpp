#include "scene/posed_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "math/double_vec3.h"
#include "scene/sample_channel.h"
#include "scene/shape_mesh.h"
#include "scene/validate_nodes.h"

namespace pertev {
namespace {

constexpr float kLeastFov = 0x1p-12f; // radians: splines may lead out of the range

std::vector<uint32_t> numbers_of(const std::vector<bool>& flags) {
    std::vector<uint32_t> numbers;
    for (uint32_t i = 0; i < flags.size(); ++i) {
        if (flags[i]) numbers.push_back(i);
    }
    return numbers;
}

/// Zeros of two signs are two, as what is computed from them may be.
template <class T>
bool same_bits(const T* a, const T* b, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    return count == 0 || std::memcmp(a, b, count * sizeof(T)) == 0;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && same_bits(a.data(), b.data(), a.size());
}

template <class T>
bool same_bits(const T& a, const T& b) {
    return same_bits(&a, &b, 1);
}

} // namespace

PosedScene::PosedScene(Scene rest)
    : scene_(std::move(rest)), cameras_at_rest_(scene_.cameras), lights_at_rest_(scene_.lights),
      parents_first_(parents_first(scene_.nodes)), node_moves_(moving_nodes(scene_)), instance_moves_(may_move(scene_)),
      world_from_node_(world_from_nodes(scene_.nodes, parents_first_)), moved_(scene_.instances.size()),
      deformed_(scene_.meshes.size()), replaced_(scene_.meshes.size()) {
    for (const Node& node : scene_.nodes) {
        const NodePose* pose = std::get_if<NodePose>(&node.pose);
        poses_.push_back(pose == nullptr ? NodePose{} : *pose);
        morph_weights_.push_back(node.morph_weights);
    }
    for (const Camera& camera : scene_.cameras) fovs_.push_back(camera.fov_y);
    for (const Light& light : scene_.lights) intensities_.push_back(light.intensity);
    drop_shapes_at_rest();
    for (const MeshShape& shape : scene_.shapes) applied_.push_back(wanted(shape));
    if (!is_animated()) return;
    for (const Mesh& mesh : scene_.meshes) bounds_.push_back(bounds_of(mesh));
}

/// Those of meshes that no animation changes: they have done what they are for.
void PosedScene::drop_shapes_at_rest() {
    std::vector<bool> moves(scene_.meshes.size());
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        if (instance_moves_[i]) moves[scene_.instances[i].mesh] = true;
    }
    std::erase_if(scene_.shapes, [&](const MeshShape& shape) { return !moves[shape.mesh]; });
}

bool PosedScene::is_animated() const {
    return std::ranges::any_of(scene_.animations, [](const Animation& a) { return !a.channels.empty(); });
}

SceneUpdate PosedScene::set_time(double time_s) {
    if (!std::isfinite(time_s)) {
        throw Error(ErrorCode::BadInput, fmt::format("time {}: expected seconds, a finite number", time_s));
    }
    if (!is_animated()) return {};
    read_channels(time_s);
    place_nodes();
    shape_meshes();
    place_instances(time_s);
    place_cameras();
    place_lights();
    return take_changes();
}

void PosedScene::read_channels(double time_s) {
    for (const Animation& animation : scene_.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            value_.resize(numbers_in_value(channel, scene_));
            sample_channel(channel, time_s, value_);
            const std::vector<float>& v = value_;
            switch (channel.part) {
            case AnimatedPart::Translation:
                poses_[channel.target].translation = {v[0], v[1], v[2]};
                break;
            case AnimatedPart::Rotation:
                poses_[channel.target].rotation = {v[0], v[1], v[2], v[3]};
                break;
            case AnimatedPart::Scale:
                poses_[channel.target].scale = {v[0], v[1], v[2]};
                break;
            case AnimatedPart::Weights:
                morph_weights_[channel.target] = v;
                break;
            case AnimatedPart::CameraFov:
                fovs_[channel.target] = clamp(v[0], kLeastFov, kPi - kLeastFov);
                break;
            case AnimatedPart::LightIntensity:
                intensities_[channel.target] = {max(0.0f, v[0]), max(0.0f, v[1]), max(0.0f, v[2])};
                break;
            }
        }
    }
}

void PosedScene::place_nodes() {
    for (const uint32_t node : parents_first_) {
        if (!node_moves_[node]) continue; // stands as at rest
        const Transform* matrix = std::get_if<Transform>(&scene_.nodes[node].pose);
        const Transform local = matrix == nullptr ? transform_of(poses_[node]) : *matrix;
        const uint32_t parent = scene_.nodes[node].parent;
        world_from_node_[node] = parent == kNoNode ? local : compose(world_from_node_[parent], local);
    }
}

PosedScene::Applied PosedScene::wanted(const MeshShape& shape) const {
    Applied pose;
    if (shape.node != kNoNode) pose.morph_weights = morph_weights_[shape.node];
    if (shape.skin != kNoSkin) pose.joints = joint_transforms(scene_.skins[shape.skin], world_from_node_);
    return pose;
}

void PosedScene::shape_meshes() {
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
        MeshShape& shape = scene_.shapes[i];
        Applied pose = wanted(shape);
        const bool is_same = same_bits(pose.morph_weights, applied_[i].morph_weights);
        if (is_same && same_bits(pose.joints, applied_[i].joints)) continue;
        applied_[i] = std::move(pose);
        Mesh& mesh = scene_.meshes[shape.mesh];
        const bool is_wound_anew = shape_mesh(shape, applied_[i].morph_weights, applied_[i].joints, mesh);
        (is_wound_anew ? replaced_ : deformed_)[shape.mesh] = true;
        bounds_[shape.mesh] = bounds_of(mesh);
    }
}

void PosedScene::place_instances(double time_s) {
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        Instance& instance = scene_.instances[i];
        if (!instance_moves_[i]) continue;
        if (scene_.nodes[instance.node].skin == kNoSkin) {
            const Transform world = placed_in(world_from_node_[instance.node], instance.node_from_local);
            const bool is_hidden = is_singular(world);
            const Transform place = is_hidden ? Transform() : world;
            if (!same_bits(place, instance.world_from_local) || is_hidden != instance.is_hidden) moved_[i] = true;
            instance.world_from_local = place;
            instance.is_hidden = is_hidden;
        }
        const Bounds3& local = bounds_[instance.mesh];
        if (instance.is_hidden || local.is_empty() || lies_near(instance.world_from_local, local)) continue;
        throw Error(ErrorCode::OverLimit,
                    fmt::format("{} lies further out than 2^40 metres at {} s; scale the scene down",
                                numbered("instance", i, instance.name, origin_of(instance)), time_s));
    }
}

void PosedScene::place_cameras() {
    for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
        Camera& camera = scene_.cameras[i];
        camera.fov_y = fovs_[i];
        if (camera.node == kNoNode || !node_moves_[camera.node]) continue;
        const std::optional<Transform> rigid = without_scale(world_from_node_[camera.node]);
        const bool stands = rigid && lies_near(*rigid, Bounds3{{0, 0, 0}, {0, 0, 0}});
        camera.world_from_camera = stands ? *rigid : cameras_at_rest_[i].world_from_camera;
    }
}

void PosedScene::place_lights() {
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
        const Light& rest = lights_at_rest_[i];
        Light light = rest;
        light.intensity = intensities_[i];
        if (light.node != kNoNode && node_moves_[light.node]) {
            bool stands = place_light(world_from_node_[light.node], light);
            light.direction = normalize_safely(light.direction);
            stands = stands && lies_near(make_translation(light.position), Bounds3{{0, 0, 0}, {0, 0, 0}});
            if (!stands) {
                light = rest;
                light.intensity = {0, 0, 0};
            }
        }
        Light& now = scene_.lights[i];
        const bool stays = same_bits(light.position, now.position) && same_bits(light.direction, now.direction);
        if (stays && same_bits(light.intensity, now.intensity)) continue;
        now = std::move(light);
        lights_changed_ = true;
    }
}

SceneUpdate PosedScene::take_changes() {
    SceneUpdate update = {numbers_of(moved_), numbers_of(deformed_), numbers_of(replaced_), lights_changed_};
    for (std::vector<bool>* flags : {&moved_, &deformed_, &replaced_}) flags->assign(flags->size(), false);
    lights_changed_ = false;
    return update;
}

} // namespace pertev
