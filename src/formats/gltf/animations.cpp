#include "formats/gltf/animations.h"

#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "base/sink.h"
#include "formats/files/parse_number.h"
#include "formats/gltf/leave_out.h"
#include "formats/gltf/material_pointers.h"
#include "formats/gltf/repair_keys.h"
#include "scene/validate/validate_parts.h"

namespace pertev::gltf {
namespace {

std::optional<AnimatedPart> part_named(std::string_view path) {
    if (path == "translation") return AnimatedPart::Translation;
    if (path == "rotation") return AnimatedPart::Rotation;
    if (path == "scale") return AnimatedPart::Scale;
    if (path == "weights") return AnimatedPart::Weights;
    return std::nullopt;
}

AnimatedPart part_of(const JsonValue& path) {
    if (const auto part = part_named(path.to_string())) return *part;
    throw path.error(fmt::format("\"{}\"; expected translation, rotation, scale or weights", path.to_string()));
}

Interpolation interpolation_of(const JsonValue& sampler) {
    const std::string name = sampler.string_or("interpolation", "LINEAR");
    if (name == "STEP") return Interpolation::Step;
    if (name == "LINEAR") return Interpolation::Linear;
    if (name == "CUBICSPLINE") return Interpolation::CubicSpline;
    throw sampler.at("interpolation").error(fmt::format("\"{}\"; expected STEP, LINEAR or CUBICSPLINE", name));
}

bool takes_integers(AnimatedPart part) { return part == AnimatedPart::Rotation || part == AnimatedPart::Weights; }

/// The target of a channel: one object, except for a camera or light that several nodes hold.
struct Target {
    AnimatedPart part;
    std::vector<uint32_t> indices;     // AnimationChannel::target
    std::optional<Rgb> factor;         // factor of a light, by which the values are multiplied; the accessor then
                                       // holds...
    bool is_scalar = false;            // ...one number per value and not a colour
    float scale = 1;                   // factor of the values
    std::vector<uint8_t> numbers = {}; // AnimationChannel::numbers
    TextureTransform texture_at_rest = {};
};

ElementType element_of(const Target& target) {
    const bool has_numbers = target.part == AnimatedPart::MaterialNumbers;
    switch (has_numbers ? target.numbers.size() : numbers_of(target.part)) {
    case 2:
        return ElementType::Vec2;
    case 3:
        return ElementType::Vec3;
    case 4:
        return ElementType::Vec4;
    default:
        return ElementType::Scalar;
    }
}

/// Single-number properties of cameras and lights, which are copied or multiplied by `scale`.
struct NumberPart {
    std::string_view path; // beneath the camera or light
    AnimatedPart part;
    float scale;
};
constexpr NumberPart kCameraNumbers[] = {{"/perspective/yfov", AnimatedPart::CameraFov, 1},
                                         {"/orthographic/ymag", AnimatedPart::CameraHeight, 2}};
constexpr NumberPart kLightNumbers[] = {{"/range", AnimatedPart::LightRange, 1},
                                        {"/spot/innerConeAngle", AnimatedPart::LightInnerCone, 1},
                                        {"/spot/outerConeAngle", AnimatedPart::LightOuterCone, 1}};

Target node_target(const Document& document, const JsonValue& json, uint32_t node, AnimatedPart part,
                   const Scene& scene) {
    if (part == AnimatedPart::Weights && scene.nodes[node].morph_weights.empty()) {
        throw json.error(
            fmt::format("the mesh of node {} has no morph targets, so that its weights cannot be animated", node));
    }
    if (part != AnimatedPart::Weights && document.table("nodes")[node].find("matrix")) {
        throw json.error(fmt::format("node {} has a matrix; expected translation, rotation and scale", node));
    }
    return {part, {node}, {}, false};
}

/// Returns the number in a JSON pointer "/before/NUMBER/after" if it is an index below `count`.
std::optional<uint32_t> index_in(std::string_view pointer, std::string_view before, std::string_view after,
                                 std::size_t count) {
    if (!pointer.starts_with(before) || !pointer.ends_with(after) || pointer.size() < before.size() + after.size()) {
        return std::nullopt;
    }
    const std::string_view digits = pointer.substr(before.size(), pointer.size() - before.size() - after.size());
    const std::optional<uint32_t> number = parse_whole_number<uint32_t>(digits);
    return number && *number < count ? number : std::nullopt;
}

/// Indices of the scene's cameras or lights whose node satisfies `holds`.
template <class Held, class Holds>
std::vector<uint32_t> held_by(const std::vector<Held>& all, const Holds& holds) {
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < all.size(); ++i) {
        if (all[i].node != kNoNode && holds(all[i].node)) indices.push_back(i);
    }
    return indices;
}

constexpr std::string_view kVisible = "extensions/KHR_node_visibility/visible";
constexpr std::string_view kNodePaths[] = {"translation", "rotation", "scale", "weights"};
constexpr std::string_view kLights = "/extensions/KHR_lights_punctual/lights/";

std::optional<uint32_t> node_of_pointer(const Document& document, std::string_view pointer, std::string_view path) {
    return index_in(pointer, "/nodes/", fmt::format("/{}", path), document.table("nodes").size());
}

/// Returns the target of a JSON pointer; nothing for a property whose animation is not supported.
std::optional<Target> pointed_at(const Document& document, const JsonValue& json, const Materials& materials,
                                 const Scene& scene) {
    const std::string_view pointer = json.to_string();
    if (const auto material = find_material_pointer(document, pointer)) {
        const std::optional<uint32_t> index = materials.index_of(material->material);
        Target target = {.part = material->part, .scale = material->scale, .numbers = material->numbers};
        target.texture_at_rest = material->texture_at_rest;
        if (!is_of_texture(material->part)) {
            target.is_scalar = material->components == 1;
            if (material->components < material->numbers.size()) target.factor = material->factor;
        }
        if (index) target.indices = {*index};
        return target;
    }
    for (const std::string_view path : kNodePaths) {
        if (const auto node = node_of_pointer(document, pointer, path)) {
            return node_target(document, json, *node, *part_named(path), scene);
        }
    }
    if (const auto node = node_of_pointer(document, pointer, kVisible))
        return Target{.part = AnimatedPart::Visibility, .indices = {*node}};
    const std::vector<JsonValue>& nodes = document.table("nodes");
    const auto holders_of_light = [&](uint32_t number) {
        std::vector<uint32_t> holders = held_by(scene.lights, [&](uint32_t node) {
            const auto held = nodes[node].extension("KHR_lights_punctual");
            return held && document.index_into("lights", held->at("light")) == number;
        });
        // A node may have a light of EXT_lights_ies beside it.
        std::erase_if(holders, [&](uint32_t light) { return parts_of(scene.lights[light].kind).table; });
        return holders;
    };
    for (const NumberPart& property : kCameraNumbers) {
        const auto number = index_in(pointer, "/cameras/", property.path, document.table("cameras").size());
        if (!number) continue;
        std::vector<uint32_t> holders = held_by(scene.cameras, [&](uint32_t node) {
            return document.index_into("cameras", nodes[node].at("camera")) == *number;
        });
        return Target{.part = property.part, .indices = std::move(holders), .scale = property.scale};
    }
    for (const NumberPart& property : kLightNumbers) {
        const auto number = index_in(pointer, kLights, property.path, document.table("lights").size());
        if (number) return Target{.part = property.part, .indices = holders_of_light(*number), .scale = property.scale};
    }
    for (const std::string_view path : {"color", "intensity"}) {
        const auto number = index_in(pointer, kLights, fmt::format("/{}", path), document.table("lights").size());
        if (!number) continue;
        const JsonValue& light = document.table("lights")[*number];
        const std::array<float, 3> color = light.floats_or<3>("color", {1, 1, 1});
        const float intensity = light.float_or("intensity", 1);
        const bool is_scalar = path == "intensity";
        const Rgb factor = is_scalar ? Rgb{color[0], color[1], color[2]} : Rgb{intensity, intensity, intensity};
        return Target{AnimatedPart::LightIntensity, holders_of_light(*number), factor, is_scalar};
    }
    return std::nullopt;
}

/// Returns the target of a channel; nothing, with a message, for a property whose animation is not supported.
std::optional<Target> read_target(const Document& document, const JsonValue& target, const Materials& materials,
                                  const Scene& scene, Sink& sink) {
    if (const auto extension = target.extension("KHR_animation_pointer")) {
        const JsonValue pointer = extension->at("pointer");
        std::optional<Target> found = pointed_at(document, pointer, materials, scene);
        if (!found) {
            sink.leave_out(
                {pointer.location(),
                 fmt::format(
                     "\"{}\" is not animated; expected a node's translation, rotation, scale, weights or "
                     "visibility, a camera's /perspective/yfov or /orthographic/ymag, a light's color, "
                     "intensity, range, /spot/innerConeAngle or /spot/outerConeAngle, or a material's factor or "
                     "KHR_texture_transform",
                     shortened(pointer.to_string()))});
        }
        return found;
    }
    const std::optional<JsonValue> node = target.find("node");
    if (!node) { // the format leaves such to extensions
        sink.leave_out({target.location(), "the channel has no node and is left out"});
        return std::nullopt;
    }
    const uint32_t index = document.index_into("nodes", *node);
    return node_target(document, target, index, part_of(target.at("path")), scene);
}

/// Reads the keys of a channel, without its target.
AnimationChannel read_keys(const Document& document, Buffers& buffers, const JsonValue& reference,
                           const std::vector<JsonValue>& samplers, const Target& target, const Scene& scene) {
    AnimationChannel channel;
    channel.part = target.part;
    channel.numbers = target.numbers;
    channel.texture_at_rest = target.texture_at_rest;
    const uint64_t number = reference.to_unsigned();
    if (number >= samplers.size()) {
        throw reference.error(fmt::format("{}; expected an index into \"samplers\", which has {}", number,
                                          counted(samplers.size(), "element")));
    }
    const JsonValue& sampler = samplers[number];
    channel.interpolation = interpolation_of(sampler);

    const JsonValue input = sampler.at("input"), output = sampler.at("output");
    const Accessor times(document, buffers, input, {ElementType::Scalar});
    const Accessor values(document, buffers, output, {target.is_scalar ? ElementType::Scalar : element_of(target)});
    if (times.component_type() != ComponentType::Float)
        throw input.error("key times are not floats; expected component type 5126");
    const bool is_boolean = channel.part == AnimatedPart::Visibility && values.component_type() == ComponentType::UInt8;
    if (values.component_type() != ComponentType::Float && !is_boolean &&
        !(takes_integers(channel.part) && values.is_normalized())) {
        throw output.error("the values must be floats, normalized integers for a rotation or weights, or unsigned "
                           "bytes for a visibility");
    }
    if (channel.part == AnimatedPart::Visibility) {
        if (channel.interpolation == Interpolation::CubicSpline)
            throw sampler.at("interpolation").error("a visibility has no tangents; expected STEP");
        channel.interpolation = Interpolation::Step;
    }
    const bool has_weights = channel.part == AnimatedPart::Weights;
    const uint64_t a_key = (channel.interpolation == Interpolation::CubicSpline ? 3 : 1) *
                           (has_weights ? scene.nodes[target.indices[0]].morph_weights.size() : 1);
    if (times.count() == 0 || values.count() % a_key != 0 || values.count() / a_key != times.count()) {
        throw output.error(fmt::format("{} for {}; expected at least one key time and {} per time",
                                       counted(values.count(), "element"), counted(times.count(), "key time"), a_key));
    }
    channel.times = times.read_floats();
    channel.values = values.read_floats();
    for (float& value : channel.values) value *= target.scale;
    if (!target.factor) return channel;
    const std::vector<float> read = std::move(channel.values);
    channel.values.clear();
    for (std::size_t i = 0; i < read.size(); i += target.is_scalar ? 1 : 3) {
        const Rgb value = target.is_scalar ? Rgb{read[i], read[i], read[i]} : Rgb{read[i], read[i + 1], read[i + 2]};
        const Rgb light = *target.factor * value;
        channel.values.insert(channel.values.end(), {light.r, light.g, light.b});
    }
    return channel;
}

/// Returns the elements of a member; none, with a warning, if the member is not an array.
std::vector<JsonValue> elements_or_none(const JsonValue& object, std::string_view key, Sink& sink) {
    std::vector<JsonValue> elements;
    read_or_leave_out(fmt::format("{}/{}", object.pointer(), key), sink, [&] { elements = object.elements_of(key); });
    return elements;
}

std::vector<JsonValue> animations_of(const Document& document, Sink& sink) {
    return elements_or_none(document.root(), "animations", sink);
}

/// Returns whether the target is a reflection that solid glass lacks, whose extension has been left out.
bool is_beside_glass(const Target& target, const Scene& scene) {
    if (target.part != AnimatedPart::MaterialNumbers ||
        scene.materials[target.indices[0]].kind != MaterialKind::Dielectric)
        return false;
    const auto is_target = [&](const char* name) { return target.numbers == material_numbers(name); };
    return is_target("specular_weight") || is_target("specular_color") || is_target("specular_retroreflectivity");
}

/// Returns whether the target is the absorption of a solid whose medium has it (KHR_materials_volume_scatter).
bool attenuates_medium(const Target& target, const Scene& scene) {
    if (target.part != AnimatedPart::MaterialNumbers || !scene.materials[target.indices[0]].medium.is_there())
        return false;
    return target.numbers == material_numbers("transmission_depth") ||
           target.numbers == material_numbers("transmission_color");
}

/// Calls inspect(target) for the target of each channel of a playing clip.
template <class Inspect>
void visit_targets(const Document& document, std::span<const Clip> clips, const Inspect& inspect) {
    Sink& unheard = nobody(); // read_animations reports what cannot be read
    auto clip = clips.begin();
    for (const JsonValue& animation : animations_of(document, unheard)) {
        if (!(clip++)->plays) continue;
        for (const JsonValue& channel : elements_or_none(animation, "channels", unheard)) {
            read_or_leave_out(channel, unheard, [&] { inspect(channel.at("target")); });
        }
    }
}

/// Returns the nodes whose property at `path` a channel of a playing clip changes.
std::set<uint32_t> nodes_animated_at(std::string_view path, const Document& document, std::span<const Clip> clips) {
    std::set<uint32_t> nodes;
    visit_targets(document, clips, [&](const JsonValue& target) {
        if (const auto extension = target.extension("KHR_animation_pointer")) {
            const std::string pointer = extension->string_or("pointer", "");
            if (const auto node = node_of_pointer(document, pointer, path)) nodes.insert(*node);
        } else if (const auto node = target.find("node"); node && target.string_or("path", "") == path) {
            nodes.insert(document.index_into("nodes", *node));
        }
    });
    return nodes;
}

} // namespace

