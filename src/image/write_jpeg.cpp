#include "image/write_jpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <new>

#include <fmt/format.h>

#include <jpeglib.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/write_file_atomically.h"

namespace pertev {
namespace {

// libjpeg reports errors by a jump: write_all holds nothing that has a destructor. The picture is valid, so the only
// failure there can be is memory.
struct JpegWriter {
    jpeg_compress_struct info = {};
    jpeg_error_mgr errors = {};
    std::jmp_buf jump;
    unsigned char* bytes = nullptr; // malloc'ed by the library
    unsigned long count = 0;

    JpegWriter() = default;
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;
    ~JpegWriter() {
        jpeg_destroy_compress(&info);
        std::free(bytes);
    }
};

[[noreturn]] void on_write_error(j_common_ptr info) {
    std::longjmp(static_cast<JpegWriter*>(info->client_data)->jump, 1);
}
void ignore_message(j_common_ptr, int) {}
void ignore_output(j_common_ptr) {}

bool write_all(JpegWriter& writer, uint32_t width, uint32_t height, int quality, bool half_chroma, JSAMPARRAY rows) {
    jpeg_compress_struct& info = writer.info;
    info.err = jpeg_std_error(&writer.errors);
    writer.errors.error_exit = on_write_error;
    writer.errors.emit_message = ignore_message;
    writer.errors.output_message = ignore_output;
    info.client_data = &writer;
    if (setjmp(writer.jump) != 0) return false;
    jpeg_create_compress(&info);
    jpeg_mem_dest(&info, &writer.bytes, &writer.count);
    info.image_width = width;
    info.image_height = height;
    info.input_components = 4;
    info.in_color_space = JCS_EXT_RGBX;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, quality, TRUE);
    info.dct_method = JDCT_ISLOW;
    info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = half_chroma ? 2 : 1;
    jpeg_start_compress(&info, TRUE);
    while (info.next_scanline < height)
        jpeg_write_scanlines(&info, rows + info.next_scanline, height - info.next_scanline);
    jpeg_finish_compress(&info);
    return true;
}

/// Encodes rows [first, first + height) of `picture` as a separate file.
std::vector<std::byte> encode_rows(const Rgba8Image& picture, uint32_t first, uint32_t height, int quality,
                                   bool half_chroma) {
    const std::size_t row_bytes = std::size_t(picture.width) * 4;
    std::vector<JSAMPROW> rows(height);
    for (std::size_t y = 0; y < rows.size(); ++y) // the library only reads them
        rows[y] = const_cast<JSAMPROW>(picture.pixels.data() + (first + y) * row_bytes);
    JpegWriter writer;
    if (!write_all(writer, picture.width, height, quality, half_chroma, rows.data())) throw std::bad_alloc();
    const std::byte* bytes = reinterpret_cast<const std::byte*>(writer.bytes);
    return {bytes, bytes + writer.count};
}

void check_picture(const Rgba8Image& picture, int quality) {
    const std::size_t row_bytes = std::size_t(picture.width) * 4;
    PERTEV_CHECK(row_bytes > 0 && picture.height > 0 && picture.pixels.size() == row_bytes * picture.height);
    PERTEV_CHECK(quality >= 1 && quality <= 100);
    check_jpeg_size("", picture.width, picture.height);
}

constexpr int kStartOfFrame = 0xc0, kStartOfScan = 0xda; // second bytes of markers

/// Returns the position of the 0xff that begins the segment with this marker. Searches the segments before the scan,
/// which were written by this program.
std::size_t find_segment(const std::vector<std::byte>& file, int marker) {
    std::size_t at = 2; // behind the start of the image
    for (;;) {
        PERTEV_CHECK(at + 4 <= file.size() && file[at] == std::byte{0xff});
        if (std::to_integer<int>(file[at + 1]) == marker) return at;
        at += 2 + (std::to_integer<std::size_t>(file[at + 2]) << 8 | std::to_integer<std::size_t>(file[at + 3]));
    }
}

std::size_t start_of_data(const std::vector<std::byte>& file) {
    const std::size_t scan = find_segment(file, kStartOfScan);
    return scan + 2 +
           (std::to_integer<std::size_t>(file[scan + 2]) << 8 | std::to_integer<std::size_t>(file[scan + 3]));
}

void put_16(std::byte* at, uint32_t value) {
    at[0] = static_cast<std::byte>(value >> 8);
    at[1] = static_cast<std::byte>(value & 0xff);
}

} // namespace

