#include "image/decode_webp.h"

#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "image/check_image_size.h"

#if defined(PERTEV_HAS_WEBP)
#include <webp/decode.h>
#endif

namespace pertev {

bool is_webp(std::span<const std::byte> bytes) {
    const std::string_view start(reinterpret_cast<const char*>(bytes.data()), bytes.size() < 12 ? 0 : 12);
    return start.starts_with("RIFF") && start.ends_with("WEBP");
}

#if defined(PERTEV_HAS_WEBP)

bool has_webp() { return true; }

namespace {

// A lossless stream of one colour takes a few bytes, whatever its size.
constexpr uint64_t kMostPerByte = uint64_t(1) << 32;

const uint8_t* data_of(std::span<const std::byte> bytes) { return reinterpret_cast<const uint8_t*>(bytes.data()); }

[[noreturn]] void refuse_webp(const std::string& name, const char* why) {
    throw Error(ErrorCode::BadInput, FileLocation{name}, why);
}

} // namespace

ImageHeader read_webp_header(std::span<const std::byte> bytes, const std::string& name) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(data_of(bytes), bytes.size(), &features) != VP8_STATUS_OK) {
        refuse_webp(name, "the WebP header is damaged or truncated");
    }
    if (features.has_animation != 0) refuse_webp(name, "an animated WebP file; expected one picture");
    const auto width = static_cast<uint32_t>(features.width), height = static_cast<uint32_t>(features.height);
    check_image_size(name, width, height, uint64_t(width) * height * 4, bytes.size(), kMostPerByte);
    return {.width = width, .height = height, .is_float = false};
}

Rgba8Image decode_webp(std::span<const std::byte> bytes, const std::string& name) {
    const ImageHeader header = read_webp_header(bytes, name);
    Rgba8Image image{header.width, header.height, {}};
    image.pixels.resize(std::size_t(header.width) * header.height * 4);
    const uint8_t* decoded = WebPDecodeRGBAInto(data_of(bytes), bytes.size(), image.pixels.data(), image.pixels.size(),
                                                static_cast<int>(header.width * 4));
    if (decoded == nullptr) refuse_webp(name, "the WebP data is damaged or truncated");
    return image;
}

#else

bool has_webp() { return false; }

ImageHeader read_webp_header(std::span<const std::byte>, const std::string& name) {
    throw Error(ErrorCode::BadInput, FileLocation{name}, "a WebP file, and this program was built without libwebp");
}

Rgba8Image decode_webp(std::span<const std::byte> bytes, const std::string& name) {
    read_webp_header(bytes, name);
    return {};
}

#endif

} // namespace pertev
