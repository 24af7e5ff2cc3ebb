#include "formats/mitsuba/bsdfs.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/make_surface.h"
#include "formats/described/mix_surfaces.h"
#include "formats/described/rough_coat.h"
#include "formats/files/closest_name.h"
#include "formats/mitsuba/parse_values.h"
#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

using M = MaterialParameters;

struct Substance {
    std::string_view name;
    float ior;
};
// Source: Mitsuba's documentation (plugin dielectric).
constexpr std::array<Substance, 23> kSubstances = {
    {{"vacuum", 1},         {"helium", 1.000036f},        {"hydrogen", 1.000132f},
     {"air", 1.000277f},    {"carbon dioxide", 1.00045f}, {"water", 1.333f},
     {"acetone", 1.36f},    {"ethanol", 1.361f},          {"carbon tetrachloride", 1.461f},
     {"glycerol", 1.4729f}, {"benzene", 1.501f},          {"silicone oil", 1.52045f},
     {"bromine", 1.661f},   {"water ice", 1.31f},         {"fused quartz", 1.458f},
     {"pyrex", 1.47f},      {"acrylic glass", 1.49f},     {"polypropylene", 1.49f},
     {"bk7", 1.5046f},      {"sodium chloride", 1.544f},  {"amber", 1.55f},
     {"pet", 1.575f},       {"diamond", 2.419f}}};

constexpr std::array<std::string_view, 21> kBsdfTypes = {
    "diffuse",  "roughdiffuse", "conductor",  "roughconductor", "dielectric", "roughdielectric", "thindielectric",
    "plastic",  "roughplastic", "principled", "principledthin", "blendbsdf",  "mixturebsdf",     "mask",
    "twosided", "bumpmap",      "normalmap",  "phong",          "ward",       "coating",         "null"};
constexpr std::array<std::string_view, 8> kOtherBsdfTypes = {"hair",     "measured", "polarizer", "retarder",
                                                             "circular", "irawan",   "hk",        "measured_polarized"};

} // namespace

float find_ior(std::string_view name) {
    const auto* const found = std::ranges::find(kSubstances, name, &Substance::name);
    return found == kSubstances.end() ? 0.0f : found->ior;
}

uint32_t Bsdfs::surface_of(Object& bsdf) {
    if (const auto known = known_.find(bsdf.number); known != known_.end()) return known->second;
    has_two_sides_ = false;
    (void)textures_.took_vertex_colors();
    Surface surface = read(bsdf);
    const bool has_vertex_colors = textures_.took_vertex_colors();
    for_each_part(surface, [&](Surface& part) { part.is_one_sided = has_black_back(part); });
    if (surface.beneath.empty()) { // parts of a mixture have their own
        surface.has_vertex_colors = surface.has_vertex_colors || has_vertex_colors;
        surface.material.name = bsdf.id.empty() ? bsdf.type : bsdf.id;
    }
    surface.material.origin = fmt::format("{}:{}", bsdf.location().file, bsdf.location().line);
    const auto number = static_cast<uint32_t>(reading_.parts.surfaces.size());
    reading_.parts.surfaces.push_back(std::move(surface));
    known_[bsdf.number] = number;
    return number;
}

/// Returns whether a part of a surface that is in no twosided BSDF has a black back.
bool Bsdfs::has_black_back(const Surface& part) const {
    const Material& material = part.material;
    const bool is_black = material.kind == MaterialKind::Diffuse && max_component(material.base_color) == 0;
    const bool has_back = material.kind == MaterialKind::Dielectric || material.transmits() ||
                          material.has_diffuse_transmission() || part.is_nothing;
    return !has_back && !is_black && !has_two_sides_;
}

void Bsdfs::warn_of_nearest(const Object& bsdf, std::string_view nearest) {
    reading_.sink().warn(
        {FileLocation{bsdf.location().file}, fmt::format("BSDFs of the type {} are drawn as {}", bsdf.type, nearest)});
}