void check_jpeg_size(Remark what, uint32_t width, uint32_t height) {
    if (width <= JPEG_MAX_DIMENSION && height <= JPEG_MAX_DIMENSION) return;
    what.reason = fmt::format("{} x {} pixels are too many for JPEG, whose limit is {} along a side; use .png", width,
                              height, JPEG_MAX_DIMENSION);
    throw Error(ErrorCode::OverLimit, std::move(what));
}

std::vector<std::byte> encode_jpeg(const Rgba8Image& picture, int quality) {
    check_picture(picture, quality);
    return encode_rows(picture, 0, picture.height, quality, false);
}

std::vector<std::byte> encode_jpeg_strips(const Rgba8Image& picture, int quality, bool half_chroma) {
    check_picture(picture, quality);
    // An MCU is the block of pixels that a scan counts by; a restart interval counts MCUs in 16 bits.
    const uint32_t side = half_chroma ? 16 : 8, mcu_columns = (picture.width + side - 1) / side,
                   mcu_rows = (picture.height + side - 1) / side;
    const uint32_t max_rows = std::max(1u, 65535 / mcu_columns);
    const uint32_t strip_rows = std::clamp((mcu_rows + 15) / 16, 1u, max_rows); // 16 strips, or as many as it takes
    const uint32_t count = (mcu_rows + strip_rows - 1) / strip_rows, height = strip_rows * side;
    if (count == 1) return encode_rows(picture, 0, picture.height, quality, half_chroma);
    std::vector<std::vector<std::byte>> strips(count);
    parallel_for(count, 1, [&](uint64_t i) {
        const uint32_t first = static_cast<uint32_t>(i) * height;
        strips[i] = encode_rows(picture, first, std::min(height, picture.height - first), quality, half_chroma);
    });
    // The first strip's head is that of the whole picture, except for the height and the interval before the scan.
    const std::vector<std::byte>& head = strips[0];
    const std::size_t scan = find_segment(head, kStartOfScan), data = start_of_data(head);
    std::size_t bytes = data + 8;
    for (const auto& strip : strips) bytes += strip.size();
    std::vector<std::byte> file;
    file.reserve(bytes);
    file.insert(file.end(), head.begin(), head.begin() + static_cast<std::ptrdiff_t>(scan));
    put_16(&file[find_segment(head, kStartOfFrame) + 5], picture.height);
    std::byte interval[6] = {std::byte{0xff}, std::byte{0xdd}, std::byte{0}, std::byte{4}};
    put_16(interval + 4, mcu_columns * strip_rows);
    file.insert(file.end(), interval, interval + 6);
    file.insert(file.end(), head.begin() + static_cast<std::ptrdiff_t>(scan),
                head.begin() + static_cast<std::ptrdiff_t>(data));
    for (std::size_t i = 0; i < strips.size(); ++i) {
        const auto& strip = strips[i];
        file.insert(file.end(), strip.begin() + static_cast<std::ptrdiff_t>(start_of_data(strip)), strip.end() - 2);
        file.push_back(std::byte{0xff}); // restarts are numbered 0 to 7; behind the last strip the image ends
        file.push_back(i + 1 < strips.size() ? static_cast<std::byte>(0xd0 + i % 8) : std::byte{0xd9});
    }
    return file;
}

void write_jpeg(const std::filesystem::path& path, const Rgba8Image& picture, int quality) {
    write_file_atomically(path, encode_jpeg(picture, quality));
}

} // namespace pertev
