#include "scene/node.h"

#include <cmath>

namespace pertev {

Transform transform_of(const NodePose& pose) {
    const Vec4 r = pose.rotation;
    const auto squared = [](float x) { return static_cast<double>(x) * static_cast<double>(x); };
    const double length = std::sqrt(squared(r.x) + squared(r.y) + squared(r.z) + squared(r.w));
    const auto unit = [&](float x) { return static_cast<float>(static_cast<double>(x) / length); };
    Transform m = make_rotation(unit(r.x), unit(r.y), unit(r.z), unit(r.w));
    const Vec3 scale = pose.scale;
    for (Vec3* row : {&m.row0, &m.row1, &m.row2}) *row = {row->x * scale.x, row->y * scale.y, row->z * scale.z};
    m.translation = pose.translation;
    return m;
}

Transform parent_from_node(const Node& node) {
    if (const Transform* matrix = std::get_if<Transform>(&node.pose)) return *matrix;
    return transform_of(std::get<NodePose>(node.pose));
}

std::vector<Transform> world_from_nodes(std::span<const Node> nodes, std::span<const uint32_t> parents_first) {
    std::vector<Transform> world(nodes.size());
    for (const uint32_t node : parents_first) {
        const Transform local = parent_from_node(nodes[node]);
        const uint32_t parent = nodes[node].parent;
        world[node] = parent == kNoNode ? local : compose(world[parent], local);
    }
    return world;
}

std::vector<uint32_t> parents_first(std::span<const Node> nodes) {
    enum class State : uint8_t { New, OnChain, Placed, Circular };
    std::vector<State> states(nodes.size(), State::New);
    std::vector<uint32_t> order, chain;
    order.reserve(nodes.size());
    for (uint32_t first = 0; first < nodes.size(); ++first) {
        chain.clear();
        uint32_t node = first;
        for (; node != kNoNode && states[node] == State::New; node = nodes[node].parent) {
            states[node] = State::OnChain;
            chain.push_back(node);
        }
        const bool is_placed = node == kNoNode || states[node] == State::Placed;
        for (std::size_t i = chain.size(); i-- > 0;) {
            states[chain[i]] = is_placed ? State::Placed : State::Circular;
            if (is_placed) order.push_back(chain[i]);
        }
    }
    return order;
}

} // namespace pertev
