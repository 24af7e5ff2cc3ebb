#include "scene/validate/validate_parts.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"

namespace pertev {
namespace {

/// Returns whether all numbers of a pose are finite; those beyond the range of floats are not.
bool is_finite_pose(const NodePose& pose) {
    return is_finite(to_float(pose.translation)) && is_finite(to_float(pose.scale)) &&
           std::ranges::all_of(pose.rotation, [](double x) { return is_finite(static_cast<float>(x)); });
}

bool is_zero(const std::array<double, 4>& rotation) {
    return std::ranges::all_of(rotation, [](double x) { return static_cast<float>(x) == 0; });
}

/// Returns whether the four values from `first` on are a quaternion of length 0.
bool is_zero_quaternion(const std::vector<float>& values, std::size_t first) {
    return std::all_of(values.begin() + static_cast<std::ptrdiff_t>(first),
                       values.begin() + static_cast<std::ptrdiff_t>(first + 4), [](float x) { return x == 0; });
}

/// Returns the name of the list that a channel's target indexes, and the list's size.
std::pair<const char*, std::size_t> targets_of(AnimatedPart part, const Scene& scene) {
    if (is_of_node(part)) return {"node", scene.nodes.size()};
    if (is_of_camera(part)) return {"camera", scene.cameras.size()};
    if (is_of_material(part)) return {"material", scene.materials.size()};
    return {"light", scene.lights.size()};
}

} // namespace

std::size_t numbers_in_value(const AnimationChannel& channel, const Scene& scene) {
    if (channel.part == AnimatedPart::MaterialNumbers) return channel.numbers.size();
    const bool has_weights = channel.part == AnimatedPart::Weights;
    return has_weights ? scene.nodes[channel.target].morph_weights.size() : numbers_of(channel.part);
}

std::string fault_of(const AnimationChannel& channel, const Scene& scene) {
    const std::vector<float>& times = channel.times;
    const std::vector<float>& values = channel.values;
    if (channel.part == AnimatedPart::Weights && scene.nodes[channel.target].morph_weights.empty()) {
        return "its node's mesh has no morph targets, so that its weights cannot be animated";
    }
    if (places_node(channel.part) && channel.part != AnimatedPart::Visibility &&
        std::holds_alternative<DoubleTransform>(scene.nodes[channel.target].pose)) {
        return "its node has a matrix; expected translation, rotation and scale";
    }
    if (times.empty()) return "it has no key times; expected at least one key";
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (!is_finite(times[i]) || (i > 0 && times[i] < times[i - 1])) {
            return fmt::format("key time {} is {}; expected finite seconds in order", i, times[i]);
        }
    }
    const std::size_t numbers = numbers_in_value(channel, scene);
    const std::size_t per_key = channel.interpolation == Interpolation::CubicSpline ? 3 : 1;
    if (values.size() != times.size() * per_key * numbers) {
        return fmt::format("{} numbers for {}; expected {}: {} per key of {} each", values.size(),
                           counted(times.size(), "key time"), times.size() * per_key * numbers,
                           counted(per_key, "value"), counted(numbers, "number"));
    }
    const auto bad = std::ranges::find_if(values, [](float x) { return !is_finite(x); });
    if (bad != values.end()) return fmt::format("number {} of its values is not finite", bad - values.begin());
    if (channel.part != AnimatedPart::Rotation) return "";
    for (std::size_t key = 0; key < times.size(); ++key) { // tangents may be 0
        if (is_zero_quaternion(values, 4 * (key * per_key + per_key / 2))) {
            return fmt::format("the rotation of key {} is 0; expected a unit quaternion", key);
        }
    }
    return "";
}

