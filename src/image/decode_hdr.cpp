#include "image/decode_hdr.h"

#include <array>
#include <charconv>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "image/check_image_size.h"
#include "math/scalar.h"

namespace pertev {
namespace {

// Maximum expansion to float RGB: new coding packs 127 values of each channel in 2 bytes; old coding has no bound,
// but this is plausible.
constexpr uint64_t kMaxPerHdrByte = 2000;

using Rgbe = std::array<uint8_t, 4>;

class HdrReader {
public:
    HdrReader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    ImageHeader read_header() {
        read_variables();
        read_resolution();
        check_image_size(name_, width_, height_, multiply_saturated(multiply_saturated(width_, height_), 12),
                         bytes_.size(), kMaxPerHdrByte);
        return {static_cast<uint32_t>(width_), static_cast<uint32_t>(height_), true};
    }

    const std::optional<ColorPrimaries>& primaries() const { return primaries_; }

    Image read() {
        read_header();
        const uint64_t line_length = x_is_major_ ? height_ : width_, lines = x_is_major_ ? width_ : height_;
        if (lines * 4 > bytes_.size() - offset_) // every coding takes a pixel's 4 bytes a line at least
            fail(fmt::format("{} lines of pixels do not fit into the rest of the file; it is truncated", lines));

        Image image{static_cast<uint32_t>(width_), static_cast<uint32_t>(height_), 3, {}};
        image.pixels.resize(image.width * std::size_t(image.height) * 3);
        std::vector<Rgbe> line(line_length);
        for (uint64_t i = 0; i < lines; ++i) {
            read_line(line);
            for (uint64_t k = 0; k < line_length; ++k) {
                uint64_t x = x_is_major_ ? i : k, y = x_is_major_ ? k : i;
                if (x_is_reversed_) x = width_ - 1 - x;
                if (y_is_reversed_) y = height_ - 1 - y;
                store(line[k], image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)));
            }
        }
        return image;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::BadInput, FileLocation{name_},
                    fmt::format("not a readable Radiance HDR (at byte {}: {})", offset_, what));
    }

    std::string_view next_line() {
        const char* start = reinterpret_cast<const char*>(bytes_.data()) + offset_;
        const std::size_t left = bytes_.size() - offset_;
        const void* end = std::memchr(start, '\n', left);
        if (end == nullptr) fail("the header is truncated");
        const std::string_view line(start, static_cast<std::size_t>(static_cast<const char*>(end) - start));
        if (line.size() > 4096) fail("a header line has more than 4096 characters");
        offset_ += line.size() + 1;
        return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
    }

    float next_number(std::string_view& text) const {
        while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
        float value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || !is_finite(value) || !(value > 0))
            fail("a number over 0 was expected in the header");
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        return value;
    }

    void read_variables() {
        next_line(); // #?RADIANCE
        bool has_format = false;
        for (std::string_view line = next_line(); !line.empty(); line = next_line()) {
            if (line.starts_with("FORMAT=")) {
                if (line != "FORMAT=32-bit_rle_rgbe")
                    fail(fmt::format("{}; only FORMAT=32-bit_rle_rgbe is supported", line));
                has_format = true;
            } else if (line.starts_with("EXPOSURE=")) {
                line.remove_prefix(9);
                const float exposure = next_number(line);
                for (float& scale : scale_) scale /= exposure;
            } else if (line.starts_with("COLORCORR=")) {
                line.remove_prefix(10);
                for (float& scale : scale_) scale /= next_number(line);
            } else if (line.starts_with("PRIMARIES=")) {
                read_primaries(line.substr(10));
            }
        }
        if (!has_format) fail("the header has no line FORMAT=32-bit_rle_rgbe");
        for (const float scale : scale_) {
            if (!is_finite(scale) || !(scale > 0)) fail("the product of EXPOSURE and COLORCORR is out of range");
        }
    }

    /// Reads the numbers of a line PRIMARIES; those that cannot be read are 0.
    void read_primaries(std::string_view text) {
        std::array<double, 8> numbers = {};
        for (double& number : numbers) {
            while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
            if (error != std::errc()) number = 0;
            text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        }
        primaries_.reset();
        if (numbers == std::array<double, 8>{}) return;
        primaries_ = {.red = {numbers[0], numbers[1]},
                      .green = {numbers[2], numbers[3]},
                      .blue = {numbers[4], numbers[5]},
                      .white = {numbers[6], numbers[7]}};
    }

    void read_resolution() {
        const std::string_view line = next_line();
        std::string_view rest = line;
        const auto bad = [&] {
            fail(fmt::format("the size reads \"{}\"; it should be like \"-Y 512 +X 1024\"", line));
        };
        bool seen_x = false, seen_y = false;
        for (int axis = 0; axis < 2; ++axis) {
            if (rest.size() < 4 || (rest[0] != '+' && rest[0] != '-') || rest[2] != ' ') bad();
            const bool is_negative = rest[0] == '-', is_x = rest[1] == 'X';
            if (!is_x && rest[1] != 'Y') bad();
            uint64_t count = 0;
            const auto [end, error] = std::from_chars(rest.data() + 3, rest.data() + rest.size(), count);
            if (error != std::errc()) bad();
            rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
            while (rest.starts_with(' ')) rest.remove_prefix(1);
            if (axis == 0) x_is_major_ = is_x;
            if (is_x) {
                width_ = count;
                x_is_reversed_ = is_negative;
                seen_x = true;
            } else {
                height_ = count;
                y_is_reversed_ = !is_negative; // the file's Y points up, our rows go down
                seen_y = true;
            }
        }
        if (!seen_x || !seen_y || !rest.empty()) bad();
    }

    void need(std::size_t count) const {
        if (bytes_.size() - offset_ < count) fail("the pixels are truncated");
    }
    uint8_t next_byte() { return std::to_integer<uint8_t>(bytes_[offset_++]); }

    void read_line(std::span<Rgbe> line) {
        need(4);
        Rgbe first;
        std::memcpy(first.data(), bytes_.data() + offset_, 4);
        const bool is_new =
            line.size() >= 8 && line.size() <= 0x7fff && first[0] == 2 && first[1] == 2 && first[2] < 128;
        if (!is_new) return read_flat_or_old(line);
        if (std::size_t(first[2]) * 256 + first[3] != line.size())
            fail(fmt::format("a line has {} pixels; the header states {}", first[2] * 256 + first[3], line.size()));
        offset_ += 4;
        for (std::size_t channel = 0; channel < 4; ++channel) read_channel(line, channel);
    }

    void read_channel(std::span<Rgbe> line, std::size_t channel) {
        for (std::size_t x = 0; x < line.size();) {
            need(2);
            const unsigned code = next_byte();
            const bool is_run = code > 128;
            const std::size_t count = is_run ? code - 128 : code;
            if (count == 0) fail("a run has 0 pixels");
            if (count > line.size() - x) fail("a run goes beyond the end of its line");
            if (is_run) {
                const uint8_t value = next_byte();
                for (std::size_t k = 0; k < count; ++k) line[x++][channel] = value;
            } else {
                need(count);
                for (std::size_t k = 0; k < count; ++k) line[x++][channel] = next_byte();
            }
        }
    }

    // Old coding: a pixel (1, 1, 1, n) repeats the one before n times; such pixels in a row are a number's bytes.
    void read_flat_or_old(std::span<Rgbe> line) {
        unsigned shift = 0;
        for (std::size_t x = 0; x < line.size();) {
            need(4);
            Rgbe pixel;
            for (uint8_t& value : pixel) value = next_byte();
            if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
                line[x++] = pixel;
                shift = 0;
                continue;
            }
            const std::size_t count = shift < 32 ? std::size_t(pixel[3]) << shift : 0;
            if (x == 0) fail("a run stands before the first pixel of a line");
            if (count == 0 && shift >= 32) fail("a run has more than 2^32 pixels");
            if (count > line.size() - x) fail("a run goes beyond the end of its line");
            for (std::size_t k = 0; k < count; ++k, ++x) line[x] = line[x - 1];
            shift += 8;
        }
    }

    // 2^(exponent - 136) by its bits, which are those of a subnormal number at the small end.
    static float unit_of(unsigned exponent) {
        if (exponent == 0) return 0.0f;
        return exponent >= 10 ? float_of((exponent - 9u) << 23) : float_of(1u << (exponent + 13u));
    }

    void store(const Rgbe& pixel, float* to) const {
        for (int c = 0; c < 3; ++c) {
            to[c] = static_cast<float>(pixel[static_cast<std::size_t>(c)]) * unit_of(pixel[3]) *
                    scale_[static_cast<std::size_t>(c)];
        }
    }

    std::span<const std::byte> bytes_;
    const std::string& name_;
    std::size_t offset_ = 0;
    uint64_t width_ = 0, height_ = 0;
    bool x_is_major_ = false, x_is_reversed_ = false, y_is_reversed_ = false;
    std::array<float, 3> scale_ = {1, 1, 1};
    std::optional<ColorPrimaries> primaries_;
};

} // namespace

Image decode_hdr(std::span<const std::byte> bytes, const std::string& name) { return HdrReader(bytes, name).read(); }

std::optional<ColorPrimaries> read_hdr_primaries(std::span<const std::byte> bytes, const std::string& name) {
    HdrReader reader(bytes, name);
    reader.read_header();
    return reader.primaries();
}

ImageHeader read_hdr_header(std::span<const std::byte> bytes, const std::string& name) {
    return HdrReader(bytes, name).read_header();
}

} // namespace pertev
