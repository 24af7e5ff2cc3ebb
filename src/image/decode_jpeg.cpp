#include "image/decode_jpeg.h"

#include <csetjmp>
#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include <jpeglib.h>

#include <jerror.h>

#include "base/error.h"
#include "image/check_image_size.h"

namespace pertev {
namespace {

// Maximum expansion to RGBA bytes: a block of 64 pixels takes at least one bit per component.
constexpr uint64_t kMaxPerJpegByte = 4096;
// Each scan processes the whole picture, however few bytes it has; encoders write about ten.
constexpr int kMaxScans = 100;

// libjpeg reports errors by a call that must not return, here a jump. The steps below hold nothing that has a
// destructor, so the jump skips none: all memory belongs to decode_jpeg, and a step returns false after a jump.
struct JpegReader {
    jpeg_decompress_struct info = {};
    jpeg_error_mgr errors = {};
    jpeg_progress_mgr progress = {};
    std::jmp_buf jump;
    bool cut_short = false;
    bool too_many_scans = false;
    char error[JMSG_LENGTH_MAX] = {};
    char warning[JMSG_LENGTH_MAX] = {};

    JpegReader() = default;
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() { jpeg_destroy_decompress(&info); }
};

JpegReader& reader_of(j_common_ptr info) { return *static_cast<JpegReader*>(info->client_data); }

[[noreturn]] void on_error(j_common_ptr info) {
    JpegReader& reader = reader_of(info);
    info->err->format_message(info, reader.error);
    std::longjmp(reader.jump, 1);
}

// The library goes on after damage and makes pixels up. Only damage that costs no pixel is let pass.
void on_message(j_common_ptr info, int level) {
    if (level >= 0) return; // a trace
    JpegReader& reader = reader_of(info);
    switch (info->err->msg_code) {
    case JWRN_EXTRANEOUS_DATA:
    case JWRN_ADOBE_XFORM:
    case JWRN_JFIF_MAJOR:
        info->err->format_message(info, reader.warning);
        return;
    case JWRN_JPEG_EOF:
    case JWRN_HIT_MARKER:
        reader.cut_short = true;
        on_error(info);
    default:
        on_error(info);
    }
}

void on_output(j_common_ptr) {}

void on_progress(j_common_ptr info) {
    if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number <= kMaxScans) return;
    reader_of(info).too_many_scans = true;
    on_error(info);
}

bool read_header(JpegReader& reader, const unsigned char* bytes, unsigned long count) {
    jpeg_decompress_struct& info = reader.info;
    info.err = jpeg_std_error(&reader.errors);
    reader.errors.error_exit = on_error;
    reader.errors.emit_message = on_message;
    reader.errors.output_message = on_output;
    info.client_data = &reader;
    if (setjmp(reader.jump) != 0) return false;
    jpeg_create_decompress(&info);
    reader.progress.progress_monitor = on_progress;
    info.progress = &reader.progress;
    jpeg_mem_src(&info, bytes, count);
    jpeg_read_header(&info, TRUE);
    return true;
}

bool start(JpegReader& reader) {
    if (setjmp(reader.jump) != 0) return false;
    jpeg_decompress_struct& info = reader.info;
    const bool is_cmyk = info.jpeg_color_space == JCS_CMYK || info.jpeg_color_space == JCS_YCCK;
    info.out_color_space = is_cmyk ? JCS_CMYK : JCS_EXT_RGBA;
    info.dct_method = JDCT_ISLOW;
    info.do_fancy_upsampling = TRUE;
    info.do_block_smoothing = FALSE; // guesses what a cut-off progressive file lacks
    jpeg_start_decompress(&info);
    return true;
}

// `row` has 4 bytes a pixel; false after an error.
bool read_row(JpegReader& reader, unsigned char* row) {
    if (setjmp(reader.jump) != 0) return false;
    JSAMPROW rows[1] = {row};
    jpeg_read_scanlines(&reader.info, rows, 1);
    return true;
}

bool finish(JpegReader& reader) {
    if (setjmp(reader.jump) != 0) return false;
    jpeg_finish_decompress(&reader.info);
    return true;
}

// Ink to light. Files with Adobe's marker store 255 for no ink.
void convert_cmyk_row(unsigned char* row, std::size_t pixels, bool no_ink_is_255) {
    const auto light = [&](unsigned value) { return no_ink_is_255 ? value : 255u - value; };
    for (std::size_t x = 0; x < pixels; ++x, row += 4) {
        const unsigned black = light(row[3]);
        for (int c = 0; c < 3; ++c) row[c] = static_cast<unsigned char>((light(row[c]) * black + 127u) / 255u);
        row[3] = 255;
    }
}

[[noreturn]] void fail(const JpegReader& reader, const std::string& name, std::optional<uint32_t> row) {
    std::string what = reader.error;
    if (reader.cut_short) what = "the file is truncated";
    if (reader.too_many_scans) what = fmt::format("more than {} scans", kMaxScans);
    const std::string where = row ? fmt::format("in row {} of {}", *row, reader.info.output_height) : "in its header";
    throw Error(ErrorCode::BadInput, FileLocation{name}, fmt::format("not a readable JPEG ({}: {})", where, what));
}

void open(JpegReader& reader, std::span<const std::byte> bytes, const std::string& name) {
    if (!read_header(reader, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()))
        fail(reader, name, std::nullopt);
    const jpeg_decompress_struct& info = reader.info;
    check_image_size(name, info.image_width, info.image_height,
                     multiply_saturated(uint64_t(info.image_width) * 4, info.image_height), bytes.size(),
                     kMaxPerJpegByte);
}

} // namespace

Rgba8Image decode_jpeg(std::span<const std::byte> bytes, const std::string& name, Sink& sink) {
    JpegReader reader;
    open(reader, bytes, name);
    const jpeg_decompress_struct& info = reader.info;
    if (!start(reader)) fail(reader, name, std::nullopt);
    Rgba8Image image{info.output_width, info.output_height, {}};
    const std::size_t row_bytes = std::size_t(image.width) * 4;
    image.pixels.resize(row_bytes * image.height);
    for (uint32_t y = 0; y < image.height; ++y) {
        unsigned char* row = image.pixels.data() + y * row_bytes;
        if (!read_row(reader, row)) fail(reader, name, y);
        if (info.out_color_space == JCS_CMYK) convert_cmyk_row(row, image.width, info.saw_Adobe_marker != FALSE);
    }
    if (!finish(reader)) fail(reader, name, image.height);
    if (reader.warning[0] != '\0') sink.warn(fmt::format("{}: JPEG: {}", name, reader.warning));
    return image;
}

ImageHeader read_jpeg_header(std::span<const std::byte> bytes, const std::string& name) {
    JpegReader reader;
    open(reader, bytes, name);
    return {reader.info.image_width, reader.info.image_height, false};
}

} // namespace pertev
