#include "formats/mesh/vertex_colors.h"

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "image/srgb.h"

namespace pertev {

void decode_vertex_colors(std::vector<Vec4>& colors, const std::string& file, Sink& sink) {
    constexpr float kMinByte = 2;
    float greatest = 0, greatest_alpha = 0;
    for (const Vec4& c : colors) {
        if (c.w == kNoVertexColor.w) continue;
        greatest = max(max(greatest, c.x), max(c.y, c.z)); // NaN, which is less than nothing, is passed over
        greatest_alpha = max(greatest_alpha, c.w);
    }
    const bool are_bytes = greatest >= kMinByte, is_alpha_byte = greatest_alpha >= kMinByte;
    if (are_bytes) {
        sink.note({FileLocation{file},
                   fmt::format("vertex colours have values up to {}; they are read as 0 to 255", greatest)});
    }
    const auto decode = [&](float value) { return srgb_decode(are_bytes ? value / 255 : value); };
    parallel_for(colors.size(), 1 << 14, [&](uint64_t i) {
        const Vec4 c = colors[i];
        colors[i] = c.w == kNoVertexColor.w
                        ? Vec4{1, 1, 1, 1}
                        : Vec4{decode(c.x), decode(c.y), decode(c.z), is_alpha_byte ? c.w / 255 : c.w};
    });
}

} // namespace pertev
