#include "scene/node.h"

#include <cmath>

namespace pertev {

namespace {

/// Returns the transform that scales, then rotates by a unit quaternion.
DoubleTransform turned_and_scaled(double x, double y, double z, double w, DoubleVec3 scale) {
    return {{(1 - 2 * (y * y + z * z)) * scale.x, 2 * (x * y - z * w) * scale.y, 2 * (x * z + y * w) * scale.z},
            {2 * (x * y + z * w) * scale.x, (1 - 2 * (x * x + z * z)) * scale.y, 2 * (y * z - x * w) * scale.z},
            {2 * (x * z - y * w) * scale.x, 2 * (y * z + x * w) * scale.y, (1 - 2 * (x * x + y * y)) * scale.z},
            {0, 0, 0}};
}

double length_of(const std::array<double, 4>& q) {
    return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

} // namespace

NodeTransform transform_of(const NodePose& pose) {
    NodeTransform transform;
    const std::array<double, 4>& r = pose.rotation;
    const double size = length_of(r);
    transform.world_from_node = turned_and_scaled(r[0] / size, r[1] / size, r[2] / size, r[3] / size, pose.scale);
    transform.world_from_node.translation = pose.translation;

    std::array<double, 4> rounded; // the linear part is computed from floats
    for (std::size_t i = 0; i < 4; ++i) rounded[i] = static_cast<double>(static_cast<float>(r[i]));
    const double length = length_of(rounded);
    const auto unit = [&](std::size_t i) { return static_cast<float>(rounded[i] / length); };
    transform.linear = make_rotation(unit(0), unit(1), unit(2), unit(3));
    const Vec3 scale = to_float(pose.scale);
    Transform& m = transform.linear;
    for (Vec3* row : {&m.row0, &m.row1, &m.row2}) *row = {row->x * scale.x, row->y * scale.y, row->z * scale.z};
    return transform;
}

NodeTransform transform_of(const DoubleTransform& matrix) {
    NodeTransform transform = {matrix, to_float(matrix)};
    transform.linear.translation = {};
    return transform;
}

NodeTransform transform_of(const Node& node) {
    return std::visit([](const auto& pose) { return transform_of(pose); }, node.pose);
}

NodeTransform compose(const NodeTransform& a, const NodeTransform& b) {
    return {compose(a.world_from_node, b.world_from_node), compose(a.linear, b.linear)};
}

Transform world_from_node(const NodeTransform& transform, DoubleVec3 origin) {
    Transform world = transform.linear;
    world.translation = to_float(transform.world_from_node.translation - origin);
    return world;
}

std::vector<NodeTransform> transforms_of(std::span<const Node> nodes, std::span<const uint32_t> parents_first) {
    std::vector<NodeTransform> transforms(nodes.size());
    for (const uint32_t node : parents_first) {
        const NodeTransform local = transform_of(nodes[node]);
        const uint32_t parent = nodes[node].parent;
        transforms[node] = parent == kNoNode ? local : compose(transforms[parent], local);
    }
    return transforms;
}

std::vector<Transform> world_from_nodes(std::span<const NodeTransform> transforms, DoubleVec3 origin) {
    std::vector<Transform> world;
    world.reserve(transforms.size());
    for (const NodeTransform& transform : transforms) world.push_back(world_from_node(transform, origin));
    return world;
}

std::vector<bool> visible_nodes(std::span<const Node> nodes, std::span<const uint32_t> parents_first) {
    std::vector<bool> are_visible(nodes.size());
    for (const uint32_t node : parents_first) {
        const uint32_t parent = nodes[node].parent;
        are_visible[node] = nodes[node].is_visible && (parent == kNoNode || are_visible[parent]);
    }
    return are_visible;
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
