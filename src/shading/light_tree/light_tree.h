#pragma once

// A tree over the lights of a scene that have a position, down to single triangles: next-event estimation descends it
// and takes one of two children by how much light each may give to the receiver, so that a light is selected where it
// shines. A node has a box, a cone of normals and a power; its importance lies between a least and a largest value.
//
// Source: Conty Estevez, Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, with one
// child a node by the mean of its least and largest importance, which Cycles takes, too.
//
// Lengths are compared with lengths and squares with squares, so no probability depends on the unit of length. Thus
// like instances of a mesh share a subtree, for which the receiver moves into the mesh's space.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec3.h"
#include "shading/light_tree/light_tree_view.h"

namespace pertev {

/// A number of at most 23 bits as a float, for one node or for several at once.
template <class T>
HD inline T float_of_number(WordOf<T> number) {
    return float_of<T>(number | 0x4b000000u) - 0x1p23f;
}

/// Unit vector from three signed numbers of 10 bits; its length may be off by 2^-9.
template <class T>
HD inline Vec3Of<T> unpack_axis(WordOf<T> axis) {
    const auto side = [&](int shift) { return float_of_number<T>((axis >> shift) & 0x3ffu) * (1.0f / 511.0f) - 1.0f; };
    return {side(0), side(10), side(20)};
}

/// The directions in which a node emits: normals lie within a half angle about the axis, and light leaves within
/// another angle of a normal.
template <class T>
struct LightConeOf {
    T cos_normals, sin_normals, cos_emission;
    MaskOf<T> has_two_sides; // light also leaves against the normals

