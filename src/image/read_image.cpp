#include "image/read_image.h"

#include "base/read_file.h"
#include "image/check_image_size.h"
#include "image/decode_image.h"
#include "image/image_format.h"
#include "image/picture_primaries.h"
#include "image/srgb.h"
#include "image/srgb_table.h"

namespace pertev {
namespace {

// Room for that many floats, as far as the file justifies them.
std::vector<float> make_pixels(std::size_t count, std::size_t file_bytes, const std::string& name) {
    check_decoded_bytes(name, count * sizeof(float), file_bytes);
    return std::vector<float>(count);
}

Image linear_from_bytes(const Rgba8Image& from, std::size_t file_bytes, const std::string& name) {
    const std::size_t count = std::size_t(from.width) * from.height;
    bool is_opaque = true;
    for (std::size_t i = 0; i < count; ++i) is_opaque = is_opaque && from.pixels[4 * i + 3] == 255;

    const uint32_t channels = is_opaque ? 3 : 4;
    Image to{from.width, from.height, channels, make_pixels(count * channels, file_bytes, name)};
    const std::array<float, 256>& table = srgb_decode_table();
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) to.pixels[i * channels + c] = table[from.pixels[4 * i + c]];
        if (!is_opaque) to.pixels[i * channels + 3] = static_cast<float>(from.pixels[4 * i + 3]) / 255.0f;
    }
    return to;
}

// Y and YA become RGB and RGBA.
Image with_colour(Image from, std::size_t file_bytes, const std::string& name) {
    if (from.channels >= 3) return from;
    const uint32_t channels = from.channels + 2;
    const std::size_t count = std::size_t(from.width) * from.height;
    Image to{from.width, from.height, channels, make_pixels(count * channels, file_bytes, name)};
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) to.pixels[i * channels + c] = from.pixels[i * from.channels];
        if (channels == 4) to.pixels[i * channels + 3] = from.pixels[i * from.channels + 1];
    }
    return to;
}

} // namespace

Image read_image(std::span<const std::byte> bytes, const std::string& name, Sink& sink) {
    std::variant<Rgba8Image, Image> decoded = decode_image(bytes, name, sink);
    if (const Rgba8Image* image = std::get_if<Rgba8Image>(&decoded))
        return linear_from_bytes(*image, bytes.size(), name);
    Image& stored = std::get<Image>(decoded);
    if (const auto matrix = color_matrix_of(bytes, name, sink)) convert_colors(*matrix, stored);
    Image image = with_colour(std::move(stored), bytes.size(), name);
    if (recognise_image(bytes) == ImageFormat::Png) {
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            if (i % image.channels != 3) image.pixels[i] = srgb_decode(image.pixels[i]);
    }
    return image;
}

Image read_image(const std::filesystem::path& path, Sink& sink) {
    return read_image(read_file(path), path.string(), sink);
}

} // namespace pertev
