#pragma once

// The lobes with most parameters in 36 bytes, the size of the others, because each kernel's BSDF has room for any lobe:
// colours and weights in [0, 1] have 16 bits.

#include <cstdint>

#include "shading/lobes/filmed_lobe.h"
#include "shading/lobes/glass_lobe.h"
#include "shading/lobes/metal_lobe.h"
#include "shading/lobes/unit_pair.h"

namespace pertev {

/// Microfacets and a number in [0, 1].
struct PackedMicrofacets {
    uint32_t width;         // Microfacets::y, at most 1, which leaves the two highest bits for the kinds
    UnitPair wide_and_more; // Microfacets::x, the number
    UnitPair along;         // both components from [-1, 1]

    HD PackedMicrofacets(const Microfacets& widths, float more)
        : width(bits_of(widths.y) | (widths.is_beckmann ? kBeckmann : 0u) | (widths.is_single ? kSingle : 0u)),
          wide_and_more(widths.x, more), along(0.5f + 0.5f * widths.along.x, 0.5f + 0.5f * widths.along.y) {}
    HD Microfacets widths() const {
        const float y = float_of<float>(width & ~(kBeckmann | kSingle));
        const bool is_even = (wide_and_more.bits & 0xffffu) == UnitPair::word_of(y);
        const float x = 2.0f * along.low() - 1.0f, z = 2.0f * along.high() - 1.0f, inv = 1.0f / sqrt(x * x + z * z);
        return {
            is_even ? y : wide_and_more.low(), y, {inv * x, inv * z}, (width & kBeckmann) != 0, (width & kSingle) != 0};
    }
    HD float more() const { return wide_and_more.high(); }
    /// Returns GGX's width, or 0 for others, for smooth and for stretched microfacets.
    HD float even_width() const {
        const float y = float_of<float>(width & ~(kBeckmann | kSingle));
        const bool is_even = (wide_and_more.bits & 0xffffu) == UnitPair::word_of(y) && (width & kBeckmann) == 0;
        return is_even && y >= kSmoothAlpha ? y : 0.0f;
    }

private:
    static constexpr uint32_t kBeckmann = 1u << 31, kSingle = 1u << 30;
};

/// Microfacets and a film, or without one a tint.
struct PackedSurface {
    PackedMicrofacets microfacets; // packed with the film's weight
    uint32_t film_ior, film_thickness;

    HD PackedSurface(const Microfacets& widths, const ThinFilm& film, Rgb tint = {1, 1, 1})
        : microfacets(widths, film.weight), film_ior(bits_of(film.ior)), film_thickness(bits_of(film.thickness)) {
        if (has_film()) return;
        film_ior = UnitPair(tint.r, tint.g).bits;
        film_thickness = UnitPair::word_of(tint.b);
    }
    HD Microfacets widths() const { return microfacets.widths(); }
    HD ThinFilm film() const {
        if (!has_film()) return {};
        return {microfacets.more(), float_of<float>(film_ior), float_of<float>(film_thickness)};
    }
    HD Rgb tint() const {
        if (has_film()) return {1, 1, 1};
        const UnitPair red_green(film_ior);
        return {red_green.low(), red_green.high(), UnitPair(film_thickness).low()};
    }

private:
    HD bool has_film() const { return microfacets.more() > 0; }
};

struct PackedFilmedLobe {
    UnitPair color_rg, color_b_metallic, f0_rg, f0_b_f90;
    PackedSurface surface;

    HD explicit PackedFilmedLobe(const FilmedLobe& lobe)
        : color_rg(lobe.base_color.r, lobe.base_color.g), color_b_metallic(lobe.base_color.b, lobe.metallic),
          f0_rg(lobe.f0.r, lobe.f0.g), f0_b_f90(lobe.f0.b, lobe.f90), surface(lobe.widths, lobe.film, lobe.tint) {}
    HD FilmedLobe unpacked() const {
        return {{color_rg.low(), color_rg.high(), color_b_metallic.low()},
                color_b_metallic.high(),
                surface.widths(),
                {f0_rg.low(), f0_rg.high(), f0_b_f90.low()},
                f0_b_f90.high(),
                surface.film(),
                surface.tint()};
    }
};

struct PackedGlassLobe {
    UnitPair tint_rg, tint_b_weight;
    float ior, spread;
    PackedSurface surface;

    HD explicit PackedGlassLobe(const GlassLobe& lobe)
        : tint_rg(lobe.tint.r, lobe.tint.g), tint_b_weight(lobe.tint.b, lobe.weight), ior(lobe.ior),
          spread(lobe.spread), surface(lobe.widths, lobe.film) {}
    HD GlassLobe unpacked() const {
        return {{tint_rg.low(), tint_rg.high(), tint_b_weight.low()},
                tint_b_weight.high(),
                surface.widths(),
                ior,
                surface.film(),
                spread};
    }
};

struct PackedMetalLobe {
    Rgb eta, k;
    PackedMicrofacets microfacets; // packed with 1 - weight

    HD explicit PackedMetalLobe(const MetalLobe& lobe)
        : eta(lobe.eta), k(lobe.k), microfacets(lobe.widths, 1.0f - lobe.weight) {}
    HD MetalLobe unpacked() const { return {eta, k, microfacets.widths(), 1.0f - microfacets.more()}; }
};

static_assert(sizeof(PackedFilmedLobe) == 36 && sizeof(PackedGlassLobe) <= 36 && sizeof(PackedMetalLobe) == 36);

} // namespace pertev
