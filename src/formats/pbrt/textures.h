#pragma once

// Textures of pbrt: images, constants, checkerboards, and their products and mixtures, as far as one image with a
// factor and an offset can express them. What it cannot is left out with a warning.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/described/combine_textures.h"
#include "formats/described/parameters.h"
#include "formats/described/texture_value.h"
#include "formats/pbrt/context.h"
#include "math/double_transform.h"
#include "math/rgb.h"
#include "scene/texture.h"

namespace pertev::pbrt {

class Textures {
public:
    /// Images that are not from files are added to `made`, those of several textures also to `combined`. The arguments
    /// must outlive this object.
    Textures(const Context& context, std::vector<TextureImage>& made, std::vector<described::CombinedTexture>& combined)
        : context_(context), made_(made), combined_(combined) {}

    /// Reads a statement Texture "name" "kind" "type" with the present transform.
    void define(const std::string& name, const std::string& kind, const std::string& type,
                const DoubleTransform& world_from_texture, Parameters& parameters);

    /// Returns the colour of a parameter, a reflectance or a texture of them.
    TextureValue color(Parameters& parameters, std::string_view name, Rgb missing);
    /// Returns the number of a parameter, or a texture of numbers, which are in all channels.
    TextureValue number(Parameters& parameters, std::string_view name, float missing);
    /// Returns how many values since the last call depend on the direction of the surface.
    int took_by_normal() { return std::exchange(took_by_normal_, 0); }
    /// Returns the image with this file's name, as a texture of v upwards.
    TextureValue image_file(const FileLocation& from, const std::string& name);

private:
    TextureValue look_up(const Parameters& parameters, const Parameter& parameter, Rgb missing);
    TextureValue value_of(const std::string& type, bool is_color, const DoubleTransform& world_from_texture,
                          Parameters& parameters);
    TextureValue direction_mix(bool is_color, const DoubleTransform& world_from_texture, Parameters& parameters);
    TextureValue part(Parameters& parameters, std::string_view name, bool is_color, float missing);
    TextureValue image_map(const DoubleTransform& world_from_texture, Parameters& parameters);
    TextureValue checkerboard(bool is_color, const DoubleTransform& world_from_texture, Parameters& parameters);
    TextureValue mixture(const TextureValue& a, const TextureValue& b, const TextureValue& amount,
                         const Parameters& parameters);
    void read_mapping(const DoubleTransform& world_from_texture, Parameters& parameters, TextureValue& value);

    const Context& context_;
    std::map<std::string, TextureValue, std::less<>> textures_;
    std::vector<TextureImage>& made_;
    std::vector<described::CombinedTexture>& combined_;
    int took_by_normal_ = 0;
};

} // namespace pertev::pbrt
