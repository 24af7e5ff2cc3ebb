#pragma once

// A material of pbrt or Mitsuba as one of Pertev, with what its textures still need once their images are decoded.

#include <array>
#include <compare>
#include <memory>
#include <optional>
#include <vector>

#include "formats/described/image_budget.h"
#include "formats/described/texture_value.h"
#include "scene/material.h"
#include "scene/scene.h"

namespace pertev::described {

/// The changes of an image's texels before a material uses it.
struct ImageChange {
    float exponent = 1;
    std::array<float, 3> factor = {1, 1, 1}, offset = {0, 0, 0};
    Curve curve = Curve::None;
    float amount = 0;
    GreyOf grey_of = GreyOf::Channels;
    bool is_alpha = false;  // the alpha channel counts if it is not 1 everywhere, else the colour
    bool decodes = false;   // numbers are sRGB-encoded; slots decode only colours
    bool is_opaque = false; // the alpha channel is 1, because it is no opacity
    bool is_framed = false; // a frame of one black texel is added around the image
    auto operator<=>(const ImageChange&) const = default;
    bool is_identity() const { return *this == ImageChange(); }
};

using TextureSlot = TextureRef MaterialParameters::*;

struct SlotImage {
    TextureSlot slot = nullptr;
    int32_t made = -1; // index into Parts::made; else the slot has an image of the loader
    ImageChange change;
    std::shared_ptr<const TextureMapping> mapping; // number_mappings() gives it a set of coordinates
    bool operator==(const SlotImage&) const = default;
};

struct Surface {
    Material material;
    bool is_nothing = false;        // an interface between media: light passes
    bool has_vertex_colors = false; // its colour is that of the mesh's vertices
    bool is_one_sided = false;      // its back is black in the file's own renderer
    std::vector<SlotImage> images;
    TextureValue heights; // metres along the normal, if it has an image
    bool has_heights = false;
    std::shared_ptr<const NormalMix> by_normal; // the base colour, by the direction of the surface
    // Further surfaces in the same place, for rays that pass the alpha of this one and of those before them.
    std::vector<Surface> beneath;
};

/// Sets a colour and its texture.
void set_color(Surface& surface, Rgb MaterialParameters::*color, TextureSlot slot, const TextureValue& value,
               Curve curve = Curve::None, float amount = 0);
/// Sets a number and its texture.
void set_number(Surface& surface, float MaterialParameters::*number, TextureSlot slot, const TextureValue& texture,
                Curve curve = Curve::None);
/// Multiplies the alpha of a surface by a number or a texture. Surfaces of alpha 1 stay opaque.
void set_alpha(Surface& surface, const TextureValue& texture);

/// Returns a texel decoded, and as grey as `change` says, before its factor.
std::array<float, 3> linear_texel(const TextureImage& from, std::size_t i, const ImageChange& change, bool decodes);

/// Applies the changes to the images of `scene`, whose materials `surfaces` belong to, one to one. The loader has put
/// its images there. Images that no material uses any more are removed.
void finish_images(const std::vector<const Surface*>& surfaces, std::vector<TextureImage>& made, ImageBudget& budget,
                   Scene& scene);

} // namespace pertev::described
