#include "scene/pose/posed_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "math/double_vec3.h"
#include "math/portable_math.h"
#include "scene/pose/sample_channel.h"
#include "scene/scene_origin.h"
#include "scene/shape_mesh.h"
#include "scene/validate/validate_parts.h"

namespace pertev {
namespace {

// Splines may overshoot the valid range.
constexpr float kMinFov = 0x1p-12f;    // radians
constexpr float kMinLength = 0x1p-20f; // metres
constexpr float kMaxTextureTransform = 0x1p39f;

std::vector<uint32_t> numbers_of(const std::vector<bool>& flags) {
    std::vector<uint32_t> numbers;
    for (uint32_t i = 0; i < flags.size(); ++i) {
        if (flags[i]) numbers.push_back(i);
    }
    return numbers;
}

/// Returns whether `a` and `b` are equal to the bit. Zeros of different sign are different, because results computed
/// from them may differ.
template <class T>
bool same_bits(const T& a, const T& b) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Sets numbers of a material, by their indices in the order of visit_parameters.
void set_numbers(const std::vector<uint8_t>& indices, const std::vector<float>& values, MaterialParameters& material) {
    uint8_t index = 0;
    visit_parameters(
        material,
        [&](float& number, const char*, float least, float most) {
            const auto found = std::ranges::find(indices, index++);
            if (found == indices.end()) return;
            const float value = values[static_cast<std::size_t>(found - indices.begin())];
            if (&number == &material.ior) return set_gltf_ior(material, value == 0 ? 0 : clamp(value, least, most));
            number = clamp(value, least, most);
        },
        [](auto&&...) {});
}

/// Sets the part of textures' transforms that a channel changes.
void set_textures(const AnimationChannel& channel, const std::vector<float>& v,
                  std::map<uint8_t, TextureTransform>& textures) {
    const auto within = [](float x) { return clamp(x, -kMaxTextureTransform, kMaxTextureTransform); };
    for (const uint8_t slot : channel.numbers) {
        TextureTransform& now = textures.try_emplace(slot, channel.texture_at_rest).first->second;
        if (channel.part == AnimatedPart::TextureRotation) {
            if (is_finite(v[0])) now.rotation = v[0]; // a spline between finite numbers may be beyond them
        } else {
            Vec2& moved = channel.part == AnimatedPart::TextureOffset ? now.offset : now.scale;
            moved = {within(v[0]), within(v[1])};
        }
    }
}

void set_transforms(const std::map<uint8_t, TextureTransform>& textures, MaterialParameters& material) {
    uint8_t slot = 0;
    visit_textures(material, [&](TextureRef& texture, const char*) {
        if (const auto found = textures.find(slot++); found != textures.end()) set_transform(texture, found->second);
    });
}

std::array<float, 6> matrix_of(const TextureRef& t) { return {t.m00, t.m01, t.m02, t.m10, t.m11, t.m12}; }

/// Returns whether emitters of two materials are the same lights (shading/build_light_set.cpp): also beneath their
/// coat.
bool are_same_lights(const MaterialParameters& a, const MaterialParameters& b) {
    const auto numbers_of = [](const MaterialParameters& m) {
        return std::array{m.emission.r,   m.emission.g,   m.emission.b,   m.coat_weight, m.coat_roughness,
                          m.coat_color.r, m.coat_color.g, m.coat_color.b, m.coat_ior};
    };
    const auto matrices_of = [](const MaterialParameters& m) {
        return std::array{matrix_of(m.emission_texture), matrix_of(m.coat_texture), matrix_of(m.coat_roughness_texture),
                          matrix_of(m.coat_color_texture)};
    };
    if (!a.is_emissive() && !b.is_emissive()) return true;
    return same_bits(numbers_of(a), numbers_of(b)) && same_bits(matrices_of(a), matrices_of(b));
}

} // namespace

PosedScene::PosedScene(Scene rest, bool leaves_vertices)
    : scene_(std::move(rest)), cameras_at_rest_(scene_.cameras), lights_at_rest_(scene_.lights),
      parents_first_(parents_first(scene_.nodes)), node_moves_(moving_nodes(scene_)), instance_moves_(may_move(scene_)),
      node_transforms_(transforms_of(scene_.nodes, parents_first_)),
      world_from_node_(world_from_nodes(node_transforms_, scene_.origin_in_file)),
      is_shown_(visible_nodes(scene_.nodes, parents_first_)), cameras_(scene_.cameras), lights_(scene_.lights),
      leaves_vertices_(leaves_vertices), moved_(scene_.instances.size()), deformed_(scene_.meshes.size()),
      replaced_(scene_.meshes.size()) {
    for (const Node& node : scene_.nodes) {
        const NodePose* pose = std::get_if<NodePose>(&node.pose);
        node_poses_.push_back(pose == nullptr ? NodePose{} : *pose);
        is_visible_.push_back(node.is_visible);
        morph_weights_.push_back(node.morph_weights);
    }
    for (const Animation& animation : scene_.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            if (!is_of_material(channel.part) || material_at(channel.target) != nullptr) continue;
            const MaterialParameters& at_rest = scene_.materials[channel.target];
            materials_.push_back({channel.target, at_rest, at_rest, {}});
        }
    }
    drop_shapes_at_rest();
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) at_rest_.push_back(wanted(i));
    poses_ = on_host_ = at_rest_;
    find_shapes_to_leave();
    if (!is_animated()) return;
    for (const Mesh& mesh : scene_.meshes) bounds_.push_back(bounds_of(mesh));
}

