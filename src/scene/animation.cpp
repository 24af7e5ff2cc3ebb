#include "scene/animation.h"

#include <algorithm>

#include "scene/scene.h"

namespace pertev {

double Animation::end_s() const {
    double end = 0;
    for (const AnimationChannel& channel : channels) {
        if (!channel.times.empty()) end = std::max(end, static_cast<double>(channel.times.back()));
    }
    return end;
}

namespace {

/// Returns the nodes of which an animation changes a part that `selects` accepts, and all nodes below these.
template <class Selects>
std::vector<bool> nodes_below_animated(const Scene& scene, const Selects& selects) {
    std::vector<bool> found(scene.nodes.size());
    bool any = false;
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            if (selects(channel.part)) found[channel.target] = any = true;
        }
    }
    if (!any) return found;
    for (const uint32_t node : parents_first(scene.nodes)) {
        const uint32_t parent = scene.nodes[node].parent;
        if (parent != kNoNode && found[parent]) found[node] = true;
    }
    return found;
}

} // namespace

std::vector<bool> moving_nodes(const Scene& scene) { return nodes_below_animated(scene, places_node); }

std::vector<bool> may_move(const Scene& scene) {
    std::vector<bool> moving(scene.instances.size());
    if (scene.animations.empty()) return moving;
    const std::vector<bool> is_repositioned = moving_nodes(scene);
    const std::vector<bool> may_vanish =
        nodes_below_animated(scene, [](AnimatedPart part) { return part == AnimatedPart::Visibility; });
    std::vector<bool> is_reshaped(scene.nodes.size());
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            if (channel.part == AnimatedPart::Weights) is_reshaped[channel.target] = true;
        }
    }
    std::vector<bool> skin_moves;
    for (const Skin& skin : scene.skins) {
        skin_moves.push_back(std::ranges::any_of(skin.joints, [&](uint32_t joint) { return is_repositioned[joint]; }));
    }
    for (std::size_t i = 0; i < moving.size(); ++i) {
        const uint32_t index = scene.instances[i].node;
        if (index == kNoNode) continue;
        const uint32_t skin = scene.nodes[index].skin; // a skinned mesh moves with its joints, not with the node that
                                                       // shows it
        moving[i] =
            is_reshaped[index] || may_vanish[index] || (skin == kNoSkin ? is_repositioned[index] : skin_moves[skin]);
    }
    return moving;
}

std::vector<bool> may_emit(const Scene& scene) {
    std::vector<bool> emits(scene.materials.size());
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            if (channel.part != AnimatedPart::MaterialNumbers) continue;
            const bool is_emission = std::ranges::any_of(channel.numbers, [](uint8_t number) {
                return std::ranges::count(material_numbers("emission"), number) > 0;
            });
            if (is_emission) emits[channel.target] = true;
        }
    }
    return emits;
}

} // namespace pertev
