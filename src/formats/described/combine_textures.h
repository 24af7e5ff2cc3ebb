#pragma once

// Textures that are made of two or three others: products, mixtures, checks. They become one image once all images
// are decoded.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/described/image_budget.h"
#include "formats/described/texture_value.h"
#include "scene/scene.h"

namespace pertev::described {

/// An image to be made: `first` times `second`, or `first` with the share 1 - `amount` and `second` with `amount`.
struct CombinedTexture {
    uint32_t made = 0; // index into Parts::made
    bool is_product = false;
    std::array<TextureValue, 3> parts; // first, second, amount
    TextureRef place;                  // the coordinates of the image
};

/// Returns the texture of a combination, whose image it adds to `made` and to `combined`; nothing if one image cannot
/// show it: parts with different mappings, with borders at different places, or that do not repeat together.
std::optional<TextureValue> combine_textures(const TextureValue& first, const TextureValue& second,
                                             const std::optional<TextureValue>& amount, std::vector<TextureImage>& made,
                                             std::vector<CombinedTexture>& combined);

/// Adds a material to `scene` for each image that the combinations need, so that the loader loads it. Returns how
/// many.
std::size_t request_images(const std::vector<CombinedTexture>& combined, Scene& scene);

/// Takes the last `count` materials of `scene` away again, whose images have been loaded, and makes the images of the
/// combinations, in their order.
void make_combined(std::vector<CombinedTexture>& combined, std::size_t count, ImageBudget& budget,
                   std::vector<TextureImage>& made, Scene& scene);

} // namespace pertev::described
