#include "apps/viewer/jpeg_encoder.h"

#include "base/error.h"
#include "image/write_jpeg.h"

namespace pertev {

JpegEncoder::JpegEncoder(Queue* queue, std::span<const char* const> libraries) {
    try {
        if (queue != nullptr) nvjpeg_ = Nvjpeg::load(*queue, libraries);
    } catch (const Error&) { // the renderer also detects a lost device, and reports it
    }
}

std::vector<std::byte> JpegEncoder::encode(const Rgba8Image& picture, int quality, bool half_chroma) {
    if (nvjpeg_) {
        try {
            std::vector<std::byte> file = nvjpeg_->encode(picture, quality, half_chroma);
            if (!file.empty()) return file;
        } catch (const Error&) {
        }
        nvjpeg_.reset();
    }
    return encode_jpeg_strips(picture, quality, half_chroma);
}

} // namespace pertev
