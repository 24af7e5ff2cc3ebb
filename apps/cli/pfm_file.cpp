#include "apps/cli/pfm_file.h"

#include <cstring>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "base/read_file.h"
#include "base/write_file_atomically.h"

namespace pertev {
namespace {

std::string header(uint32_t width, uint32_t height) { return fmt::format("PF\n{} {}\n-1.000000\n", width, height); }

/// First float of a row, which is counted from above, in rows counted from below.
std::size_t offset_of(uint32_t row, uint32_t width, uint32_t height) {
    return std::size_t(height - 1 - row) * width * 3;
}

} // namespace

void write_pfm(const std::filesystem::path& file, const Image& picture) {
    PERTEV_CHECK(picture.channels == 3);
    const std::string head = header(picture.width, picture.height);
    const std::size_t row_bytes = std::size_t(picture.width) * 3 * sizeof(float);
    std::vector<std::byte> bytes(head.size() + picture.height * row_bytes);
    std::memcpy(bytes.data(), head.data(), head.size());
    for (uint32_t row = 0; row < picture.height; ++row) {
        std::memcpy(bytes.data() + head.size() + offset_of(row, picture.width, picture.height) * sizeof(float),
                    picture.pixels.data() + row * std::size_t(picture.width) * 3, row_bytes);
    }
    write_file_atomically(file, bytes);
}

Image read_pfm(const std::filesystem::path& file, uint32_t width, uint32_t height) {
    const std::vector<std::byte> bytes = read_file(file);
    // Programs write the scale as they like: the header ends with the third line's end.
    std::size_t lines = 0, start = 0;
    while (start < bytes.size() && lines < 3) lines += bytes[start++] == std::byte('\n') ? 1 : 0;
    const std::string head(reinterpret_cast<const char*>(bytes.data()), start);
    const std::string expected = fmt::format("PF\n{} {}\n-", width, height);
    const std::size_t row_bytes = std::size_t(width) * 3 * sizeof(float);
    if (!head.starts_with(expected) || bytes.size() != start + height * row_bytes) {
        throw Error(ErrorCode::BadInput, FileLocation{file.string()},
                    fmt::format("expected a portable float map of {}x{} pixels, three little-endian floats each", width,
                                height));
    }
    Image picture{width, height, 3, std::vector<float>(std::size_t(width) * height * 3)};
    for (uint32_t row = 0; row < height; ++row) {
        std::memcpy(picture.pixels.data() + row * std::size_t(width) * 3,
                    bytes.data() + start + offset_of(row, width, height) * sizeof(float), row_bytes);
    }
    return picture;
}

} // namespace pertev
