#pragma once

// The hierarchy that a scene's instances, cameras and lights stand in: each of them says its node, and a node says its
// parent. They are placed already (Instance::world_from_local), at rest or at a time: nodes are for what moves them.
// What a node says itself is at rest at all times.

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "math/transform.h"
#include "math/vec4.h"
#include "scene/node_number.h"

namespace pertev {

inline constexpr uint32_t kNoSkin = 0xffffffffu;

/// The parts that an animation changes, at rest. The transform is translation * rotation * scale.
struct NodePose {
    Vec3 translation;             // metres
    Vec4 rotation = {0, 0, 0, 1}; // quaternion (x, y, z, w) of any length but 0
    Vec3 scale = {1, 1, 1};
};

struct Node {
    std::string name;
    uint32_t parent = kNoNode;              // index into Scene::nodes; it may stand after this node
    uint32_t skin = kNoSkin;                // index into Scene::skins: what moves its instances in the node's place
    std::variant<NodePose, Transform> pose; // parent from local; as a matrix it cannot be animated
    std::vector<float> morph_weights;       // one a morph target of its mesh, at rest; empty: the mesh has none
};

/// Which nodes move the vertices of a skinned mesh.
struct Skin {
    std::vector<uint32_t> joints;           // indices into Scene::nodes
    std::vector<Transform> joint_from_mesh; // inverse bind matrices, one a joint; empty: they do nothing
};

/// Parent from local.
Transform transform_of(const NodePose& pose);
Transform parent_from_node(const Node& node);

/// World from local of each node. `parents_first`: all of them in such an order.
std::vector<Transform> world_from_nodes(std::span<const Node> nodes, std::span<const uint32_t> parents_first);

/// All nodes, each after its parent; fewer than all where some go round in a circle. Every parent is in range. In time
/// in proportion to the nodes, without recursion.
std::vector<uint32_t> parents_first(std::span<const Node> nodes);

} // namespace pertev
