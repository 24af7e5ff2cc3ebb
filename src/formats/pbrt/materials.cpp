#include "formats/pbrt/materials.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/make_texture.h"
#include "formats/described/mix_surfaces.h"
#include "formats/described/rough_coat.h"
#include "formats/files/closest_name.h"
#include "formats/pbrt/colors.h"
#include "formats/pbrt/media.h"
#include "math/portable_math.h"

namespace pertev::pbrt {
namespace {

constexpr float kSubsurfaceIor = 1.33f;

using M = MaterialParameters;

/// Sets an index of at least `least`. That of a solid is over that of what is outside, as pbrt's is.
void set_ior(const MaterialSource& source, std::string_view name, float Material::*to, Surface& surface,
             float least = 1, float missing = 1.5f) {
    const std::optional<GlassIndex> index = glass_index(source.parameters, name, source.context);
    surface.material.*to = usable_ior(index ? index->ior : missing, least, missing, source);
    surface.material.has_relative_ior = surface.material.kind == MaterialKind::Dielectric;
    if (index && index->abbe_number > 0 && to == static_cast<float Material::*>(&M::ior)) {
        surface.material.transmission_dispersion_scale = 1;
        surface.material.transmission_dispersion_abbe_number = index->abbe_number;
    }
}

struct StatedRoughness {
    TextureValue u, v;
    Curve curve;
};

/// Reads the roughness along u and v with the curve that converts it.
StatedRoughness stated_roughness(const MaterialSource& source, double missing, std::string_view prefix) {
    struct Names {
        const char *both, *u, *v;
    };
    const Names names =
        prefix == "interface."   ? Names{"interface.roughness", "interface.uroughness", "interface.vroughness"}
        : prefix == "conductor." ? Names{"conductor.roughness", "conductor.uroughness", "conductor.vroughness"}
                                 : Names{"roughness", "uroughness", "vroughness"};
    Sink& sink = source.context.sink;
    const auto fallback = static_cast<float>(missing);
    const TextureValue both = source.textures.number(source.parameters, names.both, fallback);
    const auto part = [&](const char* name) {
        return source.parameters.has(name) ? source.textures.number(source.parameters, name, fallback) : both;
    };
    const TextureValue u = part(names.u), v = part(names.v);
    const bool is_remapped = source.parameters.truth("remaproughness", true, sink);
    const Curve curve = !is_remapped                  ? Curve::RoughnessOfWidth
                        : source.context.is_version_3 ? Curve::RoughnessOfVersion3
                                                      : Curve::RoughnessOfRoot;
    if ((u.has_image() || v.has_image()) && source.parameters.has(names.u) && source.parameters.has(names.v))
        source.parameters.leave_out({names.v}, "anisotropy is ignored for textured roughness", sink);
    return {u, v, curve};
}

Rgb usable_index(Rgb index, float least) {
    const auto usable = [&](float x) { return clamp(x, least, 0x1p10f); };
    return {usable(index.r), usable(index.g), usable(index.b)};
}

/// Sets the complex index of a conductor from eta and k, or from its reflectance at 0 degrees, as pbrt does.
void set_conductor(const MaterialSource& source, std::string_view prefix, Surface& surface) {
    const std::string eta_name = std::string(prefix) + "eta", k_name = std::string(prefix) + "k";
    Material& material = surface.material;
    material.kind = MaterialKind::Conductor;
    const bool is_conductor = prefix.empty();
    const char* const eta_text = is_conductor ? "eta" : "conductor.eta";
    const char* const k_text = is_conductor ? "k" : "conductor.k";
    if (source.parameters.has("reflectance")) {
        source.parameters.leave_out({"eta", "k", "conductor.eta", "conductor.k"}, "its reflectance decides",
                                    source.context.sink);
        const TextureValue color = source.textures.color(source.parameters, "reflectance", grey(0.5f));
        if (color.has_image()) {
            material.kind = MaterialKind::MetallicRoughness;
            material.metallic = 1;
            set_color(surface, &M::base_color, &M::base_color_texture, color);
            warn_of_nearest(source, "a metal of this colour by Schlick's formula");
            return;
        }
        const auto k_of = [](float r) {
            r = clamp(r, 0.0f, 0.9999f);
            return 2 * sqrt(r / (1 - r));
        };
        material.eta = {1, 1, 1};
        material.k = {k_of(color.factor.r), k_of(color.factor.g), k_of(color.factor.b)};
        return;
    }
    const ComplexIndex copper = find_metal_index("Cu").value_or(ComplexIndex{});
    for (const char* const name : {eta_text, k_text}) {
        const Parameter* const found = source.parameters.find(name);
        if (found != nullptr && found->type == ParameterType::Texture) {
            source.parameters.leave_out({name}, "textures of it are not supported; that of copper is used",
                                        source.context.sink);
            material.eta = copper.eta, material.k = copper.k;
            return;
        }
    }
    material.eta =
        usable_index(index_of_channels(source.parameters, eta_text, source.context).value_or(copper.eta), 0x1p-10f);
    material.k = usable_index(index_of_channels(source.parameters, k_text, source.context).value_or(copper.k), 0);
}

Surface diffuse(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Diffuse);
    set_color(surface, &M::base_color, &M::base_color_texture,
              source.textures.color(source.parameters, "reflectance", grey(0.5f)));
    return surface;
}

/// Leaves out what Pertev's coats do not have.
void leave_out_coat_parts(const MaterialSource& source) {
    Parameters& parameters = source.parameters;
    parameters.ignore({"maxdepth", "nsamples", "thickness", "interface.thickness"});
    if (const auto albedo = plain_color(parameters, "albedo", source.context); albedo && !is_black(*albedo))
        parameters.leave_out({"albedo"}, "coats scatter nothing inside", source.context.sink);
    parameters.ignore({"g"});
}

Surface coated_diffuse(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    set_ior(source, "eta", &Material::ior, surface);
    surface.material.transmission_dispersion_scale = 0;
    read_roughness(source, 0, "", surface);
    set_coated_color(surface, source.textures.color(source.parameters, "reflectance", grey(0.5f)), CoatModel::Pbrt,
                     true);
    leave_out_coat_parts(source);
    return surface;
}

Surface coated_conductor(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Conductor);
    set_conductor(source, "conductor.", surface);
    read_roughness(source, 0, "conductor.", surface);
    Surface coat = make_surface(MaterialKind::MetallicRoughness);
    read_roughness(source, 0, "interface.", coat);
    set_coat_roughness(surface, coat);
    surface.material.coat_weight = 1;
    set_ior(source, "interface.eta", &Material::coat_ior, surface);
    leave_out_coat_parts(source);
    return surface;
}

