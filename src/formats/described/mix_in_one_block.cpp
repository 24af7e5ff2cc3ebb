#include <algorithm>
#include <array>

#include "formats/described/mix_surfaces.h"

namespace pertev::described {
namespace {

using M = MaterialParameters;

bool has_image_of(const Surface& surface, TextureSlot slot) {
    return (surface.material.*slot).has_image() ||
           std::ranges::any_of(surface.images, [slot](const SlotImage& use) { return use.slot == slot; });
}

std::vector<float> numbers_of(const TextureRef& ref) {
    const auto choice = [](auto value) { return static_cast<float>(value); };
    return {choice(ref.image),
            choice(ref.wrap_s),
            choice(ref.wrap_t),
            choice(ref.filter),
            choice(ref.uv_set),
            choice(ref.is_srgb),
            choice(ref.channel),
            ref.m00,
            ref.m01,
            ref.m02,
            ref.m10,
            ref.m11,
            ref.m12};
}

/// Returns all that decides what a material looks like.
std::vector<float> numbers_of(const Surface& surface) {
    M m = surface.material;
    std::vector<float> numbers;
    visit_choices(m, [&](auto value, auto&&...) { numbers.push_back(static_cast<float>(value)); });
    for (const bool flag : {m.two_sided_emission, m.double_sided, m.is_clear_boundary, m.has_relative_ior,
                            m.thin_walled, surface.is_nothing, surface.has_vertex_colors, surface.has_heights})
        numbers.push_back(flag ? 1.0f : 0.0f);
    const auto add = [&](const TextureRef& ref) {
        const std::vector<float> more = numbers_of(ref);
        numbers.insert(numbers.end(), more.begin(), more.end());
    };
    visit_parameters(
        m, [&](float value, auto&&...) { numbers.push_back(value); },
        [&](const TextureRef& ref, const char*) { add(ref); });
    if (surface.has_heights) {
        add(surface.heights.ref);
        numbers.insert(numbers.end(),
                       {surface.heights.factor.r, surface.heights.exponent, static_cast<float>(surface.heights.made)});
    }
    return numbers;
}

bool are_equal(const Surface& a, const Surface& b) {
    return numbers_of(a) == numbers_of(b) && a.images == b.images && a.by_normal == b.by_normal;
}

/// Returns a value that goes from `a` to `b` with a weight.
TextureValue between(Rgb a, Rgb b, const TextureValue& weight) {
    if (!weight.has_image()) return constant(lerp(a, b, clamp(weight.factor.r, 0.0f, 1.0f)));
    TextureValue value = weight.scaled(b - a);
    value.offset += a;
    return value;
}

/// A number in which a BSDF is linear if holds(material) is true.
struct LinearNumber {
    float M::*number;
    TextureSlot slot;
    bool (*holds)(const M&);
};
constexpr std::array<LinearNumber, 5> kLinearNumbers = {{
    {&M::coat_weight, &M::coat_texture,
     [](const M& m) { return m.coat_color == grey(1) && !m.coat_color_texture.has_image(); }},
    {&M::metallic, &M::metallic_texture,
     [](const M& m) { return m.kind == MaterialKind::MetallicRoughness && !m.transmits(); }},
    {&M::specular_weight, &M::specular_texture, [](const M& m) { return m.kind == MaterialKind::Conductor; }},
    {&M::transmission_weight, &M::transmission_texture,
     [](const M& m) {
         return m.kind == MaterialKind::MetallicRoughness && m.metallic == 0 && !m.metallic_texture.has_image();
     }},
    {&M::diffuse_transmission_weight, &M::diffuse_transmission_texture,
     [](const M& m) { return m.kind == MaterialKind::MetallicRoughness; }},
}};

bool is_linear_in_color(const M& m) {
    if (m.base_diffuse_roughness > 0) return false; // EON's interreflections are not
    return m.kind == MaterialKind::Diffuse || m.kind == MaterialKind::Dielectric ||
           (m.kind == MaterialKind::MetallicRoughness && m.metallic == 0 && !m.metallic_texture.has_image());
}

/// Makes parameters equal that have no effect on the surface, so that the others can be compared.
void agree_on_unused(Surface& surface, const Surface& other) {
    Material& m = surface.material;
    const Material& n = other.material;
    if (m.kind == MaterialKind::Diffuse && n.kind == MaterialKind::MetallicRoughness) {
        m.kind = n.kind;
        m.specular_weight = 0;
        m.roughness = n.roughness, m.ior = n.ior, m.has_relative_ior = n.has_relative_ior;
        m.microfacet_distribution = n.microfacet_distribution, m.energy = n.energy;
    }
    if (!m.has_coat()) m.coat_roughness = n.coat_roughness, m.coat_ior = n.coat_ior;
    if (!m.has_diffuse_transmission()) m.diffuse_transmission_color = n.diffuse_transmission_color;
}

/// Returns whether a surface is diffuse, may transmit, and has nothing glossy.
bool is_sheet(const Surface& surface) {
    const Material& m = surface.material;
    if (m.base_diffuse_roughness > 0 || m.has_coat() || m.has_fuzz()) return false;
    if (has_image_of(surface, &M::diffuse_transmission_texture)) return false;
    return m.kind == MaterialKind::Diffuse ||
           (m.kind == MaterialKind::MetallicRoughness && m.metallic == 0 && m.specular_weight == 0 &&
            !has_image_of(surface, &M::metallic_texture) && !m.transmits());
}

/// Copies what a sheet reflects or transmits.
void copy_color(const Surface& from, Rgb M::*color, TextureSlot slot, Surface& to) {
    to.material.*color = from.material.*color;
    to.material.*slot = from.material.*slot;
    std::erase_if(to.images, [slot](const SlotImage& use) { return use.slot == slot; });
    for (const SlotImage& use : from.images) {
        if (use.slot == slot) to.images.push_back(use);
    }
}

/// Mixes diffuse surfaces that transmit: one that only reflects with one that only transmits, or two of colours without
/// images.
std::optional<Surface> mix_sheets(const Surface& first, const Surface& second, const TextureValue& of_second) {
    if (!is_sheet(first) || !is_sheet(second)) return std::nullopt;
    constexpr TextureSlot kFar = &M::diffuse_transmission_color_texture, kHere = &M::base_color_texture;
    constexpr Rgb M::*kFarColor = &M::diffuse_transmission_color;
    const auto far_share = [](const Surface& sheet) { return sheet.material.diffuse_transmission_weight; };
    Surface a = first, b = second;
    for (Surface* const sheet : {&a, &b}) {
        sheet->material.kind = MaterialKind::MetallicRoughness;
        sheet->material.specular_weight = 0;
    }
    Surface mixed = b; // it is compared with `a`, whose colours it gets
    copy_color(a, &M::base_color, kHere, mixed);
    copy_color(a, kFarColor, kFar, mixed);
    mixed.material.diffuse_transmission_weight = far_share(a);
    if (!are_equal(a, mixed)) return std::nullopt;
    for (const bool is_swapped : {false, true}) {
        const Surface &reflector = is_swapped ? b : a, &transmitter = is_swapped ? a : b;
        if (far_share(reflector) != 0 || far_share(transmitter) != 1) continue;
        mixed = reflector;
        copy_color(transmitter, kFarColor, kFar, mixed);
        set_number(mixed, &M::diffuse_transmission_weight, &M::diffuse_transmission_texture,
                   is_swapped ? one_less(of_second) : of_second);
        return mixed;
    }
    if (of_second.has_image() || has_image_of(a, kHere) || has_image_of(b, kHere) || has_image_of(a, kFar) ||
        has_image_of(b, kFar))
        return std::nullopt;
    const float share = of_second.factor.r;
    const auto here_of = [&](const Surface& s) { return (1 - far_share(s)) * s.material.base_color; };
    const auto far_of = [&](const Surface& s) { return far_share(s) * s.material.diffuse_transmission_color; };
    const Rgb here = lerp(here_of(a), here_of(b), share), far = lerp(far_of(a), far_of(b), share);
    const float sum = max_component(here) + max_component(far), weight = sum > 0 ? max_component(far) / sum : 0.0f;
    mixed.material.diffuse_transmission_weight = weight;
    mixed.material.base_color = (weight < 1 ? 1 / (1 - weight) : 0.0f) * here;
    mixed.material.diffuse_transmission_color = (weight > 0 ? 1 / weight : 0.0f) * far;
    return mixed;
}

} // namespace

std::optional<Surface> mix_in_one_block(const Surface& first, const Surface& second, const TextureValue& of_second) {
    if (!first.beneath.empty() || !second.beneath.empty()) return std::nullopt;
    Surface a = first, b = second;
    agree_on_unused(a, second);
    agree_on_unused(b, first);
    for (const LinearNumber& linear : kLinearNumbers) {
        if (!linear.holds(a.material) || has_image_of(a, linear.slot) || has_image_of(b, linear.slot)) continue;
        Surface same = b;
        same.material.*linear.number = a.material.*linear.number;
        if (!are_equal(a, same) || a.material.*linear.number == b.material.*linear.number) continue;
        const Rgb from = grey(a.material.*linear.number), to = grey(b.material.*linear.number);
        set_number(same, linear.number, linear.slot, between(from, to, of_second));
        return same;
    }
    constexpr TextureSlot kColors = &M::base_color_texture;
    if (is_linear_in_color(a.material) && !a.by_normal && !has_image_of(a, kColors) && !has_image_of(b, kColors)) {
        Surface same = b;
        same.material.base_color = a.material.base_color;
        if (are_equal(a, same)) {
            set_color(same, &M::base_color, kColors, between(a.material.base_color, b.material.base_color, of_second));
            return same;
        }
    }
    return mix_sheets(first, second, of_second);
}

} // namespace pertev::described
