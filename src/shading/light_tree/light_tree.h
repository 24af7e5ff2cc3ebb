#pragma once

// A tree over the lights of a scene that have a position, down to single triangles: next-event estimation descends it
// and takes one of two children by how much light each may give to the receiver, so that a light is selected where it
// shines. A node has a box, a cone of normals and a power; its importance lies between a least and a largest value.
//
// Source: Conty Estevez, Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, with one
// child a node by the mean of its least and largest importance, which Cycles takes, too.
//
// Lengths are compared with lengths and squares with squares, so no probability depends on the unit of length.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec3.h"
#include "shading/light_tree/light_tree_view.h"

namespace pertev {

/// Unit vector from three signed numbers of 10 bits; its length may be off by 2^-9.
HD inline Vec3 unpack_axis(uint32_t axis) {
    const auto side = [&](uint32_t shift) {
        return static_cast<float>((axis >> shift) & 0x3ffu) * (1.0f / 511.0f) - 1.0f;
    };
    return {side(0), side(10), side(20)};
}

/// The directions in which a node emits: normals lie within a half angle about the axis, and light leaves within
/// another angle of a normal.
struct LightCone {
    float cos_normals, sin_normals, cos_emission;
    bool has_two_sides; // light also leaves against the normals

    HD explicit LightCone(uint32_t angles)
        : cos_normals(static_cast<float>(angles & 0xfffu) * (1.0f / 2047.0f) - 1.0f),
          sin_normals(static_cast<float>((angles >> 12) & 0xfffu) * (1.0f / 4095.0f)),
          cos_emission(static_cast<float>((angles >> 24) & 0x7fu) * (1.0f / 63.0f) - 1.0f),
          has_two_sides((angles >> 31) != 0) {}
    /// Returns whether light may leave equally in all directions.
    HD bool is_isotropic() const { return !(cos_emission > -1); }
};

/// The receiver of light, for a tree: a point, and the unit normal of the side that scatters light, or zero.
struct LightReceiver {
    Vec3 point, normal;
    HD bool has_normal() const { return !(normal == Vec3{0, 0, 0}); }
};

/// The least and the largest importance of a node. Both are 0 if no light of it can reach the receiver.
struct LightImportance {
    float least = 0, most = 0;
};

/// Cosines that differ by less count as equal, so that rounding hides no light.
inline constexpr float kLightTreeMargin = 0x1p-9f;

HD inline LightImportance importance_of(const LightTreeNode& node, const LightReceiver& to) {
    const Vec3 to_node = node.centre - to.point;
    const float radius_squared = node.radius * node.radius, distance_squared = length_squared(to_node);
    const bool is_outside = distance_squared > radius_squared;
    const float per_square = 1.0f / max(max(distance_squared, 0.25f * radius_squared), 0x1p-120f);
    const float reach = node.power * per_square, per_distance = sqrt(per_square);
    const float sin_u = min(node.radius * per_distance, 1.0f); // u: half angle of the sphere around the box
    const float cos_u = sqrt(1.0f - sin_u * sin_u);

    // The receiver's normal and the way to the light: i. A receiver without a normal has cosines of 1.
    const bool has_normal = to.has_normal();
    const float cos_i = per_distance * dot(to.normal, to_node), sin_i = safe_sqrt(1.0f - cos_i * cos_i);
    const float most_i = cos_i >= cos_u ? 1.0f : cos_i * cos_u + sin_i * sin_u;
    const float least_i = max(cos_i * cos_u - sin_i * sin_u, 0.0f);

    // The light's axis and the way to the receiver: o. Normals spread by n about the axis, light by e about normals.
    const LightCone cone(node.angles);
    const float along = -per_distance * dot(unpack_axis(node.axis), to_node),
                cos_o = cone.has_two_sides ? abs(along) : along;
    const float sin_o = safe_sqrt(1.0f - cos_o * cos_o), cos_n = cone.cos_normals, sin_n = cone.sin_normals;
    const float cos_cos = cos_o * cos_u, sin_sin = sin_o * sin_u, sin_cos = sin_o * cos_u, cos_sin = cos_o * sin_u;
    const float near = cos_cos + sin_sin, far = cos_cos - sin_sin; // cosines of o - u and o + u
    const bool may_face = cos_o >= cos_u || near >= cos_n;
    const float most_o = may_face ? 1.0f : near * cos_n + (sin_cos - cos_sin) * sin_n;
    const float sum = far * cos_n - (sin_cos + cos_sin) * sin_n; // cosine of o + u + n
    const bool is_ahead = cos_o > 0 && far > 0 && cos_n > 0 && sum > max(cone.cos_emission, 0.0f);

    const bool is_isotropic = cone.is_isotropic();
    const bool is_dark = (has_normal && !(most_i > -kLightTreeMargin)) ||
                         (!is_isotropic && !(most_o > cone.cos_emission - kLightTreeMargin));
    const float most =
        (has_normal ? max(most_i, kLightTreeMargin) : 1.0f) * (is_isotropic ? 1.0f : max(most_o, kLightTreeMargin));
    const float least = (has_normal ? least_i : 1.0f) * (is_isotropic ? 1.0f : is_ahead ? sum : 0.0f);
    // Lights of a sphere around the receiver may lie close by, on any side.
    if (!is_outside) return {0.5f * reach, reach};
    return is_dark ? LightImportance{} : LightImportance{least * reach, most * reach};
}

/// Probability of the left one of two children: its share of the means of least and largest importances. Negative if
/// neither gives light.
HD inline float left_probability(const LightImportance& left, const LightImportance& right) {
    if (!(right.most > 0)) return left.most > 0 ? 1.0f : -1.0f;
    if (!(left.most > 0)) return 0;
    const float of_left = left.least + left.most, of_right = right.least + right.most;
    return clamp(of_left / (of_left + of_right), 0x1p-16f, 1.0f - 0x1p-16f);
}

/// A light that a tree has selected. `light` is kNoLeaf if the tree gives no light to the receiver.
struct LightTreeDraw {
    static constexpr uint32_t kNoLeaf = 0xffffffffu;
    uint32_t light = kNoLeaf;
    float pmf = 0;  // its probability within the tree
    float rest = 0; // position of the number within those that select it, uniform in [0, 1)
};

/// Selects a light by a number in [0, width); the larger of two never selects the earlier leaf. `width` is at least
/// 2^32.
HD_CALL inline LightTreeDraw draw_from_tree(const LightTreeView& tree, const LightReceiver& to, uint64_t number,
                                            uint64_t width) {
    LightTreeDraw draw;
    float pmf = 1;
    LightTreeNode node = tree.nodes[kLightTreeRoot];
    if (node.is_leaf() && !(importance_of(node, to).most > 0)) return draw;
    while (!node.is_leaf()) {
        const LightTreeNode left = tree.nodes[node.next], right = tree.nodes[node.next + 1];
        const float p = left_probability(importance_of(left, to), importance_of(right, to));
        if (p < 0) return draw;
        const auto share = static_cast<uint64_t>(p * 0x1p32f); // at most 2^32; number and width become the child's
        const uint64_t of_left = (width >> 32) * share + ((width & 0xffffffffu) * share >> 32);
        if (number < of_left) {
            node = left, width = of_left, pmf *= p;
        } else {
            node = right, number -= of_left, width -= of_left, pmf *= 1.0f - p;
        }
    }
    draw.light = node.light();
    draw.pmf = pmf;
    draw.rest = min(static_cast<float>(number) / static_cast<float>(width), 0x1.fffffep-1f);
    return draw;
}

/// Probability with which draw_from_tree selects a light, to the bit.
HD_CALL inline float pmf_in_tree(const LightTreeView& tree, const LightReceiver& to, uint32_t light) {
    const uint32_t leaf = tree.leaf_of_light[light];
    LightTreeNode node = tree.nodes[kLightTreeRoot];
    if (leaf == 0 || (node.is_leaf() && !(importance_of(node, to).most > 0))) return 0;
    float pmf = 1;
    for (uint32_t at = kLightTreeRoot; at != leaf;) {
        const LightTreeNode left = tree.nodes[node.next], right = tree.nodes[node.next + 1];
        const float p = left_probability(importance_of(left, to), importance_of(right, to));
        const bool is_right = leaf > node.next && (leaf == node.next + 1 || (!right.is_leaf() && leaf >= right.next));
        if (!((is_right ? 1.0f - p : p) > 0) || p < 0) return 0;
        pmf *= is_right ? 1.0f - p : p;
        at = is_right ? node.next + 1 : node.next;
        node = is_right ? right : left;
    }
    return pmf;
}

} // namespace pertev
