#include "image/write_jpeg.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <new>

#include <fmt/format.h>

#include <jpeglib.h>

#include "base/error.h"
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

[[noreturn]] void on_error(j_common_ptr info) { std::longjmp(static_cast<JpegWriter*>(info->client_data)->jump, 1); }
void on_message(j_common_ptr, int) {}
void on_output(j_common_ptr) {}

bool write_all(JpegWriter& writer, uint32_t width, uint32_t height, int quality, JSAMPARRAY rows) {
    jpeg_compress_struct& info = writer.info;
    info.err = jpeg_std_error(&writer.errors);
    writer.errors.error_exit = on_error;
    writer.errors.emit_message = on_message;
    writer.errors.output_message = on_output;
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
    info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(&info, TRUE);
    while (info.next_scanline < height)
        jpeg_write_scanlines(&info, rows + info.next_scanline, height - info.next_scanline);
    jpeg_finish_compress(&info);
    return true;
}

} // namespace

void check_jpeg_size(const std::string& name, uint32_t width, uint32_t height) {
    if (width > JPEG_MAX_DIMENSION || height > JPEG_MAX_DIMENSION)
        throw Error(ErrorCode::OverLimit,
                    fmt::format("{}: {} x {} pixels are too many for JPEG, whose limit is {} along a side; use .png",
                                name, width, height, JPEG_MAX_DIMENSION));
}

std::vector<std::byte> encode_jpeg(const Rgba8Image& picture, int quality) {
    const std::size_t row_bytes = std::size_t(picture.width) * 4;
    PERTEV_CHECK(row_bytes > 0 && picture.height > 0 && picture.pixels.size() == row_bytes * picture.height);
    PERTEV_CHECK(quality >= 1 && quality <= 100);
    check_jpeg_size("picture", picture.width, picture.height);
    std::vector<JSAMPROW> rows(picture.height);
    for (std::size_t y = 0; y < rows.size(); ++y) // the library only reads them
        rows[y] = const_cast<JSAMPROW>(picture.pixels.data() + y * row_bytes);
    JpegWriter writer;
    if (!write_all(writer, picture.width, picture.height, quality, rows.data())) throw std::bad_alloc();
    const std::byte* bytes = reinterpret_cast<const std::byte*>(writer.bytes);
    return {bytes, bytes + writer.count};
}

void write_jpeg(const std::filesystem::path& path, const Rgba8Image& picture, int quality) {
    write_file_atomically(path, encode_jpeg(picture, quality));
}

} // namespace pertev
