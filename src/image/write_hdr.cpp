#include "image/write_hdr.h"

#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "base/write_file_atomically.h"
#include "math/rgb.h"

namespace pertev {
namespace {

using Rgbe = std::array<uint8_t, 4>;

// Power of two by its exponent, which is that of a normal number.
float power_of_2(int exponent) { return float_of(static_cast<uint32_t>(exponent + 127) << 23); }

Rgbe rgbe_of(Rgb c) {
    constexpr float kMaxLight = 255.0f * 0x1p119f; // mantissa 255, exponent 255
    c = {clamp(c.r, 0.0f, kMaxLight), clamp(c.g, 0.0f, kMaxLight), clamp(c.b, 0.0f, kMaxLight)};
    const float largest = max_component(c);
    if (!(largest >= 0x1p-120f)) return {0, 0, 0, 0};
    // largest = m 2^e with m in [128, 256), so that its mantissa is m, rounded.
    int e = static_cast<int>(bits_of(largest) >> 23) - 127 - 7;
    if (largest * power_of_2(-e) >= 255.5f) ++e; // would round to 256
    const float unit = power_of_2(-e);
    const auto mantissa = [&](float x) { return static_cast<uint8_t>(to_int(x * unit + 0.5f, 0, 255)); };
    return {mantissa(c.r), mantissa(c.g), mantissa(c.b), static_cast<uint8_t>(e + 136)};
}

class Writer {
public:
    void text(const std::string& from) {
        for (const char c : from) byte(static_cast<uint8_t>(c));
    }
    void byte(std::size_t value) { bytes.push_back(static_cast<std::byte>(value)); }

    void line(const std::vector<Rgbe>& pixels) {
        if (pixels.size() < 8 || pixels.size() > 0x7fff) { // the coding has no room for these widths
            for (const Rgbe& pixel : pixels)
                for (const uint8_t value : pixel) byte(value);
            return;
        }
        byte(2), byte(2), byte(pixels.size() >> 8), byte(pixels.size() & 0xff);
        for (std::size_t c = 0; c < 4; ++c) channel(pixels, c);
    }

    std::vector<std::byte> bytes;

private:
    static std::size_t run_length(const std::vector<Rgbe>& pixels, std::size_t c, std::size_t x) {
        std::size_t n = 1;
        while (n < 127 && x + n < pixels.size() && pixels[x + n][c] == pixels[x][c]) ++n;
        return n;
    }

    void channel(const std::vector<Rgbe>& pixels, std::size_t c) {
        for (std::size_t x = 0; x < pixels.size();) {
            const std::size_t run = run_length(pixels, c, x);
            if (run >= 3) {
                byte(128 + run), byte(pixels[x][c]);
                x += run;
                continue;
            }
            std::size_t end = x + 1; // end of the bytes before the next run worth coding
            while (end < pixels.size() && end - x < 128 && run_length(pixels, c, end) < 3) ++end;
            byte(end - x);
            for (; x < end; ++x) byte(pixels[x][c]);
        }
    }
};

} // namespace

std::vector<std::byte> encode_hdr(const Image& linear) {
    PERTEV_CHECK(linear.width > 0 && linear.height > 0 && linear.channels >= 1 && linear.channels <= 4);
    Writer writer;
    writer.text(fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", linear.height, linear.width));
    std::vector<Rgbe> line(linear.width);
    for (uint32_t y = 0; y < linear.height; ++y) {
        for (uint32_t x = 0; x < linear.width; ++x) {
            const float* p = linear.at(x, y);
            line[x] = rgbe_of(linear.channels < 3 ? grey(p[0]) : Rgb{p[0], p[1], p[2]});
        }
        writer.line(line);
    }
    return std::move(writer.bytes);
}

void write_hdr(const std::filesystem::path& path, const Image& linear) {
    write_file_atomically(path, encode_hdr(linear));
}

} // namespace pertev
