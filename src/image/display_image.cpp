#include "image/display_image.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "image/tone_map_image.h"

namespace pertev {
namespace {

Rgb displayed(Rgb light, const DisplayTransform& transform, float scale) {
    if (!transform.lut) return tone_map(light, transform.tone_map, scale);
    const bool sees_light = transform.lut_input == LutInput::Light;
    const Rgb shown = (*transform.lut)(sees_light ? scale * light : tone_map(light, transform.tone_map, scale));
    return tone::clamp_to_unit(shown);
}

/// Calls store(pixel, colour, alpha) for each pixel, both in [0, 1].
template <class Store>
void for_each_pixel(const Image& linear, const DisplayTransform& transform, bool keep_alpha, const Store& store) {
    PERTEV_CHECK(linear.channels >= 1 && linear.channels <= 4);
    const float scale = exposure_scale(transform.exposure_stops);
    const bool is_grey = linear.channels < 3, has_alpha = keep_alpha && linear.channels % 2 == 0;
    parallel_for(linear.height, 8, [&](uint64_t y) {
        const float* from = linear.at(0, static_cast<uint32_t>(y));
        for (std::size_t x = 0; x < linear.width; ++x, from += linear.channels) {
            Rgb light = is_grey ? grey(from[0]) : Rgb{from[0], from[1], from[2]};
            const float alpha = has_alpha ? clamp(from[linear.channels - 1], 0.0f, 1.0f) : 1.0f;
            if (alpha > 0 && alpha < 1) light = (1.0f / alpha) * light;
            store(y * linear.width + x, displayed(light, transform, scale), alpha);
        }
    });
}

} // namespace

Rgba8Image display_image(const Image& linear, const DisplayTransform& transform, bool keep_alpha) {
    if (!transform.lut) return tone_map_image(linear, transform.tone_map, transform.exposure_stops, keep_alpha);
    Rgba8Image result{linear.width, linear.height, {}};
    result.pixels.resize(std::size_t(linear.width) * linear.height * 4);
    for_each_pixel(linear, transform, keep_alpha, [&](std::size_t i, Rgb color, float alpha) {
        uint8_t* const to = &result.pixels[4 * i];
        to[0] = to_byte(color.r), to[1] = to_byte(color.g), to[2] = to_byte(color.b), to[3] = to_byte(alpha);
    });
    return result;
}

Rgba16Image display_image_16(const Image& linear, const DisplayTransform& transform, bool keep_alpha) {
    Rgba16Image result{linear.width, linear.height, {}};
    result.pixels.resize(std::size_t(linear.width) * linear.height * 4);
    const auto word = [](float x) { return static_cast<uint16_t>(to_int(65535.0f * x + 0.5f, 0, 65535)); };
    for_each_pixel(linear, transform, keep_alpha, [&](std::size_t i, Rgb color, float alpha) {
        uint16_t* const to = &result.pixels[4 * i];
        to[0] = word(color.r), to[1] = word(color.g), to[2] = word(color.b), to[3] = word(alpha);
    });
    return result;
}

} // namespace pertev
