#include "formats/described/mix_surfaces.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/described/described_medium.h"

namespace pertev::described {
namespace {

using M = MaterialParameters;

constexpr std::string_view kProductOfTextures = "its share is a product of textures";

/// Returns the surface and those beneath it one by one; nothing for an interface.
std::vector<Surface> parts_of(Surface surface) {
    if (surface.is_nothing) return {};
    std::vector<Surface> beneath = std::exchange(surface.beneath, {});
    std::vector<Surface> parts = {std::move(surface)};
    parts.insert(parts.end(), std::move_iterator(beneath.begin()), std::move_iterator(beneath.end()));
    return parts;
}

/// Stacks the other parts beneath the first.
Surface stacked(std::vector<Surface> parts) {
    Surface surface = std::move(parts.front());
    surface.beneath.assign(std::move_iterator(parts.begin() + 1), std::move_iterator(parts.end()));
    return surface;
}

bool is_opaque(const Surface& part) { return part.material.alpha == 1 && !has_alpha_image(part); }

/// A part with the share of rays that meet it.
struct Share {
    Surface part;
    double share;
};
/// Returns the shares of the parts; nothing if they differ from place to place.
std::optional<std::vector<Share>> shares_of(std::vector<Surface> parts, double factor) {
    std::vector<Share> shares;
    for (Surface& part : parts) {
        if (has_alpha_image(part)) return std::nullopt;
        const double here = factor * static_cast<double>(part.material.alpha);
        factor -= here;
        if (here > 0) shares.push_back({std::move(part), here});
    }
    return shares;
}

/// Stacks parts so that each has its share; `missing` is what passes all of them.
Surface stack_by_shares(std::vector<Share> shares, double missing) {
    double rest = missing;
    for (std::size_t i = shares.size(); i-- > 0;) {
        Material& material = shares[i].part.material;
        rest += shares[i].share;
        material.alpha = rest > 0 ? static_cast<float>(shares[i].share / rest) : 1.0f;
        material.alpha_mode = material.alpha < 1 ? AlphaMode::Blend : AlphaMode::Opaque;
    }
    std::vector<Surface> parts;
    for (Share& share : shares) parts.push_back(std::move(share.part));
    return stacked(std::move(parts));
}

/// Returns the share of rays that pass all parts, whose alphas are numbers.
double passed_by(const Surface& surface) {
    double passed = 1 - static_cast<double>(surface.material.alpha);
    for (const Surface& part : surface.beneath) passed *= 1 - static_cast<double>(part.material.alpha);
    return surface.is_nothing ? 1 : passed;
}

std::optional<Surface> mix_by_shares(const Surface& first, const Surface& second, double of_second) {
    std::optional<std::vector<Share>> shares = shares_of(parts_of(first), 1 - of_second);
    std::optional<std::vector<Share>> more = shares_of(parts_of(second), of_second);
    if (!shares || !more) return std::nullopt;
    shares->insert(shares->end(), std::move_iterator(more->begin()), std::move_iterator(more->end()));
    const double missing = (1 - of_second) * passed_by(first) + of_second * passed_by(second);
    return shares->empty() ? first : stack_by_shares(*std::move(shares), missing);
}

/// Puts an opaque surface of one part, by the alpha `share`, over the others.
Surface put_over(Surface top, const TextureValue& share, Surface others) {
    set_alpha(top, share);
    top.beneath = parts_of(std::move(others));
    return top;
}

/// Returns which part has the medium of the shape, because two coincident ones would enclose it twice: the body of
/// glass, or else the first that light enters, or else the first.
uint32_t body_of(std::span<const Surface> parts) {
    const auto body = std::ranges::find_if(parts, [](const Surface& part) { return part.material.encloses(); });
    const auto entered = body != parts.end() ? body : std::ranges::find_if(parts, is_entered);
    return entered == parts.end() ? 0 : static_cast<uint32_t>(entered - parts.begin());
}

std::size_t entered_parts(const Surface& surface) {
    std::size_t count = surface.material.encloses() ? 1 : 0;
    for (const Surface& part : surface.beneath) count += part.material.encloses() ? 1 : 0;
    return count;
}

/// Returns the part with the largest share, one that light enters if there is one.
Surface main_part(const Surface& surface) {
    std::vector<Surface> parts = parts_of(surface);
    std::size_t best = 0;
    float most = -1, passed = 1;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const float alpha = has_alpha_image(parts[i]) ? 0.5f : parts[i].material.alpha;
        const float rank = passed * alpha + (is_entered(parts[i]) ? 1.0f : 0.0f);
        passed *= 1 - alpha;
        if (rank > most) most = rank, best = i;
    }
    Surface part = std::move(parts[best]);
    part.material.alpha = 1;
    part.material.alpha_mode = AlphaMode::Opaque;
    part.material.alpha_texture = {};
    std::erase_if(part.images, [](const SlotImage& use) { return use.slot == &M::alpha_texture; });
    return part;
}

} // namespace

bool has_alpha_image(const Surface& part) {
    return std::ranges::any_of(part.images, [](const SlotImage& use) { return use.slot == &M::alpha_texture; });
}

TextureValue one_less(const TextureValue& value) {
    if (!value.has_image()) return constant(grey(1) - value.factor);
    TextureValue rest = value.scaled(grey(-1));
    rest.offset += grey(1);
    return rest;
}