    HD explicit LightConeOf(WordOf<T> angles)
        : cos_normals(float_of_number<T>(angles & 0xfffu) * (1.0f / 2047.0f) - 1.0f),
          sin_normals(float_of_number<T>((angles >> 12) & 0xfffu) * (1.0f / 4095.0f)),
          cos_emission(float_of_number<T>((angles >> 24) & 0x7fu) * (1.0f / 63.0f) - 1.0f),
          has_two_sides((angles >> 31) != 0) {}
    /// Returns whether light may leave equally in all directions.
    HD MaskOf<T> is_isotropic() const { return !(cos_emission > -1.0f); }
};

/// The numbers of a node, or of several at once.
template <class T>
struct LightNodeOf {
    Vec3Of<T> centre;
    T power, radius;
    WordOf<T> axis, angles;
};

/// The receiver of light, for a tree: a point, and the unit normal of the side that scatters light, or zero.
template <class T>
struct LightReceiverOf {
    Vec3Of<T> point, normal;
    HD MaskOf<T> has_normal() const { return !(normal.x == 0.0f && normal.y == 0.0f && normal.z == 0.0f); }
};
using LightReceiver = LightReceiverOf<float>;

/// Returns the receiver in the space of a shared subtree.
HD inline LightReceiver local_receiver(const LightTreeInstance& instance, const LightReceiver& to) {
    const auto turned = [&](Vec3 v) {
        return Vec3{dot(instance.local_x, v), dot(instance.local_y, v), dot(instance.local_z, v)};
    };
    return {turned(to.point - instance.origin), instance.scale * turned(to.normal)};
}

/// The least and the largest importance of a node. Both are 0 if no light of it can reach the receiver.
template <class T>
struct LightImportanceOf {
    T least, most;
};

/// Cosines that differ by less count as equal, so that rounding hides no light.
inline constexpr float kLightTreeMargin = 0x1p-9f;

template <class T>
HD inline LightImportanceOf<T> importance_of(const LightNodeOf<T>& node, const LightReceiverOf<T>& to) {
    const T zero = T(0.0f), one = T(1.0f), margin = T(kLightTreeMargin);
    const Vec3Of<T> to_node = node.centre - to.point;
    const T radius_squared = node.radius * node.radius, distance_squared = length_squared(to_node);
    const MaskOf<T> is_outside = distance_squared > radius_squared;
    const T per_square = 1.0f / max(max(distance_squared, 0.25f * radius_squared), T(0x1p-120f));
    const T reach = node.power * per_square, per_distance = sqrt(per_square);
    const T sin_u = min(node.radius * per_distance, one); // u: half angle of the sphere around the box
    const T cos_u = sqrt(1.0f - sin_u * sin_u);

    // The receiver's normal and the way to the light: i. A receiver without a normal has cosines of 1.
    const MaskOf<T> has_normal = to.has_normal();
    const T cos_i = per_distance * dot(to.normal, to_node), sin_i = safe_sqrt(1.0f - cos_i * cos_i);
    const T most_i = select(cos_i >= cos_u, one, cos_i * cos_u + sin_i * sin_u);
    const T least_i = max(cos_i * cos_u - sin_i * sin_u, zero);

    // The light's axis and the way to the receiver: o. Normals spread by n about the axis, light by e about normals.
    const LightConeOf<T> cone(node.angles);
    const T along = -per_distance * dot(unpack_axis<T>(node.axis), to_node);
    const T cos_o = select(cone.has_two_sides, abs(along), along), sin_o = safe_sqrt(1.0f - cos_o * cos_o);
    const T cos_n = cone.cos_normals, sin_n = cone.sin_normals, cos_e = cone.cos_emission;
    const T cos_cos = cos_o * cos_u, sin_sin = sin_o * sin_u, sin_cos = sin_o * cos_u, cos_sin = cos_o * sin_u;
    const T near = cos_cos + sin_sin, far = cos_cos - sin_sin; // cosines of o - u and o + u
    const T most_o = select(cos_o >= cos_u || near >= cos_n, one, near * cos_n + (sin_cos - cos_sin) * sin_n);
    const T sum = far * cos_n - (sin_cos + cos_sin) * sin_n; // cosine of o + u + n
    const MaskOf<T> is_ahead = cos_o > 0.0f && far > 0.0f && cos_n > 0.0f && sum > max(cos_e, zero);

    const MaskOf<T> is_isotropic = cone.is_isotropic();
    const MaskOf<T> is_dark = (has_normal && !(most_i > -margin)) || (!is_isotropic && !(most_o > cos_e - margin));
    const T most = select(has_normal, max(most_i, margin), one) * select(is_isotropic, one, max(most_o, margin));
    const T least = select(has_normal, least_i, one) * select(is_isotropic, one, select(is_ahead, sum, zero));
    // Lights of a sphere around the receiver may lie close by, on any side.
    return {select(is_outside, select(is_dark, zero, least * reach), 0.5f * reach),
            select(is_outside, select(is_dark, zero, most * reach), reach)};
}
HD inline LightImportanceOf<float> importance_of(const LightTreeNode& node, const LightReceiver& to) {
    return importance_of<float>({node.centre, node.power, node.radius, node.axis, node.angles}, to);
}

/// Probability of the left one of two children: its share of the means of least and largest importances. Negative if
/// neither gives light.
template <class T>
HD inline T left_probability(const LightImportanceOf<T>& left, const LightImportanceOf<T>& right) {
    const T of_left = left.least + left.most, of_right = right.least + right.most;
    const T share = clamp(of_left / (of_left + of_right), T(0x1p-16f), T(1.0f - 0x1p-16f));
    const MaskOf<T> left_lights = left.most > 0.0f, right_lights = right.most > 0.0f;
    return select(right_lights, select(left_lights, share, T(0.0f)), select(left_lights, T(1.0f), T(-1.0f)));
}

/// A light that a tree has selected. `light` is kNoLeaf if the tree gives no light to the receiver.
struct LightTreeDraw {
    static constexpr uint32_t kNoLeaf = 0xffffffffu;
    uint32_t light = kNoLeaf;
    float pmf = 0;  // its probability within the tree
    float rest = 0; // position of the number within those that select it, uniform in [0, 1)
};

/// The descent of a number through a tree: which of `width` numbers of a node it is, and the node's probability.
struct LightTreeDescent {
    uint64_t number, width;
    float pmf = 1;

