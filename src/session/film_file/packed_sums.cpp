#include "session/film_file/packed_sums.h"

#include <bit>

#include "session/film_file/packed_plane.h"

namespace pertev {
namespace {

constexpr uint32_t kSign = 0x80, kLength = 0x7f;

/// The size of a sum, without its sign.
FixedSum size_of(FixedSum sum) { return sum.high >> 63 != 0 ? -sum : sum; }
/// Number of bits up to the highest that is set; 0 for 0.
uint32_t length_of(FixedSum size) {
    return static_cast<uint32_t>(size.high != 0 ? 64 + std::bit_width(size.high) : std::bit_width(size.low));
}
/// Number of the lowest bit that is set; 0 for 0.
uint32_t lowest_of(FixedSum size) {
    if (size.low != 0) return static_cast<uint32_t>(std::countr_zero(size.low));
    return size.high != 0 ? 64 + static_cast<uint32_t>(std::countr_zero(size.high)) : 0;
}
FixedSum shifted_down(FixedSum x, uint32_t by) {
    if (by == 0) return x;
    if (by >= 64) return {by == 64 ? x.high : x.high >> (by - 64), 0};
    return {x.low >> by | x.high << (64 - by), x.high >> by};
}
FixedSum shifted_up(FixedSum x, uint32_t by) {
    if (by == 0) return x;
    if (by >= 64) return {0, by == 64 ? x.low : x.low << (by - 64)};
    return {x.low << by, x.high << by | x.low >> (64 - by)};
}

/// Bits between the highest and the lowest.
constexpr uint32_t between(uint32_t length, uint32_t lowest) { return length > lowest + 2 ? length - lowest - 2 : 0; }

/// Bits one behind the other, the first ones lowest.
class BitWriter {
public:
    void add(FixedSum bits, uint32_t count) {
        for (uint32_t i = 0; i < count; i += 32) {
            const uint32_t now = count - i < 32 ? count - i : 32;
            waiting_ |= (shifted_down(bits, i).low & ((uint64_t(1) << now) - 1)) << held_;
            for (held_ += now; held_ >= 8; held_ -= 8, waiting_ >>= 8) bytes_.push_back(std::byte(waiting_ & 0xff));
        }
    }
    std::vector<std::byte> bytes() && {
        if (held_ > 0) bytes_.push_back(std::byte(waiting_ & 0xff));
        return std::move(bytes_);
    }

private:
    std::vector<std::byte> bytes_;
    uint64_t waiting_ = 0; // less than 8 bits between calls
    uint32_t held_ = 0;
};

class BitReader {
public:
    explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    /// Takes the next `count` bits, which the bytes must still hold.
    FixedSum take(uint32_t count) {
        FixedSum bits;
        for (uint32_t i = 0; i < count; i += 32) {
            const uint32_t now = count - i < 32 ? count - i : 32;
            for (; held_ < now; held_ += 8) waiting_ |= uint64_t(bytes_[at_++]) << held_;
            bits = bits + shifted_up({waiting_ & ((uint64_t(1) << now) - 1), 0}, i);
            waiting_ >>= now, held_ -= now;
        }
        return bits;
    }
    /// Returns whether all bits but those that fill the last byte, which are 0, have been taken.
    bool is_at_end() const { return at_ == bytes_.size() && waiting_ == 0; }

private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
    uint64_t waiting_ = 0;
    uint32_t held_ = 0;
};

uint32_t length_before(std::span<const FixedSum> before, std::size_t i) {
    return before.empty() ? 0 : length_of(size_of(before[i])) & kLength;
}

} // namespace

std::optional<std::vector<std::byte>> pack_sums(std::span<const FixedSum> sums, std::span<const FixedSum> before) {
    std::vector<std::byte> lengths, lowest;
    BitWriter bits;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const FixedSum size = size_of(sums[i]);
        const uint32_t length = length_of(size), low = lowest_of(size);
        if (length > kLength) return std::nullopt;
        const uint32_t sign = sums[i].high >> 63 != 0 ? kSign : 0;
        lengths.push_back(std::byte(((length - length_before(before, i)) & kLength) | sign));
        lowest.push_back(std::byte(low));
        bits.add(shifted_down(size, low + 1), between(length, low));
    }
    std::vector<std::byte> packed;
    pack_plane(lengths, packed);
    pack_plane(lowest, packed);
    append(std::move(bits).bytes(), packed);
    return packed;
}

bool unpack_sums(std::span<const std::byte>& packed, std::span<const FixedSum> before, std::span<FixedSum> sums) {
    std::vector<std::byte> lengths(sums.size()), lowest(sums.size());
    if (!take_plane(packed, lengths) || !take_plane(packed, lowest)) return false;
    uint64_t count = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const uint32_t length = (uint32_t(lengths[i]) + length_before(before, i)) & kLength, low = uint32_t(lowest[i]);
        if (low >= length && (low != 0 || length != 0)) return false;
        lengths[i] = std::byte((uint32_t(lengths[i]) & kSign) | length);
        count += between(length, low);
    }
    const uint64_t bytes = (count + 7) / 8;
    if (bytes > packed.size()) return false;
    BitReader bits(packed.first(bytes));
    packed = packed.subspan(bytes);
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const uint32_t length = uint32_t(lengths[i]) & kLength, low = uint32_t(lowest[i]);
        FixedSum size = shifted_up(bits.take(between(length, low)), low + 1);
        if (length > 0) size = size + shifted_up({1, 0}, low);
        if (length > low + 1) size = size + shifted_up({1, 0}, length - 1);
        const bool is_negative = (uint32_t(lengths[i]) & kSign) != 0;
        if (is_negative && length == 0) return false;
        sums[i] = is_negative ? -size : size;
    }
    return bits.is_at_end();
}

} // namespace pertev