bool set_opacity(Surface& surface, const TextureValue& opacity) {
    bool has_image = has_alpha_image(surface);
    for (const Surface& part : surface.beneath) has_image = has_image || has_alpha_image(part);
    if (surface.beneath.empty()) {
        set_alpha(surface, opacity);
        return !(has_image && opacity.has_image());
    }
    if (!opacity.has_image()) {
        const auto share = static_cast<double>(clamp(opacity.factor.r, 0.0f, 1.0f));
        const Surface copy = surface;
        if (auto shares = shares_of(parts_of(copy), share); shares && !shares->empty()) {
            surface = stack_by_shares(*std::move(shares), 1 - share * (1 - passed_by(copy)));
            return true;
        }
    }
    for_each_part(surface, [&](Surface& part) { set_alpha(part, opacity); });
    return !opacity.has_image() && (!has_image || opacity.factor.r == 1);
}

MixedSurface mix_surfaces(const Surface& first, const Surface& second, TextureValue of_second) {
    of_second.ignores_alpha = true; // a weight is a colour's
    if (first.is_nothing || second.is_nothing) {
        if (first.is_nothing && second.is_nothing) return {first, std::nullopt, {}};
        Surface surface = first.is_nothing ? second : first;
        if (!set_opacity(surface, first.is_nothing ? of_second : one_less(of_second)))
            return {first.is_nothing ? second : first, first.is_nothing ? 0u : 1u, kProductOfTextures};
        return {surface, std::nullopt, {}};
    }
    const float share = of_second.has_image() ? 0.5f : clamp(of_second.factor.r, 0.0f, 1.0f);
    if (share == 0) return {first, std::nullopt, {}};
    if (share == 1) return {second, std::nullopt, {}};
    if (auto surface = mix_in_one_block(first, second, of_second)) return {*std::move(surface), std::nullopt, {}};
    const auto nearest = [&](std::string_view reason) {
        return MixedSurface{share < 0.5f ? first : second, share < 0.5f ? 1u : 0u, reason};
    };
    if (first.beneath.size() + second.beneath.size() + 2 > kMostMixed) return nearest("a mixture has at most 16 parts");
    if (entered_parts(first) + entered_parts(second) > 1) return nearest("both are bodies that light enters");
    if (first.has_vertex_colors != second.has_vertex_colors) return nearest("only one has the colours of the vertices");
    if (!of_second.has_image()) {
        if (auto surface = mix_by_shares(first, second, static_cast<double>(share)))
            return {*std::move(surface), std::nullopt, {}};
    }
    if (second.beneath.empty() && is_opaque(second)) return {put_over(second, of_second, first), std::nullopt, {}};
    if (first.beneath.empty() && is_opaque(first))
        return {put_over(first, one_less(of_second), second), std::nullopt, {}};
    return nearest(kProductOfTextures);
}

void separate_mixtures(Parts& parts, uint64_t file_bytes, Sink& sink) {
    std::map<std::pair<uint32_t, std::optional<uint32_t>>, uint32_t> first_parts; // by surface and alpha
    std::map<uint32_t, uint32_t> main_parts;
    const auto add = [&](Surface surface) {
        parts.surfaces.push_back(std::move(surface));
        return static_cast<uint32_t>(parts.surfaces.size() - 1);
    };
    std::vector<Placed> placed;
    for (Placed& shape : parts.placed) {
        if (parts.surfaces[shape.surface].beneath.empty()) {
            placed.push_back(std::move(shape));
            continue;
        }
        if (shape.area_light) {
            const auto [known, is_new] = main_parts.try_emplace(shape.surface, 0);
            if (is_new) {
                known->second = add(main_part(parts.surfaces[shape.surface]));
                sink.leave_out({parts.area_lights[*shape.area_light].location,
                                fmt::format("the mixture of materials of a shape that emits light is left out; it is "
                                            "that of {}",
                                            parts.surfaces[known->second].material.name)});
            }
            shape.surface = known->second;
            placed.push_back(std::move(shape));
            continue;
        }
        const auto [known, is_new] = first_parts.try_emplace({shape.surface, shape.alpha}, 0);
        const std::size_t count = parts.surfaces[shape.surface].beneath.size() + 1;
        if (is_new) {
            Surface surface = parts.surfaces[shape.surface];
            if (shape.alpha && !set_opacity(surface, parts.alphas[*shape.alpha]))
                sink.leave_out({parts.meshes[shape.mesh].location,
                                "the alpha of a shape of a mixture of materials is only near, because textures "
                                "decide the shares too"});
            known->second = static_cast<uint32_t>(parts.surfaces.size());
            for (Surface& part : parts_of(std::move(surface))) add(std::move(part));
        }
        shape.alpha.reset();
        const uint32_t body = body_of(std::span(parts.surfaces).subspan(known->second, count));
        for (uint32_t i = 0; i < count; ++i) {
            Placed one = shape;
            one.surface = known->second + i;
            one.layers_above = i;
            if (i != body) one.medium.reset();
            placed.push_back(std::move(one));
        }
    }
    const uint64_t most = max_placed(file_bytes);
    if (placed.size() > most) {
        throw Error(
            ErrorCode::OverLimit, parts.meshes[placed.back().mesh].location,
            fmt::format("mixtures of materials make more than {} instances, the limit for files of this size", most));
    }
    parts.placed = std::move(placed);
}

} // namespace pertev::described
