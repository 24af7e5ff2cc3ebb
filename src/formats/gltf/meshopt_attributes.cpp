#include "formats/gltf/meshopt_attributes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pertev::gltf {
namespace {

constexpr std::byte kVersion1{0xa1};
constexpr std::size_t kGroup = 16, kMostInBlock = 256, kMostBytesInBlock = 8192, kLeastTail = 24;
constexpr uint32_t kAllZero = 2, kLiteral = 3; // modes of the control header; the others have lengths of bits

/// Reads bytes up to the tail. A read beyond its end returns zeros and sets `failed`.
struct ByteReader {
    std::span<const std::byte> left;
    bool failed = false;

    std::span<const std::byte> take(std::size_t count) {
        static constexpr std::array<std::byte, kMostInBlock> kZeros{};
        if (count > left.size()) {
            failed = true;
            return std::span(kZeros).first(count);
        }
        const std::span<const std::byte> taken = left.first(count);
        left = left.subspan(count);
        return taken;
    }
};

uint32_t number(std::byte byte) { return std::to_integer<uint32_t>(byte); }

/// Reads the deltas of 16 elements for one byte of each, packed with `bits` bits.
void read_group(ByteReader& reader, uint32_t bits, std::byte* deltas) {
    if (bits == 0) {
        std::fill_n(deltas, kGroup, std::byte{0});
        return;
    }
    const std::span<const std::byte> packed = reader.take(kGroup * bits / 8);
    const uint32_t in_byte = 8 / bits, sentinel = (1u << bits) - 1;
    for (uint32_t i = 0; i < kGroup; ++i) {
        const uint32_t at = i % in_byte, shift = bits == 1 ? at : 8 - bits * (at + 1);
        const uint32_t value = number(packed[i / in_byte]) >> shift & sentinel;
        const bool follows = bits < 8 && value == sentinel;
        deltas[i] = follows ? reader.take(1)[0] : static_cast<std::byte>(value);
    }
}

/// Reads the deltas of `count` elements for one byte of each.
void read_deltas(ByteReader& reader, uint32_t control, std::size_t count, std::byte* deltas) {
    if (control == kAllZero) {
        std::fill_n(deltas, count, std::byte{0});
        return;
    }
    if (control == kLiteral) {
        std::ranges::copy(reader.take(count), deltas);
        return;
    }
    constexpr uint32_t kBits[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 8}};
    const std::size_t groups = (count + kGroup - 1) / kGroup;
    const std::span<const std::byte> header = reader.take((groups + 3) / 4);
    for (std::size_t i = 0; i < groups; ++i) {
        const uint32_t mode = number(header[i / 4]) >> (2 * (i % 4)) & 3;
        read_group(reader, kBits[control][mode], deltas + i * kGroup);
    }
}

template <class Word>
Word zigzag_decoded(Word value) {
    const auto half = static_cast<Word>(value >> 1);
    return (value & 1) != 0 ? static_cast<Word>(~half) : half;
}

/// Adds the deltas of a channel's 4 bytes to the element before, which is then the next one.
void advance(std::byte mode, std::array<std::byte, 4> delta, std::byte* element) {
    if (mode == std::byte{0}) {
        for (std::size_t i = 0; i < 4; ++i) {
            const auto change = zigzag_decoded(static_cast<uint8_t>(delta[i]));
            element[i] = static_cast<std::byte>(number(element[i]) + change);
        }
    } else if (mode == std::byte{1}) {
        for (std::size_t i = 0; i < 4; i += 2) {
            const uint32_t change = zigzag_decoded(static_cast<uint16_t>(number(delta[i]) | number(delta[i + 1]) << 8));
            const uint32_t value = (number(element[i]) | number(element[i + 1]) << 8) + change;
            element[i] = static_cast<std::byte>(value);
            element[i + 1] = static_cast<std::byte>(value >> 8);
        }
    } else {
        uint32_t change = 0;
        for (std::size_t i = 0; i < 4; ++i) change |= number(delta[i]) << (8 * i);
        change = std::rotr(change, static_cast<int>(number(mode) >> 4));
        for (std::size_t i = 0; i < 4; ++i) element[i] ^= static_cast<std::byte>(change >> (8 * i));
    }
}

bool is_mode(std::byte mode) { return number(mode) < 2 || (number(mode) & 15) == 2; }

template <class Component>
void decode_color(std::byte* bytes) {
    using Signed = std::make_signed_t<Component>;
    std::array<Component, 4> color;
    std::memcpy(color.data(), bytes, sizeof color);
    const int luma = color[0], co = static_cast<Signed>(color[1]), cg = static_cast<Signed>(color[2]);
    const uint32_t full = (1u << std::bit_width(uint32_t(color[3]))) - 1; // the first bit of alpha gives the scale
    const uint32_t alpha = color[3] & full >> 1;
    constexpr float kMost = static_cast<Component>(~Component(0));
    const float scale = full > 0 ? kMost / static_cast<float>(full) : 0.0f;
    const auto put = [&](std::size_t i, int value) {
        color[i] = static_cast<Component>(std::clamp(static_cast<float>(value) * scale + 0.5f, 0.0f, kMost));
    };
    put(0, luma + co - cg);
    put(1, luma + cg);
    put(2, luma - co - cg);
    put(3, static_cast<int>(alpha << 1 | (alpha & 1)));
    std::memcpy(bytes, color.data(), sizeof color);
}

} // namespace

bool has_meshopt_version_1(std::span<const std::byte> stream) { return !stream.empty() && stream[0] == kVersion1; }

bool decode_meshopt_attributes(std::span<const std::byte> stream, std::size_t stride, std::span<std::byte> elements) {
    const std::size_t channels = stride / 4, tail = stride + channels;
    if (stream.size() < 1 + std::max(tail, kLeastTail)) return false;
    ByteReader reader{stream.subspan(1, stream.size() - 1 - std::max(tail, kLeastTail))};
    const std::span<const std::byte> first = stream.last(tail).first(stride), modes = stream.last(channels);
    if (!std::ranges::all_of(modes, is_mode)) return false;
    std::vector<std::byte> element(first.begin(), first.end());
    std::vector<std::byte> deltas(stride * kMostInBlock); // [byte of an element][element]
    const std::size_t in_block = std::min(kMostBytesInBlock / stride / kGroup * kGroup, kMostInBlock);
    while (!elements.empty()) {
        const std::size_t count = std::min(elements.size() / stride, in_block);
        const std::span<const std::byte> header = reader.take(channels);
        for (std::size_t i = 0; i < stride; ++i) {
            const uint32_t control = number(header[i / 4]) >> (2 * (i % 4)) & 3;
            read_deltas(reader, control, count, &deltas[i * kMostInBlock]);
        }
        if (reader.failed) return false;
        for (std::size_t k = 0; k < count; ++k) {
            for (std::size_t c = 0; c < channels; ++c) {
                const std::byte* const at = &deltas[4 * c * kMostInBlock + k];
                advance(modes[c], {at[0], at[kMostInBlock], at[2 * kMostInBlock], at[3 * kMostInBlock]},
                        &element[4 * c]);
            }
            std::ranges::copy(element, elements.subspan(k * stride).begin());
        }
        elements = elements.subspan(count * stride);
    }
    return reader.left.empty();
}

void decode_meshopt_colors(std::span<std::byte> colors, std::size_t stride) {
    for (std::size_t i = 0; i + stride <= colors.size(); i += stride) {
        if (stride == 4) {
            decode_color<uint8_t>(&colors[i]);
        } else {
            decode_color<uint16_t>(&colors[i]);
        }
    }
}

} // namespace pertev::gltf
