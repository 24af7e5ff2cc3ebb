#include "image/decode_png.h"

#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>
#include <png.h>

#include "base/error.h"
#include "image/check_image_size.h"

namespace pertev {
namespace {

// Deflate reaches 1032:1. Of rows as the file stores them, before palettes and bits are expanded.
constexpr uint64_t kMaxPerPngByte = 1100;

// libpng reports errors by a jump. The steps below hold nothing that has a destructor, so the jump skips none: all
// memory belongs to decode_png, and every step returns false after a jump.
struct PngReader {
    std::span<const std::byte> bytes;
    std::size_t offset = 0;
    png_structp png = nullptr;
    png_infop info = nullptr;
    png_uint_32 width = 0, height = 0;
    int bit_depth = 0, colour_type = 0;
    uint32_t channels = 0; // after expansion, as read_pixels gives them
    uint64_t stored_row_bytes = 0;
    std::jmp_buf jump;
    char error[160] = {};
    char warning[160] = {};

    PngReader() = default;
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
    PngReader& reader = *static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(reader.error, sizeof reader.error, "%s", message);
    std::longjmp(reader.jump, 1);
}

void on_warning(png_structp png, png_const_charp message) {
    PngReader& reader = *static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(reader.warning, sizeof reader.warning, "%s", message);
}

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
    PngReader& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader.bytes.size() - reader.offset) png_error(png, "the file is truncated");
    std::memcpy(to, reader.bytes.data() + reader.offset, count);
    reader.offset += count;
}

bool read_header(PngReader& reader) {
    if (setjmp(reader.jump) != 0) return false;
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
    if (reader.png == nullptr) return false;
    reader.info = png_create_info_struct(reader.png);
    if (reader.info == nullptr) return false;
    png_set_read_fn(reader.png, &reader, read_bytes);
    png_set_user_limits(reader.png, 0x7fffffff, 0x7fffffff); // check_image_size judges, with a better message
    png_set_chunk_malloc_max(reader.png, 1 << 20);
    png_set_chunk_cache_max(reader.png, 64);
    // Chunks that cannot change a value are skipped unread: the library then cannot stumble over them either.
    png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);

    png_read_info(reader.png, reader.info);
    png_get_IHDR(reader.png, reader.info, &reader.width, &reader.height, &reader.bit_depth, &reader.colour_type,
                 nullptr, nullptr, nullptr);
    reader.stored_row_bytes = png_get_rowbytes(reader.png, reader.info);

    const bool has_transparency = png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0;
    png_set_expand(reader.png);
    if (reader.bit_depth == 16) {
        png_set_swap(reader.png);
        reader.channels = png_get_channels(reader.png, reader.info);
        if (has_transparency) ++reader.channels;
    } else {
        png_set_gray_to_rgb(reader.png);
        png_set_add_alpha(reader.png, 0xff, PNG_FILLER_AFTER);
        reader.channels = 4;
    }
    return true;
}

// `rows` points to one pointer a row.
bool read_pixels(PngReader& reader, png_bytepp rows, std::size_t row_bytes) {
    if (setjmp(reader.jump) != 0) return false;
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    if (png_get_rowbytes(reader.png, reader.info) != row_bytes) png_error(reader.png, "unexpected size of a row");
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

[[noreturn]] void fail(const PngReader& reader, const std::string& name) {
    throw Error(ErrorCode::BadInput, FileLocation{name},
                fmt::format("not a readable PNG (at byte {}: {})", reader.offset,
                            reader.error[0] != '\0' ? reader.error : "out of memory"));
}

void start(PngReader& reader, std::span<const std::byte> bytes, const std::string& name) {
    reader.bytes = bytes;
    if (!read_header(reader)) fail(reader, name);
    const uint64_t row_bytes = uint64_t(reader.width) * reader.channels * (reader.bit_depth == 16 ? sizeof(float) : 1);
    const uint64_t expansion = (row_bytes + reader.stored_row_bytes - 1) / reader.stored_row_bytes;
    check_image_size(name, reader.width, reader.height, multiply_saturated(row_bytes, reader.height), bytes.size(),
                     kMaxPerPngByte * expansion);
}

template <class T>
std::vector<T> read_all(PngReader& reader, const std::string& name) {
    const std::size_t per_row = std::size_t(reader.width) * reader.channels;
    std::vector<T> pixels(per_row * reader.height);
    std::vector<png_bytep> rows(reader.height);
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = reinterpret_cast<png_bytep>(pixels.data() + y * per_row);
    if (!read_pixels(reader, rows.data(), per_row * sizeof(T))) fail(reader, name);
    return pixels;
}

} // namespace

std::variant<Rgba8Image, Image> decode_png(std::span<const std::byte> bytes, const std::string& name, Sink& sink) {
    PngReader reader;
    start(reader, bytes, name);
    std::variant<Rgba8Image, Image> result;
    if (reader.bit_depth == 16) {
        const std::vector<uint16_t> values = read_all<uint16_t>(reader, name);
        Image image{reader.width, reader.height, reader.channels, {}};
        image.pixels.reserve(values.size());
        for (const uint16_t value : values) image.pixels.push_back(static_cast<float>(value) / 65535.0f);
        result = std::move(image);
    } else {
        result = Rgba8Image{reader.width, reader.height, read_all<uint8_t>(reader, name)};
    }
    if (reader.warning[0] != '\0') sink.warn(fmt::format("{}: PNG: {}", name, reader.warning));
    return result;
}

ImageHeader read_png_header(std::span<const std::byte> bytes, const std::string& name) {
    PngReader reader;
    start(reader, bytes, name);
    return {reader.width, reader.height, reader.bit_depth == 16};
}

} // namespace pertev
