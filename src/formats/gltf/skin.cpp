#include "formats/gltf/skin.h"

#include <fmt/format.h>

#include "formats/gltf/leave_out.h"

namespace pertev::gltf {
namespace {

/// JOINTS_n and WEIGHTS_n of one n: four of each for every vertex.
struct JointSet {
    std::vector<uint32_t> joints;
    std::vector<float> weights;
};

std::optional<JointSet> read_set(const Document& document, Buffers& buffers, const JsonValue& attributes,
                                 std::size_t number, std::size_t joint_count, std::size_t vertices) {
    const std::optional<JsonValue> joint_reference = attributes.find(fmt::format("JOINTS_{}", number));
    if (!joint_reference) return std::nullopt;
    const JsonValue weight_reference = attributes.at(fmt::format("WEIGHTS_{}", number));
    const Accessor indices(document, buffers, *joint_reference, {ElementType::Vec4});
    const Accessor shares(document, buffers, weight_reference, {ElementType::Vec4});
    if (indices.count() != vertices || shares.count() != vertices) {
        throw joint_reference->error(fmt::format("{} joints and {} weights; expected {}, one for each of POSITION",
                                                 indices.count(), shares.count(), vertices));
    }
    JointSet set = {indices.read_integers(), shares.read_floats()};
    for (std::size_t i = 0; i < set.joints.size(); ++i) {
        if (set.weights[i] == 0) set.joints[i] = 0; // exporters leave anything in unused joints
        if (set.weights[i] != 0 && set.joints[i] >= joint_count) {
            throw joint_reference->error(fmt::format("vertex {} has joint {}; expected less than {}, the number of the "
                                                     "skin's joints",
                                                     i / 4, set.joints[i], joint_count));
        }
    }
    return set;
}

} // namespace

std::vector<Transform> read_inverse_bind_matrices(const Document& document, Buffers& buffers, const JsonValue& skin,
                                                  std::size_t joint_count) {
    std::vector<Transform> transforms;
    const std::optional<JsonValue> reference = skin.find("inverseBindMatrices");
    if (!reference) return transforms;
    const Accessor accessor(document, buffers, *reference, {ElementType::Mat4});
    if (accessor.count() < joint_count || accessor.component_type() != ComponentType::Float) {
        throw reference->error(
            fmt::format("{} matrices; expected {} of floats, one per joint", accessor.count(), joint_count));
    }
    const std::vector<float> matrices = accessor.read_floats();
    for (std::size_t i = 0; i < joint_count; ++i) {
        float columns[16];
        std::copy_n(matrices.begin() + static_cast<std::ptrdiff_t>(16 * i), 16, columns);
        transforms.push_back(transform_from_columns(columns));
        if (!is_finite(transforms.back())) throw reference->error(fmt::format("matrix {} is not finite", i));
    }
    return transforms;
}

void read_joint_weights(const Document& document, Buffers& buffers, const JsonValue& attributes,
                        std::size_t joint_count, MeshShape& shape, Sink& sink) {
    const std::size_t vertices = shape.positions.size();
    std::vector<JointSet> sets;
    for (;;) {
        std::optional<JointSet> set;
        read_or_leave_out(fmt::format("JOINTS_{} of {}", sets.size(), attributes.pointer()), sink,
                          [&] { set = read_set(document, buffers, attributes, sets.size(), joint_count, vertices); });
        if (!set) break;
        sets.push_back(*std::move(set));
    }
    shape.joints_per_vertex = static_cast<uint32_t>(4 * sets.size());
    if (sets.size() == 1) {
        shape.joints = std::move(sets[0].joints);
        shape.weights = std::move(sets[0].weights);
        return;
    }
    buffers.charge(vertices * sets.size() * 4 * (sizeof(uint32_t) + sizeof(float)), attributes);
    for (std::size_t i = 0; i < 4 * vertices; i += 4) {
        for (const JointSet& set : sets) {
            shape.joints.insert(shape.joints.end(),
                                {set.joints[i], set.joints[i + 1], set.joints[i + 2], set.joints[i + 3]});
            shape.weights.insert(shape.weights.end(),
                                 {set.weights[i], set.weights[i + 1], set.weights[i + 2], set.weights[i + 3]});
        }
    }
}

} // namespace pertev::gltf