Surface Bsdfs::read(Object& bsdf) {
    Sink& sink = reading_.sink();
    try {
        const Depth depth(reading_.depth, bsdf);
        // BSDFs that each name two others could be read exponentially often.
        if (++reads_ > kMostReads + 16 * reading_.objects.size())
            throw Error(ErrorCode::OverLimit, bsdf.location(), "BSDFs contain each other too often");
        const std::string& type = bsdf.type;
        Surface surface = make_surface(MaterialKind::Diffuse);
        const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
            return std::ranges::find(names, type) != names.end();
        };
        if (is_one_of({"diffuse", "roughdiffuse"})) {
            surface = diffuse(bsdf);
        } else if (is_one_of({"twosided"})) {
            surface = nested(bsdf);
            has_two_sides_ = true;
        } else if (is_one_of({"conductor", "roughconductor"})) {
            surface = conductor(bsdf);
        } else if (is_one_of({"dielectric", "roughdielectric", "thindielectric"})) {
            surface = dielectric(bsdf);
        } else if (is_one_of({"plastic", "roughplastic", "pplastic"})) {
            surface = plastic(bsdf);
        } else if (is_one_of({"phong", "ward"})) {
            surface = glossy(bsdf);
        } else if (is_one_of({"principled", "principledthin"})) {
            surface = principled(bsdf);
        } else if (is_one_of({"coating", "roughcoating"})) {
            surface = coating(bsdf);
        } else if (is_one_of({"difftrans"})) {
            surface = transmitter(bsdf);
        } else if (is_one_of({"blendbsdf", "mixturebsdf"})) {
            surface = mixture(bsdf);
        } else if (is_one_of({"mask"})) {
            surface = mask(bsdf);
        } else if (is_one_of({"bumpmap", "normalmap"})) {
            surface = bumpy(bsdf);
        } else if (is_one_of({"null"})) {
            surface.is_nothing = true;
        } else {
            const bool is_known = std::ranges::find(kOtherBsdfTypes, type) != kOtherBsdfTypes.end();
            sink.leave_out(
                {bsdf.location(), fmt::format("BSDFs of the type {} are left out; the surface is grey{}",
                                              shortened(type), is_known ? "" : did_you_mean(type, kBsdfTypes))});
            return surface;
        }
        bsdf.parameters.leave_out_unknown(sink);
        return surface;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink.leave_out(error.remark().and_then("; the surface is grey"));
        return make_surface(MaterialKind::Diffuse);
    }
}

Surface Bsdfs::nested(Object& bsdf) {
    const std::vector<Object*> inner = objects_in(bsdf, "bsdf", reading_);
    if (inner.empty()) throw bsdf.parameters.error(fmt::format("{} has no BSDF in it", bsdf.parameters.what()));
    if (inner.size() > 1)
        reading_.sink().leave_out(
            {bsdf.location(), fmt::format("the second BSDF of {} is left out", bsdf.parameters.what())});
    return read(*inner.front());
}

Surface Bsdfs::diffuse(Object& bsdf) {
    Surface surface = make_surface(MaterialKind::Diffuse);
    set_color(surface, &M::base_color, &M::base_color_texture, color(bsdf, "reflectance", 0.5f));
    if (bsdf.type == "diffuse") return surface;
    const TextureValue alpha = textures_.number(bsdf, "alpha", 0.2f);
    if (alpha.has_image()) bsdf.parameters.leave_out({"alpha"}, "it has no texture", reading_.sink());
    bsdf.parameters.ignore({"use_fast_approx"});
    // The angle of Oren and Nayar is alpha / sqrt(2); that of EON's roughness of 1 is 90 degrees.
    surface.material.base_diffuse_roughness =
        clamp((alpha.has_image() ? 0.2f : alpha.factor.r) * 0.45015816f, 0.0f, 1.0f);
    warn_of_nearest(bsdf, "a rough diffuse surface of EON");
    return surface;
}

float Bsdfs::ior_of(Object& bsdf, const char* name, float missing) {
    const Parameter* const found = bsdf.parameters.find(name);
    if (found == nullptr) return missing;
    if (found->type != ParameterType::String)
        return max_component(read_color(bsdf, name, ColorUse::Index, grey(missing), reading_));
    std::string substance = found->texts.front();
    for (char& c : substance) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (const float ior = find_ior(substance); ior > 0) return ior;
    std::vector<std::string_view> known;
    for (const Substance& row : kSubstances) known.push_back(row.name);
    reading_.sink().leave_out(
        {bsdf.parameters.location_of(*found), fmt::format("there is no index of {}{}; {} is used", shortened(substance),
                                                          did_you_mean(substance, known), missing)});
    return missing;
}

