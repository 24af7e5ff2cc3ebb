#include "image/tone_map_image.h"

#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {

Rgba8Image tone_map_image(const Image& linear, ToneMap kind, float exposure_stops, bool keep_alpha) {
    PERTEV_CHECK(linear.channels >= 1 && linear.channels <= 4);
    const float scale = exposure_scale(exposure_stops);
    const bool is_grey = linear.channels < 3, has_alpha = keep_alpha && linear.channels % 2 == 0;
    Rgba8Image result{linear.width, linear.height, {}};
    result.pixels.resize(std::size_t(linear.width) * linear.height * 4);
    parallel_for(linear.height, 8, [&](uint64_t y) {
        const float* from = linear.at(0, static_cast<uint32_t>(y));
        uint8_t* to = result.pixels.data() + y * linear.width * 4;
        for (uint32_t x = 0; x < linear.width; ++x, from += linear.channels, to += 4) {
            const Rgb light = is_grey ? grey(from[0]) : Rgb{from[0], from[1], from[2]};
            tone_map_pixel(light, has_alpha ? from[linear.channels - 1] : 1.0f, kind, scale, to);
        }
    });
    return result;
}

} // namespace pertev
