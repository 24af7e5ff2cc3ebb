#include "scene/animation.h"

#include <algorithm>

#include "scene/scene.h"

namespace pertev {

std::vector<bool> may_move(const Scene& scene) {
    std::vector<bool> moving(scene.instances.size());
    std::vector<bool> is_placed_anew(scene.nodes.size()), is_reshaped(scene.nodes.size());
    bool any = false;
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            (channel.part == AnimatedPart::Weights ? is_reshaped : is_placed_anew)[channel.node] = true;
            any = true;
        }
    }
    if (!any) return moving;
    for (const uint32_t node : parents_first(scene.nodes)) {
        const uint32_t parent = scene.nodes[node].parent;
        if (parent != kNoNode && is_placed_anew[parent]) is_placed_anew[node] = true;
    }
    std::vector<bool> skin_moves;
    for (const Skin& skin : scene.skins) {
        skin_moves.push_back(std::ranges::any_of(skin.joints, [&](uint32_t joint) { return is_placed_anew[joint]; }));
    }
    for (std::size_t i = 0; i < moving.size(); ++i) {
        const uint32_t index = scene.instances[i].node;
        if (index == kNoNode) continue;
        const uint32_t skin = scene.nodes[index].skin; // its joints move a skinned mesh, and not the node that shows it
        moving[i] = is_reshaped[index] || (skin == kNoSkin ? is_placed_anew[index] : skin_moves[skin]);
    }
    return moving;
}

} // namespace pertev
