#include "device_scene/pack_texels.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel_for.h"
#include "image/srgb.h"

namespace pertev {
namespace {

constexpr float kMaxWord = 65535.0f;

/// Packs a value into a half float. Returns false if the format has no such value. The second argument is the channel,
/// 3 for alpha.
bool pack_half(float value, std::size_t, uint16_t& word) {
    const uint32_t bits = bits_of(value), sign = bits >> 16 & 0x8000u;
    const float size = abs(value);
    if (!(size <= 65504.0f)) return false;
    if (size < 0x1p-14f) { // denormal: multiples of 2^-24
        const float multiple = size * 0x1p24f;
        word = static_cast<uint16_t>(sign | static_cast<uint32_t>(multiple));
        return multiple == floor(multiple);
    }
    word = static_cast<uint16_t>(sign | ((bits & 0x7fffffffu) - (112u << 23)) >> 13);
    return (bits & 0x1fffu) == 0;
}

bool pack_unorm(float value, std::size_t, uint16_t& word) {
    if (!(value >= 0 && value <= 1) || std::signbit(value)) return false;
    word = static_cast<uint16_t>(to_int(value * kMaxWord + 0.5f, 0, 65535));
    return static_cast<float>(word) / kMaxWord == value;
}

bool pack_srgb(float value, std::size_t channel, uint16_t& word) {
    if (channel == 3) return pack_unorm(value, channel, word);
    if (!(value >= 0 && value <= 1) || std::signbit(value)) return false;
    const std::span<const float> table = srgb_words_table();
    const auto found = std::ranges::lower_bound(table, value);
    if (found == table.end() || *found != value) return false;
    word = static_cast<uint16_t>(found - table.begin());
    return true;
}

using PackValue = bool (*)(float, std::size_t, uint16_t&);

bool pack_all(std::span<const float> rgba, PackValue pack, std::vector<uint16_t>& words) {
    constexpr std::size_t kFew = 256;
    uint16_t unused = 0;
    for (std::size_t i = 0; i < std::min(kFew, rgba.size()); ++i) { // usually tells without memory
        if (!pack(rgba[i], i % 4, unused)) return false;
    }
    words.resize(rgba.size());
    std::atomic<bool> all = true;
    constexpr std::size_t kTogether = 1 << 14;
    parallel_for((rgba.size() + kTogether - 1) / kTogether, 1, [&](uint64_t block) {
        const std::size_t end = std::min(rgba.size(), (block + 1) * kTogether);
        for (std::size_t i = block * kTogether; i < end && all.load(std::memory_order_relaxed); ++i) {
            if (!pack(rgba[i], i % 4, words[i])) all = false;
        }
    });
    return all;
}

} // namespace

std::span<const float> srgb_words_table() {
    static const std::vector<float> table = [] {
        std::vector<float> values(kSrgbWords);
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = srgb_decode(static_cast<float>(i) / kMaxWord);
        return values;
    }();
    return table;
}

PackedTexels pack_texels(std::span<const float> rgba) {
    PackedTexels packed;
    const auto takes = [&](TexelDepth depth, PackValue pack) {
        if (!pack_all(rgba, pack, packed.words)) return false;
        packed.depth = depth;
        return true;
    };
    if (takes(TexelDepth::Half, pack_half) || takes(TexelDepth::Unorm16, pack_unorm) ||
        takes(TexelDepth::Srgb16, pack_srgb)) {
        return packed;
    }
    packed.words = {};
    return packed;
}

uint64_t texture_bytes(const Scene& scene) {
    uint64_t bytes = 0;
    for (const TextureImage& image : scene.images) {
        const std::vector<float>& floats = image.rgba_float.pixels;
        const bool is_packed = !floats.empty() && pack_texels(floats).depth != TexelDepth::Float;
        bytes += image.rgba8.pixels.size() + floats.size() * (is_packed ? sizeof(uint16_t) : sizeof(float));
    }
    return bytes;
}

} // namespace pertev