float Bsdfs::relative_ior(Object& bsdf, const char* substance, float least) {
    const float inside = ior_of(bsdf, "int_ior", find_ior(substance)),
                outside = ior_of(bsdf, "ext_ior", find_ior("air"));
    return usable_ior(bsdf, inside / outside, least, find_ior(substance) / find_ior("air"));
}

float Bsdfs::usable_ior(Object& bsdf, float ior, float least, float missing) {
    if (ior >= least && ior <= kMostIor) return ior;
    const float used = least == 1 && ior > 0 && 1 / ior <= kMostIor ? 1 / ior : missing;
    reading_.sink().leave_out(
        {bsdf.location(),
         fmt::format("the index of {} is {} inside over that outside; {} is used", bsdf.parameters.what(), ior, used)});
    return used;
}

void Bsdfs::read_roughness(Object& bsdf, Surface& surface) {
    Parameters& parameters = bsdf.parameters;
    Sink& sink = reading_.sink();
    const std::string distribution = parameters.text("distribution", "beckmann", sink);
    Material& material = surface.material;
    material.microfacet_distribution =
        distribution == "ggx" ? MicrofacetDistribution::Ggx : MicrofacetDistribution::Beckmann;
    constexpr std::array<std::string_view, 4> kDistributions = {"beckmann", "ggx", "phong", "as"};
    if (std::ranges::find(kDistributions, distribution) == kDistributions.end())
        sink.leave_out(
            {bsdf.location(), fmt::format("the distribution {} is left out; beckmann is used{}",
                                          shortened(distribution), did_you_mean(distribution, kDistributions))});
    parameters.ignore({"sample_visible"});
    const TextureValue both = textures_.number(bsdf, "alpha", 0.1f);
    const TextureValue u = parameters.has("alpha_u") ? textures_.number(bsdf, "alpha_u", 0.1f) : both;
    const TextureValue v = parameters.has("alpha_v") ? textures_.number(bsdf, "alpha_v", 0.1f) : both;
    set_roughness(surface, u, v, Curve::RoughnessOfWidth);
    if ((u.has_image() || v.has_image()) && parameters.contains("alpha_u"))
        parameters.leave_out({"alpha_v"}, "anisotropy is ignored for textured roughness", sink);
}

Surface Bsdfs::dielectric(Object& bsdf) {
    Parameters& parameters = bsdf.parameters;
    const bool is_thin = bsdf.type == "thindielectric";
    Surface surface = make_surface(is_thin ? MaterialKind::MetallicRoughness : MaterialKind::Dielectric);
    surface.material.ior = relative_ior(bsdf, "bk7", is_thin ? 1 : kLeastIor);
    surface.material.has_relative_ior = !is_thin; // Mitsuba's interfaces know both their sides
    surface.material.base_color = grey(1);
    if (bsdf.type == "roughdielectric") read_roughness(bsdf, surface);
    if (is_thin) {
        set_thin_pane(surface);
        warn_of_nearest(bsdf, "a thin wall with the same reflectance at 0 degrees");
    }
    const TextureValue transmitted = color(bsdf, "specular_transmittance", 1),
                       reflected = color(bsdf, "specular_reflectance", 1);
    if (is_thin) {
        tint_thin_pane(surface, reflected, transmitted);
        return surface;
    }
    set_color(surface, &M::base_color, &M::base_color_texture, transmitted);
    if (reflected.has_image() || !(reflected.factor == grey(1)))
        parameters.leave_out({"specular_reflectance"}, "the reflectance of glass follows from its index",
                             reading_.sink());
    return surface;
}

Surface Bsdfs::plastic(Object& bsdf) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    surface.material.ior = relative_ior(bsdf, "polypropylene");
    surface.material.roughness = 0;
    if (bsdf.type == "roughplastic") read_roughness(bsdf, surface);
    const TextureValue reflected = color(bsdf, "specular_reflectance", 1);
    const float most = reflected.has_image() ? 1.0f : max_component(reflected.factor);
    surface.material.specular_weight = most;
    if (most > 0) set_color(surface, &M::specular_color, &M::specular_color_texture, reflected.scaled(grey(1 / most)));
    if (reflected.has_image() || !(reflected.factor == grey(1)))
        warn_of_nearest(bsdf, "a coat that lets through what its specular_reflectance takes off, above a darker base");
    set_coated_color(surface, color(bsdf, "diffuse_reflectance", 0.5f), CoatModel::Mitsuba,
                     bsdf.parameters.truth("nonlinear", false, reading_.sink()));
    return surface;
}

