#pragma once

// Textures of Mitsuba: bitmaps, checkerboards, their products with numbers, and colours of vertices.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "formats/mitsuba/colors.h"
#include "formats/mitsuba/reading.h"

namespace pertev::mitsuba {

class Textures {
public:
    /// `reading` must outlive this object.
    explicit Textures(Reading& reading) : reading_(reading) {}

    /// Returns the colour `name`, or a texture of colours; `missing` without one.
    TextureValue color(Object& object, std::string_view name, ColorUse use, Rgb missing);
    /// Returns the number `name`, or a texture of numbers.
    TextureValue number(Object& object, std::string_view name, float missing);
    /// Returns a texture as one of numbers: of bitmaps the luminance in Mitsuba 3, the mean in 0.6.
    TextureValue number_of(const TextureValue& value) const;
    TextureValue number_of(Object& texture) { return number_of(value_of(texture, ColorUse::Index)); }
    /// Returns the value of an object <texture>; 0.5 after a warning if it is left out.
    TextureValue value_of(Object& texture, ColorUse use);
    /// Returns whether a value since the last call was that of a mesh's vertices.
    bool took_vertex_colors() { return std::exchange(took_vertex_colors_, false); }

private:
    TextureValue read(Object& texture, ColorUse use);
    Object* scaled_by(Object& texture);
    TextureValue bitmap(Object& texture);
    TextureValue checkerboard(Object& texture, ColorUse use);
    void read_placing(Object& texture, TextureRef& ref);

    Reading& reading_;
    bool took_vertex_colors_ = false;
    std::map<std::pair<uint32_t, ColorUse>, TextureValue> known_; // by the object's number
};

} // namespace pertev::mitsuba
