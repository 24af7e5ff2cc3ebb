#pragma once

// Deforms one vertex of a mesh at one time: adds morph targets, then applies the joints' transforms, blended by the
// vertex's weights. It is a stage (device/launch.h); each index reads and writes only its own vertex.
//
// Source: glTF 2.0 sections 3.7.2.2 (morph targets) and 3.7.3.3 (skins).

#include <cstdint>

#include "base/host_device.h"
#include "math/double_vec3.h"
#include "math/frame.h"
#include "math/transform.h"
#include "math/vec4.h"

namespace pertev {

struct MorphTargetView {
    const Vec3 *positions, *normals, *tangents; // [vertices] each, or null
};

/// Transforms a normal by the inverse transpose up to a positive factor: the cofactors, with the determinant's sign.
HD inline Vec3 deform_normal(const Transform& m, Vec3 n) {
    const Vec3 moved = {dot(cross(m.row1, m.row2), n), dot(cross(m.row2, m.row0), n), dot(cross(m.row0, m.row1), n)};
    return determinant(m) < 0 ? -moved : moved;
}

struct DeformVertices {
    // Input: arrays of [vertices], or null if the mesh has none.
    const Vec3 *base_positions, *base_normals;
    const Vec4* base_tangents;
    const MorphTargetView* targets; // [target_count]
    const float* morph_weights;     // [target_count]
    uint32_t target_count;
    uint32_t joints_per_vertex;
    const uint32_t* joints;             // [vertices * joints_per_vertex]
    const float* joint_weights;         // [vertices * joints_per_vertex]
    const Transform* world_from_joints; // [joint of the skin], with its inverse bind matrix

    // Output: written if not null. Values that would not be finite keep the input; normals and tangents are unit.
    Vec3 *positions, *normals;
    Vec4* tangents;

    HD void operator()(uint32_t i) const {
        Vec3 position = base_positions[i], normal, tangent;
        if (normals != nullptr) normal = base_normals[i];
        if (tangents != nullptr) tangent = xyz(base_tangents[i]);
        for (uint32_t k = 0; k < target_count; ++k) {
            const float weight = morph_weights[k];
            if (weight == 0) continue;
            const MorphTargetView& target = targets[k];
            if (target.positions != nullptr) position += weight * target.positions[i];
            if (normals != nullptr && target.normals != nullptr) normal += weight * target.normals[i];
            if (tangents != nullptr && target.tangents != nullptr) tangent += weight * target.tangents[i];
        }
        Transform skin;
        float handedness = 1;
        if (blend(i, skin)) {
            if (determinant(skin) < 0) handedness = -1; // mirroring the surface mirrors the bitangent
            position = transform_point(skin, position);
            normal = deform_normal(skin, normal);
            tangent = transform_vector(skin, tangent);
        }
        positions[i] = is_finite(position) ? position : base_positions[i];
        if (normals != nullptr) {
            normal = normalize_safely(normal);
            normals[i] = is_finite(normal) ? normal : normalize_safely(base_normals[i]);
        }
        if (tangents == nullptr) return;
        tangent = normalize_safely(tangent);
        if (!is_finite(tangent)) {
            tangent = normals == nullptr ? normalize_safely(xyz(base_tangents[i])) : make_frame(normals[i]).tangent;
        }
        tangents[i] = {tangent.x, tangent.y, tangent.z, handedness * base_tangents[i].w};
    }

    /// Weighted mean of the transforms of the joints of vertex `i`. Returns false if it has none.
    HD bool blend(uint32_t i, Transform& mean) const {
        Transform sum = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        float all = 0;
        for (uint32_t k = 0; k < joints_per_vertex; ++k) {
            const float weight = joint_weights[i * uint64_t(joints_per_vertex) + k];
            if (weight == 0) continue;
            const Transform& joint = world_from_joints[joints[i * uint64_t(joints_per_vertex) + k]];
            sum.row0 += weight * joint.row0;
            sum.row1 += weight * joint.row1;
            sum.row2 += weight * joint.row2;
            sum.translation += weight * joint.translation;
            all += weight;
        }
        if (!(all > 0)) return false;
        const float inv = 1 / all; // weights are rounded in many files, so their sum need not be 1
        mean = {inv * sum.row0, inv * sum.row1, inv * sum.row2, inv * sum.translation};
        return true;
    }

    HD static Vec3 xyz(Vec4 v) { return {v.x, v.y, v.z}; }
};

} // namespace pertev
