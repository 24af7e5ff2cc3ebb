// Packed blocks of a film's target: packing is lossless, sizes are near the entropy of the noise, and invalid
// blocks are refused.

#include "session/film_file/packed_block.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "render/fixed_sum.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

using PackedBytes = std::vector<std::byte>;

PackedBytes unpack(const PackedBytes& packed, std::size_t stride, std::size_t size) {
    PackedBytes elements(size);
    CHECK(unpack_block(packed, stride, elements));
    return elements;
}

/// Returns `count` elements of four bytes: a constant, a ramp, a random value and one of two values.
PackedBytes four_kinds(std::size_t count) {
    test::Random random(1);
    PackedBytes elements;
    for (std::size_t i = 0; i < count; ++i) {
        for (const uint32_t value : {7u, uint32_t(i / 64), random.below(256), random.below(2)})
            elements.push_back(std::byte(value));
    }
    return elements;
}

PackedBytes bytes_of(const std::vector<FixedSum>& sums) {
    const auto bytes = std::as_bytes(std::span(sums));
    return {bytes.begin(), bytes.end()};
}

/// Returns sums of `samples` samples brighter than 0.04 of `count` pixels, with three channels and the number of hits.
std::vector<FixedSum> noisy_pixels(std::size_t count, uint32_t samples) {
    test::Random random(2);
    std::vector<FixedSum> sums;
    for (std::size_t i = 0; i < count; ++i) {
        FixedSum pixel[4];
        for (uint32_t s = 0; s < samples; ++s) {
            const float light = random.within(0.1f, 1);
            for (int c = 0; c < 3; ++c) pixel[c] = pixel[c] + to_fixed(light * random.within(0.4f, 0.6f));
            pixel[3] = pixel[3] + to_fixed(1);
        }
        sums.insert(sums.end(), pixel, pixel + 4);
    }
    return sums;
}

} // namespace

TEST_CASE("elements of any size are unpacked to the bytes that were packed") {
    for (const std::size_t count : {4, 8, 12, 4096}) {
        const PackedBytes elements = four_kinds(count);
        for (const std::size_t stride : {1, 4, 8, 16})
            CHECK(unpack(pack_block(elements, stride), stride, elements.size()) == elements);
    }
    test::Random random(3);
    for (const std::size_t stride : {1, 12, 16, 80}) {
        PackedBytes elements(stride * 300);
        for (std::byte& b : elements) b = std::byte(random.below(256));
        CHECK(unpack(pack_block(elements, stride), stride, elements.size()) == elements);
    }
}

TEST_CASE("sums of any sign and size are unpacked to their bits") {
    test::Random random(4);
    std::vector<FixedSum> sums = {{0, 0}, {1, 0}, {0, 1}, {~0ull, ~0ull}, {0, 1ull << 62}, {~0ull, ~0ull >> 1},
                                  {3, 0}, {0, 3}};
    for (int i = 0; i < 4000; ++i) {
        const float size = std::ldexp(random.within(-1, 1), static_cast<int>(random.below(100)) - 60);
        sums.push_back(to_fixed(size) + to_fixed(random.within(-1, 1)));
    }
    for (const std::size_t stride : {16, 32}) {
        const PackedBytes elements = bytes_of(sums);
        CHECK(unpack(pack_block(elements, stride), stride, elements.size()) == elements);
    }
    sums.push_back({0, 1ull << 63}); // the negation of -2^63 overflows
    const PackedBytes elements = bytes_of(sums);
    CHECK(unpack(pack_block(elements, 16), 16, elements.size()) == elements);
}

TEST_CASE("a constant channel takes 17 bytes, noise one byte an element, and other planes less") {
    const std::size_t count = 4096;
    CHECK(pack_block(PackedBytes(64 * count, std::byte(5)), 64).size() == 4 * 17);
    CHECK(pack_block(PackedBytes(12 * count, std::byte(5)), 12).size() == 13);
    const std::size_t packed = pack_block(four_kinds(count), 4).size();
    CHECK(packed > 1 + 2 + (1 + count) + count / 8);               // one bit selects one of two values
    CHECK(packed < 1 + 2 + (1 + count) + count / 8 * 3 / 2 + 120); // a table of codes, and 64 values in order
}

TEST_CASE("noisy sums take five bytes a channel that varies") {
    const std::size_t count = 8192;
    const PackedBytes elements = bytes_of(noisy_pixels(count, 256));
    const PackedBytes packed = pack_block(elements, 64);
    CHECK(packed.size() < 3 * 5 * count);
    CHECK(packed.size() > 3 * 3 * count); // the 24 bits of a float are noise
    CHECK(unpack(packed, 64, elements.size()) == elements);
}

TEST_CASE("unpacking refuses what is not a packed block") {
    const PackedBytes planes = four_kinds(256), sums = bytes_of(noisy_pixels(64, 4));
    for (const auto& [elements, stride] : {std::pair(&planes, std::size_t(4)), {&sums, 64}}) {
        const PackedBytes packed = pack_block(*elements, stride);
        PackedBytes into(elements->size());
        CHECK(packed.size() >= least_packed_bytes(stride));
        for (std::size_t size = 0; size < packed.size(); ++size)
            CHECK(!unpack_block(std::span(packed).first(size), stride, into));
        PackedBytes changed = packed;
        changed.push_back(std::byte(0));
        CHECK(!unpack_block(changed, stride, into));
        changed = packed;
        changed[0] = std::byte(4);
        CHECK(!unpack_block(changed, stride, into));
        changed[0] = std::byte(3); // there is no channel before the first
        CHECK(!unpack_block(changed, stride, into));
        CHECK(!unpack_block(packed, stride, std::span(into).first(into.size() - stride)));
        test::Random random(5);
        for (int i = 0; i < 5000; ++i) { // reads only its memory and does not crash
            PackedBytes damaged = packed;
            damaged[random.below(static_cast<uint32_t>(damaged.size()))] ^= std::byte(1 + random.below(255));
            static_cast<void>(unpack_block(damaged, stride, into));
        }
    }
}