/// Removes the shapes of meshes that no animation changes, which are no longer needed.
void PosedScene::drop_shapes_at_rest() {
    std::vector<bool> moves(scene_.meshes.size());
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        if (instance_moves_[i]) moves[scene_.instances[i].mesh] = true;
    }
    std::erase_if(scene_.shapes, [&](const MeshShape& shape) { return !moves[shape.mesh]; });
}

/// Selects meshes without emission all of whose instances may move; others are needed by the lights or the baked
/// tree. At rest the winding of their triangles is that of times without a mirroring joint.
void PosedScene::find_shapes_to_leave() {
    std::vector<bool> stays(scene_.meshes.size());
    const std::vector<bool> emits = may_emit(scene_);
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const Instance& instance = scene_.instances[i];
        const bool is_emitter = emits[instance.material] || scene_.materials[instance.material].is_emissive();
        if (is_emitter || !instance_moves_[i]) stays[instance.mesh] = true;
    }
    may_be_left_.clear();
    for (const MeshShape& shape : scene_.shapes)
        may_be_left_.push_back(leaves_vertices_ && !stays[shape.mesh] && !shape.is_turned_over);
}

bool PosedScene::is_animated() const {
    return std::ranges::any_of(scene_.animations, [](const Animation& a) { return !a.channels.empty(); });
}

SceneUpdate PosedScene::set_time(double time_s) {
    if (!std::isfinite(time_s)) {
        throw Error(ErrorCode::BadInput, "time", fmt::format("{}", time_s), "not finite; expected seconds");
    }
    if (!is_animated()) return {};
    read_channels(time_s);
    update_nodes();
    update_instances();
    shape_meshes();
    check_placements(time_s);
    update_cameras();
    update_lights();
    update_materials();
    return collect_changes();
}

SceneUpdate PosedScene::edit(const std::function<SceneUpdate(Scene&)>& edit) {
    const auto swap_rest = [&] {
        scene_.lights.swap(lights_at_rest_);
        scene_.cameras.swap(cameras_at_rest_);
        for (MovingMaterial& material : materials_)
            std::swap(static_cast<MaterialParameters&>(scene_.materials[material.index]), material.rest);
    };
    swap_rest();
    SceneUpdate update;
    try {
        update = edit(scene_);
    } catch (...) {
        swap_rest();
        throw;
    }
    lights_ = lights_at_rest_ = scene_.lights;
    cameras_ = cameras_at_rest_ = scene_.cameras;
    for (MovingMaterial& material : materials_) material.rest = scene_.materials[material.index];
    if (update.materials_changed) find_shapes_to_leave();
    return update;
}