Surface dielectric(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Dielectric);
    surface.material.base_color = grey(1);
    set_ior(source, "eta", &Material::ior, surface, kLeastIor);
    read_roughness(source, 0, "", surface);
    return surface;
}

Surface thin_dielectric(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    Material& material = surface.material;
    set_ior(source, "eta", &Material::ior, surface);
    material.transmission_dispersion_scale = 0;
    set_thin_pane(surface);
    source.parameters.ignore({"roughness", "remaproughness"});
    warn_of_nearest(source, "a thin wall with the same reflectance at 0 degrees");
    return surface;
}

Surface diffuse_transmission(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    Material& material = surface.material;
    const auto scale = static_cast<float>(source.parameters.number("scale", 1, source.context.sink));
    const TextureValue here = source.textures.color(source.parameters, "reflectance", grey(0.25f)).scaled(grey(scale));
    const TextureValue far = source.textures.color(source.parameters, "transmittance", grey(0.25f)).scaled(grey(scale));
    const float reflected = here.has_image() ? 0.5f : max_component(here.factor);
    const float transmitted = far.has_image() ? 0.5f : max_component(far.factor);
    const float weight = reflected + transmitted > 0 ? transmitted / (reflected + transmitted) : 0.0f;
    material.metallic = 0;
    material.specular_weight = 0;
    material.diffuse_transmission_weight = weight;
    const auto over = [](float share) { return grey(share > 0 ? 1 / share : 0.0f); };
    set_color(surface, &M::base_color, &M::base_color_texture, here.scaled(over(1 - weight)));
    set_color(surface, &M::diffuse_transmission_color, &M::diffuse_transmission_color_texture,
              far.scaled(over(weight)));
    return surface;
}

} // namespace

