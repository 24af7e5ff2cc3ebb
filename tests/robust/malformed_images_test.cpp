// No damaged file may crash a reader, let it hang, or let it allocate memory that the file's size does not justify.
// The result is an Error that names the file, or a picture. Inputs are the public collection of malformed files, and
// every kind of picture truncated at each length and with flipped bits.

#include <doctest/doctest.h>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "base/limits.h"
#include "base/read_file.h"
#include "image/check_image_size.h"
#include "image/decode_image.h"
#include "image/read_exr.h"
#include "image/read_image.h"
#include "image/write_exr.h"
#include "image/write_hdr.h"
#include "image/write_jpeg.h"
#include "image/write_png.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

enum class Outcome { Picture, Refused };

// Any result except a whole picture or an Error of the expected kind fails the test.
Outcome try_to_decode(std::span<const std::byte> bytes) {
    const auto start = std::chrono::steady_clock::now();
    Outcome outcome = Outcome::Picture;
    try {
        const Image image = read_image(bytes, "damaged");
        CHECK(image.pixels.size() == std::size_t(image.width) * image.height * image.channels);
        CHECK(image.width > 0);
        CHECK(image.height > 0);
    } catch (const Error& error) {
        const bool is_about_the_file = error.code() == ErrorCode::BadInput || error.code() == ErrorCode::OverLimit;
        CHECK(is_about_the_file);
        CHECK(std::string(error.what()).starts_with("damaged: "));
        outcome = Outcome::Refused;
    }
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
    return outcome;
}

// Returns the peak memory of this process so far, in bytes. With AddressSanitizer it is meaningless, because freed
// memory is kept.
uint64_t peak_memory() {
#if defined(__SANITIZE_ADDRESS__)
    return 0;
#endif
    rusage usage = {};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

struct Sample {
    const char* name;
    std::vector<std::byte> bytes;
};

std::vector<Sample> samples() {
    Rgba8Image bytes{24, 10, {}};
    Image floats{24, 10, 3, {}};
    for (uint32_t i = 0; i < 240; ++i) {
        for (uint32_t c = 0; c < 4; ++c) bytes.pixels.push_back(static_cast<uint8_t>(i * (c + 1)));
        for (uint32_t c = 0; c < 3; ++c) floats.pixels.push_back(static_cast<float>(i / 7 * (c + 1)));
    }
    return {{"png", encode_png(bytes, true)},
            {"jpg", encode_jpeg(bytes)},
            {"hdr", encode_hdr(floats)},
            {"exr", encode_exr(floats, {}, {{"comment", "text"}})}};
}

uint64_t next_random(uint64_t& state) { // splitmix64
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

} // namespace

TEST_CASE("every file of the malformed collection is refused by name, quickly and in little memory") {
    const uint64_t before = peak_memory();
    for (const char* kind : {"png", "jpg", "exr", "hdr"}) {
        const auto folder = test::test_scene(std::filesystem::path("malformed") / kind);
        if (!folder) return;
        for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
            CAPTURE(entry.path().string());
            const std::vector<std::byte> bytes = read_file(entry.path());
            CHECK(try_to_decode(bytes) == Outcome::Refused);
            if (std::string(kind) == "exr") CHECK_THROWS_AS(read_exr(bytes, "damaged"), Error);
        }
    }
    CHECK(peak_memory() - before < uint64_t(128) << 20);
}

TEST_CASE("a truncated picture is refused") {
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        REQUIRE(try_to_decode(sample.bytes) == Outcome::Picture);
        for (std::size_t left = 0; left < sample.bytes.size(); ++left) {
            CAPTURE(left);
            // The bytes are copied, so that a sanitizer detects reads beyond the end.
            const std::vector<std::byte> cut(sample.bytes.begin(),
                                             sample.bytes.begin() + static_cast<std::ptrdiff_t>(left));
            CHECK(try_to_decode(cut) == Outcome::Refused);
        }
    }
}

TEST_CASE("pictures with a few flipped bits or replaced bytes end in an error or a picture, in little memory") {
    const uint64_t before = peak_memory();
    uint64_t state = 1;
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        for (uint64_t round = 0; round < test::effort(1500, 100'000); ++round) {
            CAPTURE(round);
            std::vector<std::byte> bytes = sample.bytes;
            const uint64_t edits = 1 + next_random(state) % 4;
            for (uint64_t k = 0; k < edits; ++k) {
                // Half of the changes are in the header, which has the sizes.
                const std::size_t range =
                    next_random(state) % 2 == 0 ? std::min<std::size_t>(bytes.size(), 340) : bytes.size();
                const std::size_t at = next_random(state) % range;
                const uint64_t how = next_random(state);
                if (how % 3 == 0)
                    bytes[at] = std::byte{0xff};
                else if (how % 3 == 1)
                    bytes[at] = std::byte{0};
                else
                    bytes[at] ^= static_cast<std::byte>(1u << (how / 3 % 8));
            }
            try_to_decode(bytes);
        }
    }
    CHECK(peak_memory() - before < uint64_t(128) << 20);
}

TEST_CASE("the size of intact and damaged pictures can be read from the header alone") {
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        const ImageHeader header = read_image_header(sample.bytes, "whole");
        CHECK(header.width == 24);
        CHECK(header.height == 10);
        CHECK(header.is_float == std::holds_alternative<Image>(decode_image(sample.bytes, "whole")));
        const auto cut = std::span(sample.bytes).first(20);
        CHECK(test::says(test::thrown_error([&] { read_image_header(cut, "cut"); }), "cut: "));
    }
}

TEST_CASE("decoded pictures of every format have a size limit") {
    const auto outcome = [](uint64_t side, uint64_t decoded_bytes, uint64_t file_bytes) {
        const auto error =
            test::thrown_error([&] { check_image_size("a.png", side, side, decoded_bytes, file_bytes, 1 << 16); });
        return error ? static_cast<int>(error->code()) : -1;
    };
    constexpr int fine = -1, bad_input = static_cast<int>(ErrorCode::BadInput);
    constexpr int over_limit = static_cast<int>(ErrorCode::OverLimit);
    constexpr uint64_t limit = kFreeImageBytes + kMaxExpansion * 100'000;
    CHECK(outcome(8192, limit, 100'000) == fine);
    CHECK(outcome(8192, limit + 1, 100'000) == over_limit);
    CHECK(outcome(8192, limit, 1000) == bad_input); // more than the bytes can hold
    CHECK(outcome(kMaxImageSide + 1, 4, 100'000) == over_limit);
    CHECK(outcome(0, 0, 100'000) == bad_input);
}

TEST_CASE("a file's content overrules its name, and errors for other files list the formats") {
    const std::string text = "solid ascii\n";
    try {
        read_image(std::as_bytes(std::span(text)), "wall.png");
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::BadInput);
        CHECK(std::string(error.what()).find("PNG, JPEG, WebP, Radiance HDR or OpenEXR") != std::string::npos);
    }
    CHECK_THROWS_AS(read_image(std::span<const std::byte>{}, "empty.png"), Error);
    const std::filesystem::path path = test::scratch_folder() / "really_a_png.exr";
    write_png(path, Rgba8Image{1, 1, {255, 0, 0, 255}});
    CHECK(read_image(path).pixels == std::vector<float>{1, 0, 0});
}