Surface Bsdfs::glossy(Object& bsdf) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    Sink& sink = reading_.sink();
    Material& material = surface.material;
    if (bsdf.type == "phong") {
        const TextureValue exponent = textures_.number(bsdf, "exponent", 30);
        if (exponent.has_image()) bsdf.parameters.leave_out({"exponent"}, "it has no texture; 30 is used", sink);
        const float power = exponent.has_image() ? 30.0f : max(exponent.factor.r, 0.0f);
        material.roughness = min(sqrt(sqrt(2 / (power + 2))), 1.0f);
    } else {
        bsdf.parameters.ignore({"variant"});
        read_roughness(bsdf, surface);
    }
    set_color(surface, &M::base_color, &M::base_color_texture, color(bsdf, "diffuse_reflectance", 0.5f));
    // Its reflection is the same at all angles; that of the index of 1.5 is 0.04 at 0 degrees.
    const TextureValue specular = color(bsdf, "specular_reflectance", 0.2f);
    set_color(surface, &M::specular_color, &M::specular_color_texture, specular.scaled(grey(25)));
    warn_of_nearest(bsdf, "a diffuse surface beneath a reflection");
    return surface;
}

Surface Bsdfs::coating(Object& bsdf) {
    Surface surface = nested(bsdf), coat = make_surface(MaterialKind::MetallicRoughness);
    const float ior = relative_ior(bsdf);
    if (bsdf.type == "roughcoating") read_roughness(bsdf, coat);
    const TextureValue absorption = textures_.color(bsdf, "sigma_a", ColorUse::Index, grey(0));
    if (absorption.has_image())
        bsdf.parameters.leave_out({"sigma_a"}, "the absorption of a coat has no texture", reading_.sink());
    const TextureValue thickness = textures_.number(bsdf, "thickness", 1);
    if (thickness.has_image())
        bsdf.parameters.leave_out({"thickness"}, "the thickness of a coat has no texture", reading_.sink());
    const float both_ways = 2 * thickness.factor.r;
    const Rgb depth = both_ways * (absorption.has_image() ? Rgb{} : absorption.factor);
    for_each_part(surface, [&](Surface& part) {
        Material& material = part.material;
        if (material.kind == MaterialKind::Diffuse) {
            material.kind = MaterialKind::MetallicRoughness;
            material.specular_weight = 0;
        }
        material.coat_weight = 1;
        material.coat_ior = ior;
        material.coat_color = {min(exp(-depth.r), 1.0f), min(exp(-depth.g), 1.0f), min(exp(-depth.b), 1.0f)};
        set_coat_roughness(part, coat);
    });
    if (color(bsdf, "specular_reflectance", 1).factor.r != 1)
        bsdf.parameters.leave_out({"specular_reflectance"}, "the reflectance of a coat follows from its index",
                                  reading_.sink());
    warn_of_nearest(bsdf, "a coat of GGX");
    return surface;
}

Surface Bsdfs::transmitter(Object& bsdf) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    surface.material.specular_weight = 0;
    surface.material.diffuse_transmission_weight = 1;
    set_color(surface, &M::diffuse_transmission_color, &M::diffuse_transmission_color_texture,
              color(bsdf, "transmittance", 0.5f));
    return surface;
}

/// Reads a part of a mixture, with a name and vertex colours of its own.
Surface Bsdfs::part(Object& bsdf) {
    (void)textures_.took_vertex_colors();
    Surface surface = read(bsdf);
    if (!surface.beneath.empty()) return surface;
    surface.has_vertex_colors = textures_.took_vertex_colors();
    if (surface.material.name.empty()) surface.material.name = bsdf.id.empty() ? bsdf.type : bsdf.id;
    return surface;
}

