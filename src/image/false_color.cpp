#include "image/false_color.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "math/portable_math.h"
#include "math/rgb.h"
#include "math/scalar.h"

namespace pertev {
namespace {

constexpr uint32_t kGlyphWidth = 8;

// Glyphs of 3 x 5 points, a row three bits, the topmost row first.
struct Glyph {
    char letter;
    uint16_t points;
};
constexpr Glyph kGlyphs[] = {
    {'0', 0b111101101101111}, {'1', 0b010110010010111}, {'2', 0b111001111100111}, {'3', 0b111001111001111},
    {'4', 0b101101111001001}, {'5', 0b111100111001111}, {'6', 0b111100111101111}, {'7', 0b111001010010010},
    {'8', 0b111101111101111}, {'9', 0b111101111001111}, {'.', 0b000000000000010}, {'/', 0b001001010100100},
    {'-', 0b000000111000000}, {'+', 0b000010111010000}, {'e', 0b010101111100011}, {'c', 0b000011100100011},
    {'d', 0b001011101101011}, {'l', 0b110010010010111}, {'m', 0b000111111101101}, {'x', 0b000101010010101},
};

float value_at(const Image& linear, std::size_t pixel, float factor) {
    const float* p = &linear.pixels[pixel * linear.channels];
    return factor * (linear.channels < 3 ? p[0] : luminance(Rgb{p[0], p[1], p[2]}));
}

/// Returns the position of a value on the scale: 0 at its beginning, 1 at its end.
float place_on(const FalseColorScale& scale, float value) {
    if (!(value > scale.least)) return 0;
    return value < scale.most ? log(value / scale.least) / log(scale.most / scale.least) : 1.0f;
}

/// Calls what(number) for 1, 2 and 5 times each power of ten that a float can hold, in ascending order.
template <class What>
void for_round_numbers(const What& what) {
    for (double ten = 1e-30; ten < 1e31; ten *= 10) {
        for (const double digit : {1.0, 2.0, 5.0}) what(static_cast<float>(digit * ten));
    }
}

std::string text_of(float value) { return fmt::format("{:.6g}", value); }
uint32_t width_of(const std::string& text) { return kGlyphWidth * static_cast<uint32_t>(text.size()); }

void draw_scale(Rgba8Image& image, uint32_t top, const FalseColorScale& scale) {
    const uint32_t width = image.width, bar_end = top + 14, text_top = top + 19;
    for (uint32_t x = 0; x < width; ++x) {
        const FalseColor color = false_color((static_cast<float>(x) + 0.5f) / static_cast<float>(width));
        for (uint32_t y = top + 2; y < bar_end; ++y) set_pixel(image, x, y, color);
    }
    constexpr FalseColor kInk = {0, 0, 0};
    const std::string end = text_of(scale.most) + " " + scale.unit;
    const uint32_t end_width = width_of(end) + 2;
    if (width < end_width) return;
    draw_text(image, width - end_width, text_top, end, kInk);
    const std::string first = text_of(scale.least);
    uint32_t free = 0; // from here on there is room for text
    const auto label = [&](uint32_t x, uint32_t mark, const std::string& text) {
        if (x < free || x + width_of(text) + kGlyphWidth > width - end_width) return;
        draw_text(image, x, text_top, text, kInk);
        for (uint32_t y = bar_end; y < bar_end + 3; ++y) set_pixel(image, mark, y, kInk);
        free = x + width_of(text) + kGlyphWidth;
    };
    label(2, 0, first);
    for_round_numbers([&](float number) {
        if (!(number > scale.least && number < scale.most)) return;
        const auto mark =
            static_cast<uint32_t>(to_int(place_on(scale, number) * static_cast<float>(width), 0, 1 << 20));
        const std::string text = text_of(number);
        label(mark - std::min(mark, width_of(text) / 2), mark, text);
    });
}

} // namespace

FalseColor false_color(float t) {
    // Lightness rises evenly, hue turns once from violet to yellow.
    constexpr float stops[7][3] = {{0, 0, 10},     {50, 10, 95},   {122, 28, 109}, {190, 55, 84},
                                   {237, 105, 37}, {251, 180, 26}, {252, 255, 180}};
    const float at = clamp(t, 0.0f, 1.0f) * 6.0f;
    const int k = std::min(static_cast<int>(at), 5);
    const float f = at - static_cast<float>(k);
    const auto channel = [&](int c) {
        return static_cast<uint8_t>(floor(stops[k][c] + (stops[k + 1][c] - stops[k][c]) * f + 0.5f));
    };
    return {channel(0), channel(1), channel(2)};
}

void set_pixel(Rgba8Image& image, uint32_t x, uint32_t y, FalseColor color) {
    if (x >= image.width || y >= image.height) return;
    uint8_t* p = &image.pixels[4 * (std::size_t(y) * image.width + x)];
    p[0] = color.r, p[1] = color.g, p[2] = color.b, p[3] = 255;
}

void draw_text(Rgba8Image& image, uint32_t x, uint32_t y, const std::string& text, FalseColor color) {
    for (const char letter : text) {
        const auto glyph = std::ranges::find(kGlyphs, letter, &Glyph::letter);
        const uint32_t points = glyph != std::end(kGlyphs) ? glyph->points : 0;
        for (uint32_t i = 0; i < 15; ++i) {
            if (!(points >> (14 - i) & 1)) continue;
            for (uint32_t k = 0; k < 4; ++k) { // twice as large as the points are
                set_pixel(image, x + 2 * (i % 3) + k % 2, y + 2 * (i / 3) + k / 2, color);
            }
        }
        x += kGlyphWidth;
    }
}

Rgba8Image draw_false_colors(const Image& linear, float factor, const FalseColorScale& scale) {
    PERTEV_CHECK(scale.least > 0 && scale.least < scale.most);
    Rgba8Image image{linear.width, linear.height + kFalseColorScaleRows, {}};
    image.pixels.assign(std::size_t(4) * image.width * image.height, 255);
    for (std::size_t i = 0; i < std::size_t(linear.width) * linear.height; ++i) {
        set_pixel(image, static_cast<uint32_t>(i % linear.width), static_cast<uint32_t>(i / linear.width),
                  false_color(place_on(scale, value_at(linear, i, factor))));
    }
    draw_scale(image, linear.height, scale);
    return image;
}

FalseColorScale fitting_scale(const Image& linear, float factor, std::string unit) {
    std::vector<float> values(std::size_t(linear.width) * linear.height);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float value = value_at(linear, i, factor);
        values[i] = value > 0 ? value : 0; // NaN too
    }
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 199 / 200);
    std::ranges::nth_element(values, at);
    float most = 0;
    for_round_numbers([&](float number) {
        if (most == 0 && number >= *at && *at > 0) most = number;
    });
    if (!(most > 0)) most = 1;
    return {most / 1000, most, std::move(unit)};
}

} // namespace pertev
