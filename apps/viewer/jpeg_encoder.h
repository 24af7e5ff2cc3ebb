#pragma once

// Packs pictures as JPEG: on a GPU by nvJPEG where that is found and works, else by all threads of the CPU with
// libjpeg-turbo. What fails once is not asked again.

#include "apps/viewer/nvjpeg.h"

namespace pertev {

class JpegEncoder {
public:
    /// `queue`: of the GPU, for nothing else; it outlives this. Null: the CPU packs. `libraries`: where nvJPEG may be.
    explicit JpegEncoder(Queue* queue, std::span<const char* const> libraries = Nvjpeg::libraries());

    /// As encode_jpeg_strips.
    std::vector<std::byte> encode(const Rgba8Image& picture, int quality, bool half_chroma);

    /// Of what packs now, for people.
    const char* name() const { return nvjpeg_ ? "nvJPEG" : "libjpeg-turbo"; }

private:
    std::unique_ptr<Nvjpeg> nvjpeg_;
};

} // namespace pertev
