#pragma once

// The node hierarchy of a scene's instances, cameras and lights: each has a node, and a node has a parent. These
// objects have been placed already (Instance::world_from_local), at rest or at a time; nodes are only needed to move
// them. A node's own pose is always the one at rest.

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

/// The animated properties of a node, at rest. The transform is translation * rotation * scale, in the coordinates of
/// the file, in double.
struct NodePose {
    DoubleVec3 translation = {0, 0, 0};            // metres
    std::array<double, 4> rotation = {0, 0, 0, 1}; // quaternion (x, y, z, w) with any length but 0
    DoubleVec3 scale = {1, 1, 1};
};

struct Node {
    std::string name;
    uint32_t parent = kNoNode; // index into Scene::nodes; the parent may come after this node
    uint32_t skin = kNoSkin;   // index into Scene::skins, which moves its instances instead of the node
    std::variant<NodePose, DoubleTransform> pose; // parent from local; a matrix cannot be animated
    std::vector<float> morph_weights;             // weights at rest of the mesh's morph targets; empty: the mesh has
                                                  // none
    bool is_visible = true;                       // whether it shows what it and its descendants hold; an animation
                                                  // may change it
};

/// The nodes that move the vertices of a skinned mesh.
struct Skin {
    std::vector<uint32_t> joints;           // indices into Scene::nodes
    std::vector<Transform> joint_from_mesh; // inverse bind matrices, one per joint; empty: identity
};

/// Transform of a node to another space. Its `linear` part is rounded to floats after each node of a chain; the
/// position stays in double throughout.
struct NodeTransform {
    DoubleTransform world_from_node;
    Transform linear; // without a translation
};

/// Parent-from-local transform of a pose.
NodeTransform transform_of(const NodePose& pose);
NodeTransform transform_of(const DoubleTransform& matrix);
NodeTransform transform_of(const Node& node);
/// The transform `b` followed by `a`.
NodeTransform compose(const NodeTransform& a, const NodeTransform& b);
/// World-from-local transform relative to `origin`, which is subtracted in double.
Transform world_from_node(const NodeTransform& transform, DoubleVec3 origin);

/// Transform of each node in the coordinates of the file. `parents_first` is an order of all nodes with each after its
/// parent.
std::vector<NodeTransform> transforms_of(std::span<const Node> nodes, std::span<const uint32_t> parents_first);
std::vector<Transform> world_from_nodes(std::span<const NodeTransform> transforms, DoubleVec3 origin);

/// [node] whether a node and all its ancestors are visible at rest.
std::vector<bool> visible_nodes(std::span<const Node> nodes, std::span<const uint32_t> parents_first);

/// All nodes, each after its parent; fewer if there is a cycle. Every parent is in range. Takes linear time, without
/// recursion.
std::vector<uint32_t> parents_first(std::span<const Node> nodes);

} // namespace pertev