std::set<uint32_t> nodes_with_animated_weights(const Document& document, std::span<const Clip> clips) {
    return nodes_animated_at("weights", document, clips);
}

std::set<uint32_t> nodes_with_animated_visibility(const Document& document, std::span<const Clip> clips) {
    return nodes_animated_at(kVisible, document, clips);
}

std::set<std::string> animated_pointers(const Document& document, std::span<const Clip> clips) {
    std::set<std::string> pointers;
    visit_targets(document, clips, [&](const JsonValue& target) {
        const auto extension = target.extension("KHR_animation_pointer");
        if (extension) pointers.insert(extension->string_or("pointer", ""));
    });
    return pointers;
}

void read_animations(const Document& document, Buffers& buffers, const Materials& materials, Scene& scene,
                     Sink& clip_sink) {
    auto clip = scene.clips.begin();
    for (const JsonValue& source : animations_of(document, nobody())) { // errors were reported when clips were chosen
        clip_sink.check();
        PartMessages unreported(clip_sink); // discards messages about clips that do not play
        Sink& sink = clip->plays ? clip_sink : unreported;
        Animation animation;
        animation.name = clip->name;
        animation.origin = source.pointer();
        buffers.charge(animation.name.size() + animation.origin.size(), source);
        const std::vector<JsonValue> samplers = elements_or_none(source, "samplers", sink);
        std::set<std::tuple<uint32_t, AnimatedPart, std::vector<uint8_t>>> taken;
        const auto read_channel = [&](const JsonValue& entry) {
            const JsonValue json = entry.at("target");
            const std::optional<Target> target = read_target(document, json, materials, scene, sink);
            if (!target || target->indices.empty()) return;
            if (is_beside_glass(*target, scene)) {
                sink.leave_out({entry.location(), "solid glass reflects by its index alone; the channel is left out"});
                return;
            }
            if (attenuates_medium(*target, scene)) {
                sink.leave_out({entry.location(), "the attenuation of a volume that scatters does not change; the "
                                                  "channel is left out"});
                return;
            }
            AnimationChannel channel = read_keys(document, buffers, entry.at("sampler"), samplers, *target, scene);
            channel.target = target->indices[0];
            if (const std::string mended = repair_keys(channel, channel.values.size() / channel.times.size());
                !mended.empty()) {
                sink.warn({entry.location(), mended});
            }
            if (const std::string fault = fault_of(channel, scene); !fault.empty()) {
                sink.leave_out({entry.location(), fmt::format("{}; the channel is left out", fault)});
                return;
            }
            if (!taken.emplace(target->indices[0], target->part, target->numbers).second) {
                sink.leave_out(
                    {json.location(),
                     fmt::format(
                         "{}; the channel is left out",
                         target->factor
                             ? "colour and intensity of one light or emission are animated together; only the first "
                               "is played"
                             : "an earlier channel of the animation has this node and path; that one is played")});
                return;
            }
            buffers.charge(channel.values.size() * target->indices.size() * sizeof(float), entry);
            for (const uint32_t index : target->indices) {
                channel.target = index;
                animation.channels.push_back(channel);
            }
        };
        for (const JsonValue& entry : elements_or_none(source, "channels", sink)) {
            read_or_leave_out(entry, sink, [&] { read_channel(entry); });
        }
        clip->end_s = animation.end_s();
        if ((clip++)->plays) scene.animations.push_back(std::move(animation));
    }
}

} // namespace pertev::gltf
