#pragma once

// The hierarchy that a scene's instances, cameras and lights stand in: each of them says its node, and a node says its
// parent. They are placed already (Instance::world_from_local), at rest or at a time: nodes are for what moves them.
// What a node says itself is at rest at all times.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "math/double_transform.h"
#include "math/transform.h"
#include "scene/node_number.h"

namespace pertev {

inline constexpr uint32_t kNoSkin = 0xffffffffu;

/// The parts that an animation changes, at rest. The transform is translation * rotation * scale. Nodes are in the
/// coordinates of the file, in double.
struct NodePose {
    DoubleVec3 translation = {0, 0, 0};            // metres
    std::array<double, 4> rotation = {0, 0, 0, 1}; // quaternion (x, y, z, w) of any length but 0
    DoubleVec3 scale = {1, 1, 1};
};

struct Node {
    std::string name;
    uint32_t parent = kNoNode; // index into Scene::nodes; it may stand after this node
    uint32_t skin = kNoSkin;   // index into Scene::skins: what moves its instances in the node's place
    std::variant<NodePose, DoubleTransform> pose; // parent from local; as a matrix it cannot be animated
    std::vector<float> morph_weights;             // one a morph target of its mesh, at rest; empty: the mesh has none
};

/// Which nodes move the vertices of a skinned mesh.
struct Skin {
    std::vector<uint32_t> joints;           // indices into Scene::nodes
    std::vector<Transform> joint_from_mesh; // inverse bind matrices, one a joint; empty: they do nothing
};

/// The place of a node in another space. What stands at the node is turned and scaled by `linear`, whose numbers are
/// floats after each node of a chain; where it stands is computed in double all along.
struct NodePlace {
    DoubleTransform world_from_node;
    Transform linear; // without a translation
};

/// Parent from local.
NodePlace place_of(const NodePose& pose);
NodePlace place_of(const DoubleTransform& matrix);
NodePlace place_of(const Node& node);
/// a after b.
NodePlace compose(const NodePlace& a, const NodePlace& b);
/// World from local, relative to `origin`, which is taken off in double.
Transform world_from_node(const NodePlace& place, DoubleVec3 origin);

/// The place of each node in the coordinates of the file. `parents_first`: all of them in such an order.
std::vector<NodePlace> places_of(std::span<const Node> nodes, std::span<const uint32_t> parents_first);
std::vector<Transform> world_from_nodes(std::span<const NodePlace> places, DoubleVec3 origin);

/// All nodes, each after its parent; fewer than all where some go round in a circle. Every parent is in range. In time
/// in proportion to the nodes, without recursion.
std::vector<uint32_t> parents_first(std::span<const Node> nodes);

} // namespace pertev