PosedScene::Placements PosedScene::placements_at(double time_s) {
    const auto node_poses = node_poses_;
    const auto morph_weights = morph_weights_;
    const auto is_visible = is_visible_, is_shown = is_shown_;
    const auto saved_transforms = node_transforms_;
    const auto world_from_node = world_from_node_;
    const auto cameras = cameras_, placed_cameras = scene_.cameras;
    const auto lights = lights_;
    read_channels(time_s);
    update_nodes();
    update_cameras();
    Placements placements = {std::vector<std::optional<Transform>>(scene_.instances.size()), scene_.cameras};
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const Instance& instance = scene_.instances[i];
        if (!instance_moves_[i] || scene_.nodes[instance.node].skin != kNoSkin) continue;
        const Transform world =
            placed_in(node_transforms_[instance.node], instance.node_from_local, scene_.origin_in_file);
        if (is_shown_[instance.node] && !is_singular(world)) placements.instances[i] = world;
    }
    node_poses_ = node_poses;
    morph_weights_ = morph_weights;
    is_visible_ = is_visible;
    is_shown_ = is_shown;
    node_transforms_ = saved_transforms;
    world_from_node_ = world_from_node;
    cameras_ = cameras;
    scene_.cameras = placed_cameras;
    lights_ = lights;
    return placements;
}

void PosedScene::read_channels(double time_s) {
    const bool is_moved = !(scene_.origin_in_file == DoubleVec3{0, 0, 0});
    for (MovingMaterial& material : materials_) {
        material.now = material.rest;
        material.textures.clear();
    }
    for (const Animation& animation : scene_.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            value_.resize(numbers_in_value(channel, scene_));
            sample_channel(channel, time_s, value_);
            const std::vector<float>& v = value_;
            switch (channel.part) {
            case AnimatedPart::Translation:
                node_poses_[channel.target].translation =
                    is_moved ? sample_translation(channel, time_s) : to_double(Vec3{v[0], v[1], v[2]});
                break;
            case AnimatedPart::Rotation:
                std::ranges::copy(v, node_poses_[channel.target].rotation.begin());
                break;
            case AnimatedPart::Scale:
                node_poses_[channel.target].scale = to_double(Vec3{v[0], v[1], v[2]});
                break;
            case AnimatedPart::Visibility:
                is_visible_[channel.target] = v[0] != 0;
                break;
            case AnimatedPart::Weights:
                morph_weights_[channel.target] = v;
                break;
            case AnimatedPart::CameraFov:
                cameras_[channel.target].fov_y = clamp(v[0], kMinFov, kPi - kMinFov);
                break;
            case AnimatedPart::CameraHeight:
                cameras_[channel.target].ortho_height = max(abs(v[0]), kMinLength);
                break;
            case AnimatedPart::LightIntensity:
                lights_[channel.target].intensity = {max(0.0f, v[0]), max(0.0f, v[1]), max(0.0f, v[2])};
                break;
            case AnimatedPart::LightRange:
                lights_[channel.target].range = max(v[0], kMinLength);
                break;
            case AnimatedPart::LightInnerCone:
                lights_[channel.target].cos_inner = cos(clamp(v[0], 0.0f, kPi / 2));
                break;
            case AnimatedPart::LightOuterCone:
                lights_[channel.target].cos_outer = cos(clamp(v[0], 0.0f, kPi / 2));
                break;
            case AnimatedPart::MaterialNumbers:
                set_numbers(channel.numbers, v, material_at(channel.target)->now);
                break;
            case AnimatedPart::TextureOffset:
            case AnimatedPart::TextureScale:
            case AnimatedPart::TextureRotation:
                set_textures(channel, v, material_at(channel.target)->textures);
                break;
            }
        }
    }
    for (MovingMaterial& material : materials_) set_transforms(material.textures, material.now);
}

