#pragma once

// Textures of pbrt: images, constants, checkerboards, and their products and mixtures, as far as one image with a
// factor and an offset can express them. What it cannot is left out with a warning.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "formats/pbrt/context.h"
#include "formats/pbrt/parameters.h"
#include "math/rgb.h"
#include "scene/texture.h"

namespace pertev::pbrt {

/// The value of a texture: offset + factor * texel. Without an image it is `factor`.
struct TextureValue {
    Rgb factor = {1, 1, 1}, offset = {0, 0, 0};
    TextureRef ref;     // its image is one of the loader, or kNoImage
    int32_t made = -1;  // or one of Textures::made()
    float exponent = 1; // the gamma of the stored values; applied before factor and offset

    bool has_image() const { return ref.has_image() || made >= 0; }
    /// Returns the same value times `color`.
    TextureValue scaled(Rgb color) const {
        TextureValue value = *this;
        value.factor = color * value.factor;
        value.offset = color * value.offset;
        return value;
    }
};
inline TextureValue constant(Rgb color) {
    TextureValue value;
    value.factor = color;
    return value;
}

class Textures {
public:
    /// `context` outlives it.
    explicit Textures(const Context& context) : context_(context) {}

    /// Reads a statement Texture "name" "kind" "type".
    void define(const std::string& name, const std::string& kind, const std::string& type, Parameters& parameters);

    /// Returns the colour of a parameter, a reflectance or a texture of them.
    TextureValue color(Parameters& parameters, std::string_view name, Rgb missing);
    /// Returns the number of a parameter, or a texture of numbers, which are in all channels.
    TextureValue number(Parameters& parameters, std::string_view name, float missing);
    /// Returns the image with this file's name, as a texture of v upwards.
    TextureValue image_file(const FileLocation& from, const std::string& name);

    /// Images that are not from files.
    std::vector<TextureImage>& made() { return made_; }

private:
    TextureValue look_up(const Parameters& parameters, const Parameter& parameter, Rgb missing);
    TextureValue value_of(const std::string& type, bool is_color, Parameters& parameters);
    TextureValue part(Parameters& parameters, std::string_view name, bool is_color, float missing);
    TextureValue image_map(Parameters& parameters);
    TextureValue checkerboard(bool is_color, Parameters& parameters);
    TextureValue mixture(const TextureValue& a, const TextureValue& b, const TextureValue& amount,
                         const Parameters& parameters);
    void read_mapping(Parameters& parameters, TextureRef& ref);

    const Context& context_;
    std::map<std::string, TextureValue, std::less<>> textures_;
    std::vector<TextureImage> made_;
};

} // namespace pertev::pbrt
