#include "formats/gltf/animations.h"

#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "scene/validate_nodes.h"

namespace pertev::gltf {
namespace {

AnimatedPart part_of(const JsonValue& path) {
    const std::string_view name = path.to_string();
    if (name == "translation") return AnimatedPart::Translation;
    if (name == "rotation") return AnimatedPart::Rotation;
    if (name == "scale") return AnimatedPart::Scale;
    if (name == "weights") return AnimatedPart::Weights;
    throw path.error(fmt::format("\"{}\"; expected translation, rotation, scale or weights", name));
}

Interpolation interpolation_of(const JsonValue& sampler) {
    const std::string name = sampler.string_or("interpolation", "LINEAR");
    if (name == "STEP") return Interpolation::Step;
    if (name == "LINEAR") return Interpolation::Linear;
    if (name == "CUBICSPLINE") return Interpolation::CubicSpline;
    throw sampler.at("interpolation").error(fmt::format("\"{}\"; expected STEP, LINEAR or CUBICSPLINE", name));
}

ElementType element_of(AnimatedPart part) {
    switch (part) {
    case AnimatedPart::Translation:
    case AnimatedPart::Scale:
        return ElementType::Vec3;
    case AnimatedPart::Rotation:
        return ElementType::Vec4;
    case AnimatedPart::Weights:
        return ElementType::Scalar;
    }
    return ElementType::Scalar;
}

bool takes_integers(AnimatedPart part) { return part == AnimatedPart::Rotation || part == AnimatedPart::Weights; }

AnimationChannel read_channel(const Document& document, Buffers& buffers, const JsonValue& source,
                              const std::vector<JsonValue>& samplers, const Scene& scene) {
    const JsonValue target = source.at("target"), reference = source.at("sampler");
    AnimationChannel channel;
    channel.node = document.index_into("nodes", target.at("node"));
    channel.part = part_of(target.at("path"));
    const Node& node = scene.nodes[channel.node];
    if (channel.part == AnimatedPart::Weights && node.morph_weights.empty()) {
        throw target.error(
            fmt::format("the mesh of node {} has no morph targets; expected one that has", channel.node));
    }
    if (channel.part != AnimatedPart::Weights && std::holds_alternative<Transform>(node.pose)) {
        throw target.error(fmt::format("node {} has a matrix; expected translation, rotation and scale", channel.node));
    }
    const uint64_t number = reference.to_unsigned();
    if (number >= samplers.size()) {
        throw reference.error(fmt::format("{}; expected an index into \"samplers\", which has {}", number,
                                          counted(samplers.size(), "element")));
    }
    const JsonValue& sampler = samplers[number];
    channel.interpolation = interpolation_of(sampler);

    const JsonValue input = sampler.at("input"), output = sampler.at("output");
    const Accessor times(document, buffers, input, {ElementType::Scalar});
    const Accessor values(document, buffers, output, {element_of(channel.part)});
    if (times.component_type() != ComponentType::Float) throw input.error("key times are no floats; expected 5126");
    if (values.component_type() != ComponentType::Float && !(takes_integers(channel.part) && values.is_normalized())) {
        throw output.error("the values are neither floats nor, of a rotation or weights, normalized integers");
    }
    const uint64_t a_key = (channel.interpolation == Interpolation::CubicSpline ? 3 : 1) *
                           (channel.part == AnimatedPart::Weights ? node.morph_weights.size() : 1);
    if (times.count() == 0 || values.count() % a_key != 0 || values.count() / a_key != times.count()) {
        throw output.error(fmt::format("{} for {}; expected at least one time and {} a time",
                                       counted(values.count(), "element"), counted(times.count(), "key time"), a_key));
    }
    channel.times = times.read_floats();
    channel.values = values.read_floats();
    return channel;
}

} // namespace

void read_animations(const Document& document, Buffers& buffers, Scene& scene, Messages& messages) {
    for (const JsonValue& source : document.root().elements_of("animations")) {
        Animation animation;
        animation.name = source.string_or("name", "");
        animation.origin = source.pointer();
        buffers.charge(animation.name.size() + animation.origin.size(), source);
        const std::vector<JsonValue> samplers = source.elements_of("samplers");
        std::set<std::pair<uint32_t, AnimatedPart>> taken;
        for (const JsonValue& entry : source.elements_of("channels")) {
            const JsonValue target = entry.at("target");
            if (!target.find("node")) { // the format leaves such to extensions
                messages.note(fmt::format("{}: the channel names no node and is left out", target.place()));
                continue;
            }
            AnimationChannel channel = read_channel(document, buffers, entry, samplers, scene);
            if (!taken.emplace(channel.node, channel.part).second) {
                throw target.error("an earlier channel of the animation has this node and path; expected one");
            }
            if (const std::string fault = fault_of(channel, scene.nodes[channel.node]); !fault.empty()) {
                messages.warn(fmt::format("{}: {}; the channel is left out", entry.place(), fault));
                continue;
            }
            animation.channels.push_back(std::move(channel));
        }
        scene.animations.push_back(std::move(animation));
    }
}

} // namespace pertev::gltf