Surface read_subsurface(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Dielectric);
    surface.material.base_color = grey(1);
    surface.material.ior = kSubsurfaceIor;
    surface.material.has_relative_ior = true;
    if (source.parameters.has("eta")) set_ior(source, "eta", &Material::ior, surface, kLeastIor, kSubsurfaceIor);
    surface.material.transmission_dispersion_scale = 0;
    read_glass_roughness(source, surface);
    surface.material.medium = read_subsurface_medium(source);
    return surface;
}

namespace {

Surface nothing() {
    Surface surface;
    surface.is_nothing = true;
    return surface;
}

/// Mixes two materials as mix_surfaces() does.
Surface mixture(const MaterialSource& source) {
    const Parameter* const names = source.parameters.find("materials");
    std::vector<std::string> parts;
    if (names != nullptr) parts = names->texts;
    for (const char* const name : {"namedmaterial1", "namedmaterial2"}) { // pbrt-v3
        if (source.parameters.has(name)) parts.push_back(source.parameters.text(name, "", source.context.sink));
    }
    TextureValue amount = source.textures.color(source.parameters, "amount", grey(0.5f));
    if (parts.size() != 2) throw source.parameters.error("a mix needs two materials");
    const FileLocation& location = source.parameters.location();
    const Surface* first = source.find(parts[0], location);
    const Surface* second = source.find(parts[1], location);
    if (first == nullptr || second == nullptr) {
        const Surface* const left = first != nullptr ? first : second;
        if (left == nullptr) throw source.parameters.error("a mix of two materials that do not exist");
        return *left;
    }
    // In pbrt-v4 `amount` is the share of the second; in v3 it is that of the first.
    const Rgb c = amount.factor;
    if (!amount.has_image() && !(c.r == c.g && c.g == c.b)) {
        source.context.sink.leave_out({location, "the colour of the amount of a mix is left out; its mean counts"});
        amount = constant(grey((c.r + c.g + c.b) / 3));
    }
    if (names != nullptr) amount = as_number(amount); // that of version 3 is a colour
    const MixedSurface mixed = mix_surfaces(*first, *second, names == nullptr ? one_less(amount) : amount);
    if (mixed.left_out)
        source.context.sink.leave_out({location, fmt::format("of the mix the material {} is left out, because {}",
                                                             shortened(parts[*mixed.left_out]), mixed.reason)});
    return mixed.surface;
}

/// A measured material as a diffuse one.
Surface measured(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Diffuse);
    const TextureValue color = source.textures.color(source.parameters, "reflectance", grey(0.5f));
    set_color(surface, &M::base_color, &M::base_color_texture, color);
    warn_of_nearest(source, "a diffuse surface");
    for (const std::string_view name : {"filename", "fname"}) source.parameters.ignore({name});
    return surface;
}

constexpr std::array<std::string_view, 12> kMaterialTypes = {
    "diffuse", "coateddiffuse", "coatedconductor", "conductor",  "dielectric", "thindielectric", "diffusetransmission",
    "mix",     "interface",     "measured",        "subsurface", "hair"};

std::optional<Surface> read_version_4_material(const MaterialSource& source) {
    const std::string& type = source.type;
    if (type == "diffuse") return diffuse(source);
    if (type == "coateddiffuse") return coated_diffuse(source);
    if (type == "coatedconductor") return coated_conductor(source);
    if (type == "conductor") {
        Surface surface = make_surface(MaterialKind::Conductor);
        set_conductor(source, "", surface);
        read_roughness(source, 0, "", surface);
        return surface;
    }
    if (type == "dielectric") return dielectric(source);
    if (type == "thindielectric") return thin_dielectric(source);
    if (type == "diffusetransmission") return diffuse_transmission(source);
    if (type == "mix") return mixture(source);
    if (type == "interface" || type == "none" || type.empty()) return nothing();
    if (type == "measured") return measured(source);
    if (type == "subsurface" && !source.context.is_version_3) return read_subsurface(source);
    return std::nullopt;
}

} // namespace

