#pragma once

// The lobes with most parameters in 36 bytes, the size of the others, because each kernel's BSDF has room for any lobe:
// colours and weights in [0, 1] have 16 bits. 0 and 1 are exact.

#include <cstdint>

#include "shading/lobes/filmed_lobe.h"
#include "shading/lobes/glass_lobe.h"

namespace pertev {

/// Two numbers in [0, 1].
struct UnitPair {
    uint32_t bits;

    HD UnitPair(float low, float high) : bits(word_of(low) | word_of(high) << 16) {}
    HD float low() const { return number_of(bits & 0xffffu); }
    HD float high() const { return number_of(bits >> 16); }
    HD static uint32_t word_of(float x) { return static_cast<uint32_t>(to_int(65535.0f * x + 0.5f, 0, 65535)); }

private:
    HD static float number_of(uint32_t word) { return static_cast<float>(word) * (1.0f / 65535.0f); }
};

/// Widths and film, with a weight of the film.
struct PackedSurface {
    float width;            // GgxWidths::y
    UnitPair wide_and_film; // GgxWidths::x, ThinFilm::weight
    UnitPair along;         // both components from [-1, 1]
    float film_ior, film_thickness;

    HD PackedSurface(const GgxWidths& widths, const ThinFilm& film)
        : width(widths.y), wide_and_film(widths.x, film.weight),
          along(0.5f + 0.5f * widths.along.x, 0.5f + 0.5f * widths.along.y), film_ior(film.ior),
          film_thickness(film.thickness) {}
    HD GgxWidths widths() const {
        const bool is_even = (wide_and_film.bits & 0xffffu) == UnitPair::word_of(width);
        const float x = 2.0f * along.low() - 1.0f, y = 2.0f * along.high() - 1.0f, inv = 1.0f / sqrt(x * x + y * y);
        return {is_even ? width : wide_and_film.low(), width, {inv * x, inv * y}};
    }
    HD ThinFilm film() const { return {wide_and_film.high(), film_ior, film_thickness}; }
};

struct PackedFilmedLobe {
    UnitPair color_rg, color_b_metallic, f0_rg, f0_b_f90;
    PackedSurface surface;

    HD explicit PackedFilmedLobe(const FilmedLobe& lobe)
        : color_rg(lobe.base_color.r, lobe.base_color.g), color_b_metallic(lobe.base_color.b, lobe.metallic),
          f0_rg(lobe.f0.r, lobe.f0.g), f0_b_f90(lobe.f0.b, lobe.f90), surface(lobe.widths, lobe.film) {}
    HD FilmedLobe unpacked() const {
        return {{color_rg.low(), color_rg.high(), color_b_metallic.low()},
                color_b_metallic.high(),
                surface.widths(),
                {f0_rg.low(), f0_rg.high(), f0_b_f90.low()},
                f0_b_f90.high(),
                surface.film()};
    }
};

struct PackedGlassLobe {
    UnitPair tint_rg, tint_b_weight;
    float ior;
    PackedSurface surface;

    HD explicit PackedGlassLobe(const GlassLobe& lobe)
        : tint_rg(lobe.tint.r, lobe.tint.g), tint_b_weight(lobe.tint.b, lobe.weight), ior(lobe.ior),
          surface(lobe.widths, lobe.film) {}
    HD GlassLobe unpacked() const {
        return {{tint_rg.low(), tint_rg.high(), tint_b_weight.low()},
                tint_b_weight.high(),
                surface.widths(),
                ior,
                surface.film()};
    }
};

static_assert(sizeof(PackedFilmedLobe) == 36 && sizeof(PackedGlassLobe) <= 36);

} // namespace pertev