PosedScene::MovingMaterial* PosedScene::material_at(uint32_t index) {
    const auto found = std::ranges::find(materials_, index, &MovingMaterial::index);
    return found == materials_.end() ? nullptr : &*found;
}

void PosedScene::update_materials() {
    for (const MovingMaterial& material : materials_) {
        MaterialParameters& shown = scene_.materials[material.index];
        const auto numbers_in = [](const MaterialParameters& parameters) {
            std::vector<float> numbers;
            visit_parameters(
                parameters, [&](float number, auto&&...) { numbers.push_back(number); },
                [&](const TextureRef& texture, const char*) {
                    const std::array<float, 6> matrix = matrix_of(texture);
                    numbers.insert(numbers.end(), matrix.begin(), matrix.end());
                });
            return numbers;
        };
        const std::vector<float> now = numbers_in(material.now), before = numbers_in(shown);
        if (std::memcmp(now.data(), before.data(), now.size() * sizeof(float)) == 0) continue;
        if (!are_same_lights(shown, material.now)) lights_changed_ = true;
        shown = material.now;
        materials_changed_ = true;
    }
}

void PosedScene::update_nodes() {
    for (const uint32_t node : parents_first_) {
        if (!node_moves_[node]) continue; // stays at rest
        const DoubleTransform* matrix = std::get_if<DoubleTransform>(&scene_.nodes[node].pose);
        const NodeTransform local = matrix == nullptr ? transform_of(node_poses_[node]) : transform_of(*matrix);
        const uint32_t parent = scene_.nodes[node].parent;
        node_transforms_[node] = parent == kNoNode ? local : compose(node_transforms_[parent], local);
        world_from_node_[node] = world_from_node(node_transforms_[node], scene_.origin_in_file);
        is_shown_[node] = is_visible_[node] && (parent == kNoNode || is_shown_[parent]);
    }
}

MeshPose PosedScene::wanted(std::size_t index) const {
    const MeshShape& shape = scene_.shapes[index];
    MeshPose pose;
    if (shape.node != kNoNode) pose.morph_weights = morph_weights_[shape.node];
    if (shape.skin != kNoSkin) pose.joints = joint_transforms(scene_.skins[shape.skin], world_from_node_);
    return pose;
}

void PosedScene::shape_meshes() {
    if (scene_.shapes.empty()) return;
    std::vector<bool> is_baked(scene_.meshes.size());
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const Instance& instance = scene_.instances[i];
        if (instance_moves_[i] && !instance.is_hidden && is_skewed(instance.world_from_local))
            is_baked[instance.mesh] = true;
    }
    const auto mirrors = [](const Transform& joint) { return is_mirroring(joint); };
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
        MeshPose pose = wanted(i);
        const bool is_left =
            may_be_left_[i] && !is_baked[scene_.shapes[i].mesh] && std::ranges::none_of(pose.joints, mirrors);
        const MeshPose& here = is_left ? at_rest_[i] : pose;
        if (!same_pose(here, on_host_[i])) {
            MeshShape& shape = scene_.shapes[i];
            Mesh& mesh = scene_.meshes[shape.mesh];
            on_host_[i] = here;
            const bool is_wound_anew = shape_mesh(shape, here.morph_weights, here.joints, mesh);
            (is_wound_anew ? replaced_ : deformed_)[shape.mesh] = true;
            bounds_[shape.mesh] = bounds_of(mesh);
        }
        pose.is_on_host = !is_left;
        if (same_pose(pose, poses_[i])) continue;
        poses_[i] = std::move(pose);
        poses_changed_ = true;
    }
}