/// Mixes a surface with a BSDF of which it has the share `weight`.
Surface Bsdfs::mix(Object& bsdf, const Surface& first, Object& second, const TextureValue& weight) {
    const Surface other = part(second);
    const MixedSurface mixed = mix_surfaces(first, other, weight);
    if (mixed.left_out) {
        const std::string& name = (*mixed.left_out == 0 ? first : other).material.name;
        reading_.sink().leave_out(
            {*mixed.left_out == 0 ? bsdf.location() : second.location(),
             fmt::format("the part {} of {} is left out, because {}", name, bsdf.parameters.what(), mixed.reason)});
    }
    return mixed.surface;
}

Surface Bsdfs::mixture(Object& bsdf) {
    const std::vector<Object*> parts = objects_in(bsdf, "bsdf", reading_);
    Sink& sink = reading_.sink();
    if (parts.size() < 2)
        throw bsdf.parameters.error(fmt::format("{} has fewer than two BSDFs", bsdf.parameters.what()));
    if (bsdf.type == "blendbsdf") {
        TextureValue weight = textures_.number(bsdf, "weight", 0.5f);
        if (!bsdf.parameters.contains("weight")) {
            if (Object* const texture = child_of(bsdf, "texture", reading_)) weight = textures_.number_of(*texture);
        }
        return mix(bsdf, part(*parts[0]), *parts[1], weight);
    }
    const std::vector<double> weights = parse_numbers(bsdf.parameters.text("weights", "", sink));
    if (weights.size() != parts.size())
        throw bsdf.parameters.error(
            fmt::format("{} has {} weights for {} BSDFs", bsdf.parameters.what(), weights.size(), parts.size()));
    Surface surface = part(*parts[0]);
    double sum = weights[0];
    for (std::size_t i = 1; i < parts.size(); ++i) {
        sum += weights[i];
        const float share = sum > 0 ? static_cast<float>(weights[i] / sum) : 0.0f;
        surface = mix(bsdf, surface, *parts[i], constant(grey(share)));
    }
    if (sum >= 0 && sum < 1 - 1e-5) { // the rest of the light is lost
        Surface black = make_surface(MaterialKind::Diffuse);
        black.material.base_color = grey(0);
        black.material.name = "black";
        black.has_vertex_colors = surface.has_vertex_colors;
        surface = mix_surfaces(surface, black, constant(grey(static_cast<float>(1 - sum)))).surface;
    }
    return surface;
}

Surface Bsdfs::mask(Object& bsdf) {
    Surface surface = nested(bsdf);
    TextureValue opacity = textures_.number(bsdf, "opacity", 0.5f);
    if (!bsdf.parameters.contains("opacity")) {
        if (Object* const texture = child_of(bsdf, "texture", reading_)) opacity = textures_.number_of(*texture);
    }
    if (!set_opacity(surface, opacity))
        reading_.sink().leave_out(
            {bsdf.location(), fmt::format("the opacity of {} is only near, because textures decide "
                                          "what is beneath it too",
                                          bsdf.parameters.what())});
    return surface;
}

Surface Bsdfs::bumpy(Object& bsdf) {
    Surface surface = nested(bsdf);
    Sink& sink = reading_.sink();
    std::vector<Object*> maps = objects_in(bsdf, "texture", reading_);
    if (maps.size() != 1) throw bsdf.parameters.error(fmt::format("{} has no texture", bsdf.parameters.what()));
    TextureValue map = textures_.value_of(*maps[0], ColorUse::Index);
    if (!map.has_image()) return surface;
    if (bsdf.type == "normalmap") {
        if (map.made >= 0) {
            sink.leave_out({bsdf.location(), "a map of normals needs an image"});
            return surface;
        }
        map.ref.is_srgb = false;
        if (bsdf.parameters.truth("use_shadowing_function", !reading_.context.is_old, sink))
            sink.warn({FileLocation{bsdf.location().file},
                       "normal maps have no shadowing function, by which Mitsuba's are about 1 % darker"});
        bsdf.parameters.ignore({"flip_invalid_normals"}); // they are turned into view
        for_each_part(surface, [&](Surface& part) { part.material.normal_texture = map.ref; });
        return surface;
    }
    const TextureValue heights =
        textures_.number_of(map).scaled(grey(static_cast<float>(bsdf.parameters.number("scale", 1, sink))));
    for_each_part(surface, [&](Surface& part) { part.heights = heights, part.has_heights = true; });
    return surface;
}

} // namespace pertev::mitsuba
