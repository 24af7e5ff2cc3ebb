#include "formats/gltf/skin.h"

#include <fmt/format.h>

namespace pertev::gltf {
namespace {

// Weighted sum of the joints that move one vertex.
struct Blend {
    Transform sum = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    float weight = 0;

    void add(const Transform& joint, float w) {
        sum.row0 += w * joint.row0;
        sum.row1 += w * joint.row1;
        sum.row2 += w * joint.row2;
        sum.translation += w * joint.translation;
        weight += w;
    }
    Transform result() const {
        const float inv = 1 / weight; // weights are rounded in many files: their sum need not be 1
        return {inv * sum.row0, inv * sum.row1, inv * sum.row2, inv * sum.translation};
    }
};

/// Adds JOINTS_`set` and WEIGHTS_`set` to the blends; false where there are none.
bool add_set(const Document& document, Buffers& buffers, const JsonValue& attributes, int set,
             const std::vector<Transform>& joints, std::vector<Blend>& blends) {
    const std::optional<JsonValue> joint_reference = attributes.find(fmt::format("JOINTS_{}", set));
    if (!joint_reference) return false;
    const JsonValue weight_reference = attributes.at(fmt::format("WEIGHTS_{}", set));
    const Accessor indices(document, buffers, *joint_reference, {ElementType::Vec4});
    const Accessor shares(document, buffers, weight_reference, {ElementType::Vec4});
    if (indices.count() != blends.size() || shares.count() != blends.size()) {
        throw joint_reference->error(fmt::format("{} joints and {} weights; expected {}, one for each of POSITION",
                                                 indices.count(), shares.count(), blends.size()));
    }
    const std::vector<uint32_t> numbers = indices.read_integers();
    const std::vector<float> weights = shares.read_floats();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (weights[i] == 0) continue; // exporters leave anything in unused joints
        if (numbers[i] >= joints.size()) {
            throw joint_reference->error(fmt::format("vertex {} has joint {}; expected less than {}, the number of the "
                                                     "skin's joints",
                                                     i / 4, numbers[i], joints.size()));
        }
        blends[i / 4].add(joints[numbers[i]], weights[i]);
    }
    return true;
}

// Inverse transpose up to a positive factor: the cofactors, with the sign of the determinant.
Vec3 transform_normal(const Transform& m, Vec3 n) {
    const Vec3 moved = {dot(cross(m.row1, m.row2), n), dot(cross(m.row2, m.row0), n), dot(cross(m.row0, m.row1), n)};
    return determinant(m) < 0 ? -moved : moved;
}

} // namespace

std::vector<Transform> read_joint_transforms(const Document& document, Buffers& buffers, const NodeGraph& nodes,
                                             const JsonValue& skin) {
    const std::vector<JsonValue> references = skin.at("joints").elements();
    std::vector<Transform> joints;
    for (const JsonValue& reference : references) {
        joints.push_back(nodes.world_from_node(document.index_into("nodes", reference)));
    }
    const std::optional<JsonValue> reference = skin.find("inverseBindMatrices");
    if (!reference) return joints;
    const Accessor accessor(document, buffers, *reference, {ElementType::Mat4});
    if (accessor.count() < joints.size() || accessor.component_type() != ComponentType::Float) {
        throw reference->error(
            fmt::format("{} matrices; expected {} of floats, one a joint", accessor.count(), joints.size()));
    }
    const std::vector<float> matrices = accessor.read_floats();
    for (std::size_t i = 0; i < joints.size(); ++i) {
        float columns[16];
        std::copy_n(matrices.begin() + static_cast<std::ptrdiff_t>(16 * i), 16, columns);
        joints[i] = compose(joints[i], transform_from_columns(columns));
    }
    return joints;
}

void apply_skin(const Document& document, Buffers& buffers, const JsonValue& attributes,
                const std::vector<Transform>& joints, Mesh& mesh) {
    buffers.charge(mesh.positions.size() * sizeof(Blend), attributes);
    std::vector<Blend> blends(mesh.positions.size());
    for (int set = 0; add_set(document, buffers, attributes, set, joints, blends); ++set) {
    }
    int64_t mirrored = 0; // vertices turned inside out, less those that are not
    for (std::size_t i = 0; i < blends.size(); ++i) {
        if (!(blends[i].weight > 0)) continue;
        const Transform m = blends[i].result();
        mirrored += determinant(m) < 0 ? 1 : -1;
        mesh.positions[i] = transform_point(m, mesh.positions[i]);
        if (!mesh.normals.empty()) mesh.normals[i] = transform_normal(m, mesh.normals[i]);
        if (mesh.tangents.empty()) continue;
        Vec4& t = mesh.tangents[i];
        const Vec3 moved = transform_vector(m, {t.x, t.y, t.z});
        t = {moved.x, moved.y, moved.z, t.w};
    }
    if (mirrored <= 0) return;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
}

} // namespace pertev::gltf