    /// Goes on to a child by the left one's probability, and returns whether that is the right one.
    HD bool goes_right(float p) {
        const auto share = static_cast<uint64_t>(p * 0x1p32f); // at most 2^32
        const uint64_t of_left = (width >> 32) * share + ((width & 0xffffffffu) * share >> 32);
        const bool is_right = number >= of_left;
        number -= is_right ? of_left : 0;
        width = is_right ? width - of_left : of_left;
        pmf *= is_right ? 1.0f - p : p;
        return is_right;
    }
    HD LightTreeDraw at(uint32_t light) const {
        return {light, pmf, min(static_cast<float>(number) / static_cast<float>(width), 0x1.fffffep-1f)};
    }
};

/// Selects a light by a number in [0, width); the larger of two never selects the earlier leaf. `width` is at least
/// 2^32.
HD_CALL inline LightTreeDraw draw_from_tree(const LightTreeView& tree, const LightReceiver& to, uint64_t number,
                                            uint64_t width) {
    LightTreeDescent descent = {number, width};
    LightReceiver here = to;
    uint32_t first_light = 0;
    LightTreeNode node = tree.nodes[kLightTreeRoot];
    if (node.is_leaf() && !(importance_of(node, to).most > 0)) return {};
    while (!node.is_leaf() || node.is_instance()) {
        if (node.is_instance()) {
            const LightTreeInstance& instance = tree.instances[node.number()];
            here = local_receiver(instance, to);
            first_light = instance.first_light;
            node = tree.nodes[instance.root];
        }
        const LightTreeNode left = tree.nodes[node.next], right = tree.nodes[node.next + 1];
        const float p = left_probability(importance_of(left, here), importance_of(right, here));
        if (p < 0) return {};
        node = descent.goes_right(p) ? right : left;
    }
    return descent.at(first_light + node.number());
}

/// Multiplies `pmf` by the probability of the way from a root to the leaf `leaf`. Returns false if it is 0.
HD inline bool descend_to_leaf(const LightTreeView& tree, const LightReceiver& to, uint32_t root, uint32_t leaf,
                               float& pmf) {
    LightTreeNode node = tree.nodes[root];
    for (uint32_t at = root; at != leaf;) {
        const LightTreeNode left = tree.nodes[node.next], right = tree.nodes[node.next + 1];
        const float p = left_probability(importance_of(left, to), importance_of(right, to));
        const bool is_right = leaf > node.next && (leaf == node.next + 1 || (!right.is_leaf() && leaf >= right.next));
        if (!((is_right ? 1.0f - p : p) > 0) || p < 0) return false;
        pmf *= is_right ? 1.0f - p : p;
        at = is_right ? node.next + 1 : node.next;
        node = is_right ? right : left;
    }
    return true;
}

/// Probability with which draw_from_tree selects a light, to the bit.
HD_CALL inline float pmf_in_tree(const LightTreeView& tree, const LightReceiver& to, uint32_t light) {
    const uint32_t leaf = tree.leaf_of_light[light];
    const LightTreeNode root = tree.nodes[kLightTreeRoot];
    if (leaf == 0 || (root.is_leaf() && !(importance_of(root, to).most > 0))) return 0;
    float pmf = 1;
    if ((leaf & LightTreeNode::kLeaf) == 0) return descend_to_leaf(tree, to, kLightTreeRoot, leaf, pmf) ? pmf : 0.0f;
    const LightTreeInstance& instance = tree.instances[leaf & ~LightTreeNode::kLeaf];
    if (!descend_to_leaf(tree, to, kLightTreeRoot, instance.leaf, pmf)) return 0;
    const uint32_t shared = tree.leaf_of_triangle[instance.first_leaf + (light - instance.first_light)];
    return descend_to_leaf(tree, local_receiver(instance, to), instance.root, shared, pmf) ? pmf : 0.0f;
}

} // namespace pertev
