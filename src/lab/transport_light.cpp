#include "lab/transport_light.h"

#include <algorithm>

#include "settings/value_names.h"

namespace pertev {
namespace {

bool is_smooth(const Material& material) {
    const bool has_mirror = material.kind == MaterialKind::Dielectric || material.kind == MaterialKind::Conductor ||
                            (material.kind == MaterialKind::MetallicRoughness && material.metallic > 0);
    return has_mirror && material.roughness == 0;
}

bool has_diffuse_lobe(const Material& material) {
    const bool may_have = material.kind == MaterialKind::Diffuse ||
                          (material.kind == MaterialKind::MetallicRoughness && material.metallic < 1);
    return may_have && max_component(material.base_color) > 0;
}

/// Returns whether all materials are diffuse only. Emitters count as diffuse: their surfaces are diffuse and black.
bool is_all_diffuse(const Scene& scene) {
    return std::ranges::all_of(scene.instances, [&](const Instance& i) {
        const MaterialKind kind = scene.materials[i.material].kind;
        return i.is_hidden || kind == MaterialKind::Diffuse || kind == MaterialKind::Unlit;
    });
}

/// Returns whether point, spot or directional lights shine on mirrors or clear glass.
bool has_caustics_of_points(const Scene& scene) {
    return std::ranges::any_of(scene.lights, [](const Light& l) { return max_component(l.intensity) > 0; }) &&
           std::ranges::any_of(scene.instances,
                               [&](const Instance& i) { return is_smooth(scene.materials[i.material]); });
}

} // namespace

std::vector<std::string> transport_integrators() {
    std::vector<std::string> names = integrator_names();
    std::erase_if(names, [](const std::string& name) { return name == "direct" || name == "indirect"; });
    return names;
}

std::string light_of(const std::string& integrator, const Scene& scene) {
    RenderSettings settings;
    if (!set_integrator(settings, integrator)) return {};
    switch (settings.integrator) {
    case IntegratorKind::Path:
    case IntegratorKind::Hybrid:
        if (settings.path.light == PathLight::Direct) return "a part of path's: direct light";
        if (settings.path.light == PathLight::Indirect) return "a part of path's: indirect light";
        return has_caustics_of_points(scene) ? "all but LS+D of point lights" : kAllLight;
    case IntegratorKind::Bidirectional:
        return has_caustics_of_points(scene) ? "all but LS+DS+E of point lights" : kAllLight;
    case IntegratorKind::PhotonMap:
        return "all, blurred ever less";
    case IntegratorKind::IrradianceCache:
        return has_caustics_of_points(scene) ? "as path, interpolated between records"
                                             : "all, interpolated between records";
    case IntegratorKind::Radiosity:
        return is_all_diffuse(scene) ? "all, by patches ever smaller" : "L(D*)S*E, by patches ever smaller";
    case IntegratorKind::Light:
        return "L((D|G|S)*(D|G))?E: nothing in mirrors or clear glass";
    case IntegratorKind::Distributed:
        return "L(D|G|S)?(G|S)*E: one bounce off what is rough";
    case IntegratorKind::Whitted:
        return "L(D|G)S*E of point lights; lamps seen";
    case IntegratorKind::Cast:
        return "L(D|G)E of point lights; lamps seen";
    case IntegratorKind::Raster:
    case IntegratorKind::Reyes:
        return "L(D|G)E of point lights, no shadows; lamps seen";
    }
    return {};
}

std::string why_no_solution(const Scene& scene) {
    const bool has_diffuse = std::ranges::any_of(scene.instances, [&](const Instance& i) {
        return !i.is_hidden && has_diffuse_lobe(scene.materials[i.material]);
    });
    return has_diffuse ? "" : "patches are of diffuse surfaces, and this scene has none";
}

std::string default_reference_integrator(const Scene& scene) {
    return has_caustics_of_points(scene) ? "bidirectional" : "path";
}

std::string light_lacking(const std::string& integrator, const Scene& scene) {
    if (!has_caustics_of_points(scene)) return {};
    const std::string caustics = "light of point, spot and directional lights that mirrors or clear glass send on to "
                                 "other surfaces";
    if (integrator == "photon_map") return "sharpness: what its photons tell is blurred";
    return integrator == "bidirectional" ? caustics + ", as mirrors and clear glass show it" : caustics;
}

} // namespace pertev
