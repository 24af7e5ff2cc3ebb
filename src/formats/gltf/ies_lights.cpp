#include "formats/gltf/ies_lights.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/limits.h"
#include "formats/gltf/attached_bytes.h"
#include "formats/gltf/leave_out.h"
#include "formats/gltf/light.h"
#include "formats/ies/read_ies.h"

namespace pertev::gltf {
namespace {

constexpr const char* kIesLights = "EXT_lights_ies";

/// A profile of the document, read when its first light needs it.
struct Profile {
    std::shared_ptr<const IntensityTable> table;
    float candelas = 0; // where the table is 1
};

class Profiles {
public:
    Profiles(const Document& document, Buffers& buffers, const FileAccess& access, Sink& sink)
        : document_(document), buffers_(buffers), access_(access), sink_(sink) {
        const std::optional<JsonValue> extension = document.root().extension(kIesLights);
        const std::optional<JsonValue> lights = extension ? extension->find("lights") : std::nullopt;
        if (lights) list_ = lights->elements();
    }
    const Profile& at(const JsonValue& reference) {
        const uint64_t index = reference.to_unsigned();
        if (index >= list_.size()) throw reference.error(fmt::format("{}; there are {} profiles", index, list_.size()));
        const auto [entry, is_new] = known_.try_emplace(index);
        if (is_new) entry->second = read(list_[index]);
        if (entry->second.table == nullptr) throw reference.error("its profile cannot be read");
        return entry->second;
    }
    std::string name(const JsonValue& reference) const { return list_[reference.to_unsigned()].string_or("name", ""); }

private:
    Profile read(const JsonValue& source) {
        std::vector<std::byte> owned;
        const std::span<const std::byte> bytes = attached_bytes(document_, buffers_, access_, source, owned, sink_);
        Profile profile;
        profile.table = make_intensity_table(
            parse_ies({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, text_of(source.location()), sink_),
            profile.candelas);
        buffers_.charge(profile.table->values.pixels.size() * sizeof(float), source);
        return profile;
    }

    const Document& document_;
    Buffers& buffers_;
    const FileAccess& access_;
    Sink& sink_;
    std::vector<JsonValue> list_;
    std::map<uint64_t, Profile> known_;
};

Light read_light(const JsonValue& source, Profiles& profiles, Sink& sink) {
    Light light;
    const JsonValue reference = source.at("light");
    const Profile& profile = profiles.at(reference);
    light.kind = LightKind::Goniometric;
    light.table = profile.table;
    light.name = profiles.name(reference);
    float multiplier = 1;
    Rgb color = {1, 1, 1};
    read_member(source, "multiplier", sink, [&](const JsonValue& member) {
        multiplier = member.to_float();
        if (!(multiplier >= 0)) throw member.error(fmt::format("{}; expected at least 0", multiplier));
    });
    read_member(source, "color", sink, [&](const JsonValue& member) {
        const auto c = member.to_floats<3>();
        color = {clamp(c[0], 0.0f, 1.0f), clamp(c[1], 0.0f, 1.0f), clamp(c[2], 0.0f, 1.0f)};
    });
    light.intensity = min(multiplier * profile.candelas, 0x1p120f) * color;
    return light;
}

} // namespace

void place_ies_lights(const Document& document, Buffers& buffers, const FileAccess& access, const NodeGraph& nodes,
                      Scene& scene, Sink& sink) {
    std::optional<Profiles> profiles;
    for (const uint32_t index : nodes.scene_nodes()) {
        const JsonValue& node = document.table("nodes")[index];
        const std::optional<JsonValue> extension = node.extension(kIesLights);
        if (!extension || nodes.is_hidden(index)) continue;
        read_or_leave_out(fmt::format("the light of {}", node.pointer()), sink, [&] {
            if (!profiles) profiles.emplace(document, buffers, access, sink);
            Light light = read_light(*extension, *profiles, sink);
            if (light.name.empty()) light.name = scene.nodes[index].name;
            light.origin = node.pointer();
            light.node = index;
            if (!place_light(nodes.world_from_node(index), light))
                throw node.error("the light's transform is singular");
            if (!(max_component(abs(light.position)) <= kMaxCoordinate))
                throw node.error("the light lies beyond 2^40 metres");
            scene.lights.push_back(std::move(light));
        });
    }
}

} // namespace pertev::gltf
