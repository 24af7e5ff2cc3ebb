#include "session/crop.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/limits.h"

namespace pertev {
namespace {

std::string text_of(const PictureOptions& options) { return fmt::format("{}", fmt::join(options.crop, ",")); }

} // namespace

std::optional<PictureCrop> parse_crop(const PictureOptions& options) {
    const std::vector<double>& numbers = options.crop;
    if (numbers.empty()) return std::nullopt;
    const auto is_whole = [](double x) { return x >= 0 && x <= kMaxImageSide && x == std::floor(x); };
    if (numbers.size() == 4 && std::ranges::all_of(numbers, is_whole) && numbers[2] > 0 && numbers[3] > 0) {
        const auto number = [&](std::size_t i) { return static_cast<uint32_t>(numbers[i]); };
        return PictureCrop{number(0), number(1), number(2), number(3)};
    }
    throw Error(ErrorCode::BadInput, "crop", text_of(options),
                fmt::format("expected X,Y,W,H in whole pixels, with W and H from 1 to {}, such as 320,180,640,360",
                            kMaxImageSide));
}

void set_crop(const PictureOptions& options, RenderSettings& settings) {
    settings.crop = parse_crop(options);
    if (settings.window().is_in(settings.width, settings.height)) return;
    throw Error(ErrorCode::BadInput, "crop", text_of(options),
                fmt::format("is not inside the picture of {}x{} pixels, whose last pixel is {},{}", settings.width,
                            settings.height, settings.width - 1, settings.height - 1));
}

Image pixels_in(const Image& whole, const PixelWindow& window) {
    if (window.picture_width == 0) return whole;
    PERTEV_CHECK(window.is_in(whole.width, whole.height));
    Image part = {window.width, window.height, whole.channels, {}};
    part.pixels.reserve(std::size_t{window.count()} * whole.channels);
    for (uint32_t row = 0; row < window.height; ++row) {
        const auto from =
            whole.pixels.begin() +
            static_cast<std::ptrdiff_t>(std::size_t{window.pixel_in(window.x, window.y + row)} * whole.channels);
        part.pixels.insert(part.pixels.end(), from,
                           from + static_cast<std::ptrdiff_t>(std::size_t{window.width} * whole.channels));
    }
    return part;
}

} // namespace pertev
