#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/make_surface.h"
#include "formats/described/make_texture.h"
#include "formats/files/closest_name.h"
#include "formats/mitsuba/bsdfs.h"
#include "formats/spectra/named_spectra.h"
#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

using M = MaterialParameters;

Rgb usable_index(Rgb index, float least) {
    const auto usable = [&](float x) { return clamp(x, least, 0x1p10f); };
    return {usable(index.r), usable(index.g), usable(index.b)};
}

struct NamedConductor {
    std::string_view name;
    ComplexIndex index;
};
constexpr NamedConductor kConductors[] = {
#include "formats/mitsuba/conductor_table.inl"
};

/// Returns the index of a conductor of this name, or of another measured metal.
std::optional<ComplexIndex> find_conductor(std::string_view name) {
    const auto known = [](std::string_view with) -> std::optional<ComplexIndex> {
        const auto* const found = std::ranges::find(kConductors, with, &NamedConductor::name);
        return found != std::end(kConductors) ? std::optional(found->index) : std::nullopt;
    };
    if (const auto found = known(name)) return found;
    const std::string plain(name.substr(0, name.find('_'))); // NAME_palik
    for (const std::string& other : {plain, plain + "_palik"})
        if (const auto found = known(other)) return found;
    return find_metal_index(plain);
}

/// Returns the text that suggests a name close to an unknown one.
std::string closest_conductor(std::string_view name) {
    std::vector<std::string_view> known;
    for (const NamedConductor& row : kConductors) known.push_back(row.name);
    return did_you_mean(name, known);
}

bool is_grey(Rgb c) { return c.r == c.g && c.g == c.b; }

/// Returns Fresnel's reflectance of a metal at a cosine, of unpolarised light.
float reflectance_of(float eta, float k, float cosine) {
    const float c2 = cosine * cosine, s2 = 1 - c2, e2 = eta * eta, k2 = k * k;
    const float t0 = e2 - k2 - s2, a2b2 = sqrt(t0 * t0 + 4 * e2 * k2), a = sqrt(max(0.5f * (a2b2 + t0), 0.0f));
    const float across = (a2b2 + c2 - 2 * a * cosine) / (a2b2 + c2 + 2 * a * cosine);
    const float t3 = c2 * a2b2 + s2 * s2, t4 = 2 * a * cosine * s2;
    return 0.5f * across * (1 + (t3 - t4) / (t3 + t4));
}
Rgb reflectance_of(const ComplexIndex& index, float cosine) {
    return {reflectance_of(index.eta.r, index.k.r, cosine), reflectance_of(index.eta.g, index.k.g, cosine),
            reflectance_of(index.eta.b, index.k.b, cosine)};
}

} // namespace

Surface Bsdfs::conductor(Object& bsdf) {
    Sink& sink = reading_.sink();
    Parameters& parameters = bsdf.parameters;
    Surface surface = make_surface(MaterialKind::Conductor);
    if (bsdf.type == "roughconductor") read_roughness(bsdf, surface);
    const TextureValue tint = color(bsdf, "specular_reflectance", 1);
    const bool has_index = parameters.contains("eta") || parameters.contains("k");
    const char* const usual = has_index ? "" : reading_.context.is_old ? "Cu" : "none";
    const std::string name = parameters.text("material", usual, sink);
    if (name == "none") { // reflects all
        surface.material.eta = grey(0x1p-10f);
        surface.material.k = grey(4);
        tint_metal(bsdf, tint, surface);
        return surface;
    }
    ComplexIndex index = find_conductor("Cu").value_or(ComplexIndex{});
    if (!name.empty()) {
        const auto found = find_conductor(name);
        if (found) index = *found;
        if (!found)
            sink.leave_out({bsdf.location(), fmt::format("there are no data of the metal {}{}; copper is used",
                                                         shortened(name), closest_conductor(name))});
    }
    if (has_index && !reading_.context.is_old) index = {.eta = grey(0), .k = grey(1)}; // where one is missing
    const float outside = parameters.contains("ext_eta") ? ior_of(bsdf, "ext_eta", 1) : 1.0f;
    const float scale = outside > 0 ? 1 / outside : 1.0f;
    surface.material.eta =
        usable_index(scale * read_color(bsdf, "eta", ColorUse::Index, index.eta, reading_), 0x1p-10f);
    surface.material.k = usable_index(scale * read_color(bsdf, "k", ColorUse::Index, index.k, reading_), 0);
    tint_metal(bsdf, tint, surface);
    return surface;
}

/// Multiplies all that a metal reflects: exactly by a grey.
void Bsdfs::tint_metal(const Object& bsdf, const TextureValue& tint, Surface& surface) {
    Material& material = surface.material;
    const auto made = static_cast<std::size_t>(tint.made);
    const bool is_white = !tint.has_image() && tint.factor == grey(1);
    if (is_white ||
        (tint.made >= 0 ? !has_colors(reading_.parts.made[made]) : !tint.has_image() && is_grey(tint.factor))) {
        set_number(surface, &M::specular_weight, &M::specular_texture, tint);
        return;
    }
    // The reflectance at 0 degrees and at the cosine of 1 / 7, at which F82 has its tint.
    const ComplexIndex index = {material.eta, material.k};
    const Rgb front = reflectance_of(index, 1), edge = reflectance_of(index, 1.0f / 7);
    material.kind = MaterialKind::MetallicRoughness;
    material.metallic = 1;
    set_color(surface, &M::base_color, &M::base_color_texture, tint.scaled(front));
    material.metal_fresnel = MetalFresnel::F82;
    const Rgb mean = tint.has_image() ? grey(0.5f) : tint.factor;
    constexpr float kRise = 0.46266437f; // (6 / 7)^5
    const auto tint_of = [](float t, float at_0, float at_82) {
        const float f0 = t * at_0;
        return clamp(t * at_82 / (f0 + (1 - f0) * kRise), 0.0f, 1.0f);
    };
    material.specular_color = {tint_of(mean.r, front.r, edge.r), tint_of(mean.g, front.g, edge.g),
                               tint_of(mean.b, front.b, edge.b)};
    warn_of_nearest(bsdf, "a metal whose colour is near that of its specular_reflectance");
}

} // namespace pertev::mitsuba
