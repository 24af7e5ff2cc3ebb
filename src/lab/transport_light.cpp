#include "lab/transport_light.h"

#include <algorithm>

#include <fmt/format.h>

#include "settings/value_names.h"
#include "shading/may_be_specular.h"

namespace pertev {
namespace {

bool has_diffuse_lobe(const Material& material) {
    const bool may_have = material.kind == MaterialKind::Diffuse ||
                          (material.kind == MaterialKind::MetallicRoughness && material.metallic < 1);
    return may_have && max_component(material.base_color) > 0;
}

/// Returns whether all materials are diffuse only. Emitters count as diffuse: their surfaces are diffuse and black.
bool is_all_diffuse(const Scene& scene) {
    return std::ranges::all_of(scene.instances, [&](const Instance& i) {
        const Material& material = scene.materials[i.material];
        return i.is_hidden || material.kind == MaterialKind::Diffuse || material.is_unlit();
    });
}

/// Returns whether point, spot or directional lights shine on mirrors or clear glass.
bool has_caustics_of_points(const Scene& scene) {
    return std::ranges::any_of(scene.lights, [](const Light& l) { return max_component(l.intensity) > 0; }) &&
           std::ranges::any_of(scene.instances,
                               [&](const Instance& i) { return may_be_specular(scene.materials[i.material]); });
}

} // namespace

std::string light_of(const std::string& integrator, const Scene& scene) {
    RenderSettings settings;
    if (!set_integrator(settings, integrator)) return {};
    if (settings.path.light != PathLight::Path) return fmt::format("only the {} light of path", integrator);
    const IntegratorDescriptor& kind = describe(settings.integrator);
    if (has_media(scene) && !kind.has_media) return "a vacuum in place of media";
    if (!kind.light_with_caustics.empty() && has_caustics_of_points(scene))
        return std::string(kind.light_with_caustics);
    const bool is_part = !kind.light_if_not_diffuse.empty() && !is_all_diffuse(scene);
    return std::string(is_part ? kind.light_if_not_diffuse : kind.light);
}

std::string why_no_solution(const Scene& scene) {
    const bool has_diffuse = std::ranges::any_of(scene.instances, [&](const Instance& i) {
        return !i.is_hidden && has_diffuse_lobe(scene.materials[i.material]);
    });
    return has_diffuse ? "" : "only diffuse surfaces have patches, and this scene has none";
}

std::string default_reference_integrator(const Scene& scene) {
    return std::string(name_of(has_caustics_of_points(scene) ? IntegratorKind::Bidirectional : IntegratorKind::Path));
}

std::string light_lacking(const std::string& integrator, const Scene& scene) {
    RenderSettings settings;
    const bool is_known = has_caustics_of_points(scene) && set_integrator(settings, integrator);
    return is_known ? std::string(describe(settings.integrator).lacks) : "";
}

} // namespace pertev
