#pragma once

// Mixtures of surfaces. One block of parameters expresses some of them. Any other is several surfaces in one place:
// all but the last have an alpha, by which chance chooses the one that a ray meets (device_scene/accept_hit.h). A
// mixture of BSDFs is the same mixture of what they scatter, so the pictures are those of the mixture.

#include <cstddef>
#include <optional>
#include <string_view>

#include "base/sink.h"
#include "formats/described/parts.h"
#include "formats/described/surface.h"

namespace pertev::described {

/// Parts that the mixtures of one surface have at most.
inline constexpr std::size_t kMostMixed = 16;

struct MixedSurface {
    Surface surface;
    std::optional<std::size_t> left_out; // 0 or 1: of which nothing remains though it has a share
    std::string_view reason;             // says why it is left out
};
/// Mixes two surfaces; `of_second` is the share of the second one. Where neither one block of parameters nor surfaces
/// in one place are the mixture, the result is the surface with the larger share.
MixedSurface mix_surfaces(const Surface& first, const Surface& second, TextureValue of_second);

/// Returns the mixture of two surfaces as one block of parameters; nothing if that cannot express it exactly.
std::optional<Surface> mix_in_one_block(const Surface& first, const Surface& second, const TextureValue& of_second);

bool has_alpha_image(const Surface& part);

/// Returns the share of what is not `value`.
TextureValue one_less(const TextureValue& value);

/// Multiplies the alpha of a surface and of those beneath it by a number or a texture of 0 and 1: all that the surface
/// shows is there with that share.
/// Returns false if that is only near, because shares and opacity both come from textures, or one from a texture and
/// the other is a number between.
bool set_opacity(Surface& surface, const TextureValue& opacity);

/// Calls change(part) for a surface and each that is beneath it.
template <class Change>
void for_each_part(Surface& surface, const Change& change) {
    change(surface);
    for (Surface& part : surface.beneath) change(part);
}

/// Places the surfaces beneath others as shapes of their own. A shape that emits light keeps one of them, with a
/// warning, because light would be sampled on each. Throws Error(OverLimit) for more shapes than files of `file_bytes`
/// justify.
void separate_mixtures(Parts& parts, uint64_t file_bytes, Sink& sink);

} // namespace pertev::described