void PosedScene::update_instances() {
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        Instance& instance = scene_.instances[i];
        if (!instance_moves_[i]) continue;
        const bool has_skin = scene_.nodes[instance.node].skin != kNoSkin; // the joints have moved it
        const Transform world =
            has_skin ? Transform()
                     : placed_in(node_transforms_[instance.node], instance.node_from_local, scene_.origin_in_file);
        const bool is_hidden = !is_shown_[instance.node] || is_singular(world);
        const bool stays = is_hidden || same_bits(world, instance.world_from_local);
        if (!stays || is_hidden != instance.is_hidden) moved_[i] = true;
        instance.world_from_local = is_hidden ? Transform() : world;
        instance.is_hidden = is_hidden;
    }
}

void PosedScene::check_placements(double time_s) const {
    std::vector<bool> is_left(scene_.meshes.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) is_left[scene_.shapes[i].mesh] = !poses_[i].is_on_host;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const Instance& instance = scene_.instances[i];
        if (!instance_moves_[i] || instance.is_hidden || is_left[instance.mesh]) continue;
        const Bounds3& local = bounds_[instance.mesh];
        if (local.is_empty() || is_within_limits(instance.world_from_local, local)) continue;
        throw Error(ErrorCode::OverLimit, "time", fmt::format("{}", time_s),
                    fmt::format("{} lies beyond 2^40 metres then; scale the scene down",
                                numbered("instance", i, instance.name, origin_of(instance))));
    }
}

void PosedScene::update_cameras() {
    for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
        Camera& camera = scene_.cameras[i];
        camera.fov_y = cameras_[i].fov_y;
        camera.ortho_height = cameras_[i].ortho_height;
        if (camera.node == kNoNode || !node_moves_[camera.node]) continue;
        const std::optional<Transform> rigid = without_scale(world_from_node_[camera.node]);
        const bool stands = rigid && is_within_limits(*rigid, Bounds3{{0, 0, 0}, {0, 0, 0}});
        camera.world_from_camera = stands ? *rigid : cameras_at_rest_[i].world_from_camera;
        camera.world_from_camera.translation = rounded_to_file(scene_, camera.world_from_camera.translation);
    }
}

void PosedScene::update_lights() {
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
        const Light& rest = lights_at_rest_[i];
        Light light = rest;
        light.intensity = lights_[i].intensity;
        light.range = lights_[i].range;
        light.cos_inner = lights_[i].cos_inner;
        light.is_hidden = light.node != kNoNode && !is_shown_[light.node];
        light.cos_outer = min(lights_[i].cos_outer, light.cos_inner - kSharpestEdge);
        if (light.node != kNoNode && node_moves_[light.node]) {
            bool stands = transform_light(world_from_node_[light.node], light);
            light.direction = normalize_safely(light.direction);
            stands = stands && is_oriented(light) &&
                     is_within_limits(make_translation(light.position), Bounds3{{0, 0, 0}, {0, 0, 0}});
            if (!stands) {
                light = rest;
                light.intensity = {0, 0, 0};
            }
        }
        Light& now = scene_.lights[i];
        const bool stays = same_bits(light.position, now.position) && same_bits(light.direction, now.direction) &&
                           same_bits(light.up, now.up) && light.is_mirrored == now.is_mirrored &&
                           light.is_hidden == now.is_hidden;
        const bool shines_alike = same_bits(light.intensity, now.intensity) && same_bits(light.range, now.range) &&
                                  same_bits(light.cos_inner, now.cos_inner) &&
                                  same_bits(light.cos_outer, now.cos_outer);
        if (stays && shines_alike) continue;
        now = std::move(light);
        lights_changed_ = true;
    }
}

SceneUpdate PosedScene::collect_changes() {
    SceneUpdate update = {numbers_of(moved_), numbers_of(deformed_), numbers_of(replaced_),
                          lights_changed_,    poses_changed_,        materials_changed_};
    for (std::vector<bool>* flags : {&moved_, &deformed_, &replaced_}) flags->assign(flags->size(), false);
    lights_changed_ = poses_changed_ = materials_changed_ = false;
    return update;
}

} // namespace pertev