float usable_ior(float ior, float least, float missing, const MaterialSource& source) {
    if (ior >= least && ior <= kMostIor) return ior;
    const bool is_index = ior >= kLeastIor && ior <= kMostIor;
    const float used = is_index ? least : missing;
    source.context.sink.leave_out(
        {source.parameters.location(),
         fmt::format("the index of refraction of {} is {}; {} is used", source.parameters.what(), ior, used)});
    return used;
}

void warn_of_nearest(const MaterialSource& source, std::string_view nearest) {
    source.context.sink.warn({FileLocation{source.parameters.location().file},
                              fmt::format("materials of the type {} are drawn as {}", source.type, nearest)});
}

void read_roughness(const MaterialSource& source, double missing, std::string_view prefix, Surface& surface) {
    const StatedRoughness stated = stated_roughness(source, missing, prefix);
    set_roughness(surface, stated.u, stated.v, stated.curve);
}

void read_glass_roughness(const MaterialSource& source, Surface& surface) {
    StatedRoughness stated = stated_roughness(source, 0, "");
    const auto may_be_0 = [](const TextureValue& value) { return value.has_image() || value.factor.r == 0; };
    // pbrt-v3 looks for 0 before it remaps.
    if (stated.curve == Curve::RoughnessOfVersion3 && may_be_0(stated.u) && may_be_0(stated.v))
        stated.curve = Curve::RoughnessOfGlass3;
    set_roughness(surface, stated.u, stated.v, stated.curve);
}

void read_bumps(const MaterialSource& source, Surface& surface) {
    Sink& sink = source.context.sink;
    for (const char* const name : {"displacement", "bumpmap"}) {
        if (!source.parameters.has(name)) continue;
        TextureValue heights = source.textures.number(source.parameters, name, 0);
        if (!heights.has_image()) continue; // a constant height changes nothing
        if (std::exchange(heights.mapping, nullptr) != nullptr)
            sink.leave_out({source.parameters.location(), "the mapping of a displacement is left out; uv is used"});
        if (std::exchange(heights.is_framed, false))
            sink.leave_out(
                {source.parameters.location(), "the black around a displacement is left out; its edge continues"});
        surface.heights = heights;
        surface.has_heights = true;
    }
    const std::string map = source.parameters.text("normalmap", "", sink);
    if (map.empty()) return;
    TextureValue normals = source.textures.image_file(source.parameters.location(), map);
    normals.ref.is_srgb = false;
    if (normals.has_image()) surface.material.normal_texture = normals.ref;
}

Surface read_material(const MaterialSource& source) {
    const std::string& type = source.type;
    Sink& sink = source.context.sink;
    (void)source.textures.took_by_normal();
    try {
        std::optional<Surface> surface = read_version_4_material(source);
        if (!surface) {
            Context of_version_3 = source.context;
            of_version_3.is_version_3 = true;
            surface = read_version_3_material({type, source.parameters, source.textures, of_version_3, source.find});
        }
        if (surface) {
            if (type != "mix") read_bumps(source, *surface); // a mix has those of its parts
            if (source.textures.took_by_normal() > (surface->by_normal ? 1 : 0))
                sink.leave_out({source.parameters.location(),
                                "the direction of a directionmix is left out of all but base colours; both are mixed "
                                "evenly"});
            source.parameters.leave_out_unknown(sink);
            return *std::move(surface);
        }
        std::vector<std::string_view> known(kMaterialTypes.begin(), kMaterialTypes.end());
        known.insert(known.end(), version_3_materials().begin(), version_3_materials().end());
        const bool is_known = std::ranges::find(known, type) != known.end();
        sink.leave_out(
            {source.parameters.location(), fmt::format("materials of the type {} are left out; the surface is grey{}",
                                                       shortened(type), is_known ? "" : did_you_mean(type, known))});
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink.leave_out(error.remark().and_then("; the surface is grey"));
    }
    return make_surface(MaterialKind::Diffuse);
}

} // namespace pertev::pbrt