namespace {

std::string name_of_node(const Scene& scene, std::size_t i) {
    return numbered("node", i, scene.nodes[i].name, fmt::format("/nodes/{}", i));
}

/// Throws Error(BadInput) unless `node`, which the part `of` of the scene names, is there or none.
template <class NameOf>
void check_node(const Scene& scene, const std::string& file, uint32_t node, const NameOf& of) {
    const std::size_t count = scene.nodes.size();
    if (node == kNoNode || node < count) return;
    throw Error(ErrorCode::BadInput, FileLocation{file},
                fmt::format("{}: node {} is out of range; there are {}", of(), node, count));
}

void validate_node(const Scene& scene, const std::string& file, std::size_t i) {
    const auto bad = [&](const std::string& what) {
        return Error(ErrorCode::BadInput, FileLocation{file}, name_of_node(scene, i) + ": " + what);
    };
    const Node& node = scene.nodes[i];
    check_node(scene, file, node.parent, [&] { return name_of_node(scene, i) + ": its parent"; });
    if (node.skin != kNoSkin && node.skin >= scene.skins.size()) {
        throw bad(fmt::format("skin {} is out of range; there are {}", node.skin, scene.skins.size()));
    }
    const NodePose* pose = std::get_if<NodePose>(&node.pose);
    if (pose != nullptr ? !is_finite_pose(*pose) : !is_finite(to_float(std::get<DoubleTransform>(node.pose)))) {
        throw bad("its transform is not finite");
    }
    if (pose != nullptr && is_zero(pose->rotation)) throw bad("its rotation is 0; expected a unit quaternion");
    if (!std::ranges::all_of(node.morph_weights, [](float w) { return is_finite(w); })) {
        throw bad("a morph weight is not finite");
    }
}

void validate_skin(const Scene& scene, const std::string& file, std::size_t i) {
    const auto bad = [&](const std::string& what) {
        return Error(ErrorCode::BadInput, FileLocation{file}, fmt::format("skin {}: {}", i, what));
    };
    const Skin& skin = scene.skins[i];
    if (!skin.joint_from_mesh.empty() && skin.joint_from_mesh.size() != skin.joints.size()) {
        throw bad(
            fmt::format("{} inverse bind matrices for {} joints", skin.joint_from_mesh.size(), skin.joints.size()));
    }
    if (!std::ranges::all_of(skin.joint_from_mesh, [](const Transform& m) { return is_finite(m); })) {
        throw bad("an inverse bind matrix is not finite");
    }
    for (const uint32_t joint : skin.joints) {
        if (joint < scene.nodes.size()) continue;
        throw bad(fmt::format("joint {} is out of range; there are {} nodes", joint, scene.nodes.size()));
    }
}

void validate_animation(const Scene& scene, const std::string& file, std::size_t i) {
    const Animation& animation = scene.animations[i];
    for (std::size_t k = 0; k < animation.channels.size(); ++k) {
        const auto bad = [&](const std::string& what) {
            const std::string of = numbered("animation", i, animation.name, animation.origin);
            return Error(ErrorCode::BadInput, FileLocation{file}, fmt::format("{}: channel {}: {}", of, k, what));
        };
        const AnimationChannel& channel = animation.channels[k];
        const auto [what, targets] = targets_of(channel.part, scene);
        if (channel.target >= targets) {
            throw bad(fmt::format("{} {} is out of range; there are {}", what, channel.target, targets));
        }
        const std::string fault = fault_of(channel, scene);
        if (!fault.empty()) throw bad(fault);
    }
}

} // namespace

void validate_nodes(const Scene& scene, const std::string& file) {
    const std::size_t count = scene.nodes.size();
    for (std::size_t i = 0; i < count; ++i) validate_node(scene, file, i);
    if (const std::size_t placed = parents_first(scene.nodes).size(); placed != count) {
        throw Error(ErrorCode::BadInput, FileLocation{file},
                    fmt::format("{} of {} nodes lie in or below a cycle; expected trees", count - placed, count));
    }
    for (std::size_t i = 0; i < scene.skins.size(); ++i) validate_skin(scene, file, i);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        check_node(scene, file, scene.instances[i].node,
                   [&] { return numbered("instance", i, scene.instances[i].name, std::string()); });
    }
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        check_node(scene, file, scene.cameras[i].node,
                   [&] { return numbered("camera", i, scene.cameras[i].name, scene.cameras[i].origin); });
    }
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        check_node(scene, file, scene.lights[i].node,
                   [&] { return numbered("light", i, scene.lights[i].name, scene.lights[i].origin); });
    }
    for (std::size_t i = 0; i < scene.animations.size(); ++i) validate_animation(scene, file, i);
}

} // namespace pertev
