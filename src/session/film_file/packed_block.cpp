#include "session/film_file/packed_block.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel_for.h"
#include "session/film_file/packed_plane.h"
#include "session/film_file/packed_sums.h"

namespace pertev {
namespace {

// An element has channels of one size: sums, or if it holds others a single one. Each channel of a block is packed by
// itself, in the shortest way.
enum class ChannelKind : uint8_t { Constant, Planes, Sums, SumsAfterOthers };

std::size_t channel_bytes(std::size_t stride) { return stride % sizeof(FixedSum) == 0 ? sizeof(FixedSum) : stride; }

/// A channel's bytes, element by element.
std::vector<std::byte> channel_of(std::span<const std::byte> elements, std::size_t stride, std::size_t channel) {
    const std::size_t size = channel_bytes(stride);
    std::vector<std::byte> bytes;
    bytes.reserve(elements.size() / stride * size);
    for (std::size_t at = channel * size; at < elements.size(); at += stride) append(elements.subspan(at, size), bytes);
    return bytes;
}

std::vector<FixedSum> as_sums(std::span<const std::byte> bytes) {
    std::vector<FixedSum> sums(bytes.size() / sizeof(FixedSum));
    std::memcpy(sums.data(), bytes.data(), sums.size() * sizeof(FixedSum));
    return sums;
}

std::vector<std::byte> pack_planes(std::span<const std::byte> channel, std::size_t size) {
    std::vector<std::byte> packed, plane(channel.size() / size);
    for (std::size_t k = 0; k < size; ++k) {
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = channel[i * size + k];
        pack_plane(plane, packed);
    }
    return packed;
}

bool take_planes(std::span<const std::byte>& packed, std::size_t size, std::span<std::byte> channel) {
    std::vector<std::byte> plane(channel.size() / size);
    for (std::size_t k = 0; k < size; ++k) {
        if (!take_plane(packed, plane)) return false;
        for (std::size_t i = 0; i < plane.size(); ++i) channel[i * size + k] = plane[i];
    }
    return true;
}

std::vector<std::byte> pack_channel(std::span<const std::byte> elements, std::size_t stride, std::size_t channel) {
    const std::size_t size = channel_bytes(stride);
    const std::vector<std::byte> bytes = channel_of(elements, stride, channel);
    const std::span<const std::byte> first = std::span(bytes).first(size);
    std::vector<std::byte> packed = {std::byte(ChannelKind::Constant)};
    if (std::ranges::equal(std::span(bytes).subspan(size), std::span(bytes).first(bytes.size() - size))) {
        append(first, packed);
        return packed;
    }
    ChannelKind kind = ChannelKind::Planes;
    std::vector<std::byte> shortest = pack_planes(bytes, size);
    const auto take_shorter = [&](ChannelKind other, std::optional<std::vector<std::byte>> candidate) {
        if (candidate && candidate->size() < shortest.size()) shortest = *std::move(candidate), kind = other;
    };
    if (size == sizeof(FixedSum)) {
        const std::vector<FixedSum> sums = as_sums(bytes);
        take_shorter(ChannelKind::Sums, pack_sums(sums, {}));
        if (channel > 0) {
            take_shorter(ChannelKind::SumsAfterOthers,
                         pack_sums(sums, as_sums(channel_of(elements, stride, channel - 1))));
        }
    }
    packed = {std::byte(kind)};
    append(shortest, packed);
    return packed;
}

/// Takes a channel from the front of `packed`. `before` is the channel before; empty for the first.
bool take_channel(std::span<const std::byte>& packed, std::size_t size, std::span<const std::byte> before,
                  std::span<std::byte> channel) {
    if (packed.empty()) return false;
    const auto kind = static_cast<ChannelKind>(packed.front());
    packed = packed.subspan(1);
    if (kind == ChannelKind::Constant) {
        if (packed.size() < size) return false;
        for (std::size_t at = 0; at < channel.size(); at += size)
            std::ranges::copy(packed.first(size), channel.subspan(at).begin());
        packed = packed.subspan(size);
        return true;
    }
    if (kind == ChannelKind::Planes) return take_planes(packed, size, channel);
    const bool is_after = kind == ChannelKind::SumsAfterOthers && !before.empty();
    if (size != sizeof(FixedSum) || (kind != ChannelKind::Sums && !is_after)) return false;
    std::vector<FixedSum> sums(channel.size() / size);
    if (!unpack_sums(packed, is_after ? as_sums(before) : std::vector<FixedSum>(), sums)) return false;
    std::ranges::copy(std::as_bytes(std::span(sums)), channel.begin());
    return true;
}

} // namespace

std::vector<std::byte> pack_block(std::span<const std::byte> elements, std::size_t stride) {
    PERTEV_CHECK(!elements.empty() && elements.size() % stride == 0);
    std::vector<std::vector<std::byte>> channels(stride / channel_bytes(stride));
    parallel_for(channels.size(), 1, [&](uint64_t c) { channels[c] = pack_channel(elements, stride, c); });
    std::vector<std::byte> packed;
    for (const std::vector<std::byte>& channel : channels) append(channel, packed);
    return packed;
}

bool unpack_block(std::span<const std::byte> packed, std::size_t stride, std::span<std::byte> elements) {
    PERTEV_CHECK(!elements.empty() && elements.size() % stride == 0);
    const std::size_t size = channel_bytes(stride), count = elements.size() / stride;
    std::vector<std::byte> before, channel(count * size);
    for (std::size_t first = 0; first < stride; first += size) {
        if (!take_channel(packed, size, before, channel)) return false;
        for (std::size_t i = 0; i < count; ++i) std::memcpy(&elements[i * stride + first], &channel[i * size], size);
        before = channel;
    }
    return packed.empty();
}

std::size_t least_packed_bytes(std::size_t stride) {
    const std::size_t size = channel_bytes(stride), least_of_sums = 4; // two constant planes
    return stride / size * (1 + std::min(size, least_of_sums));
}

} // namespace pertev
