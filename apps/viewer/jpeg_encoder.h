#pragma once

// Encodes pictures as JPEG: on a GPU by nvJPEG if that is found and works, else on all CPU threads with
// libjpeg-turbo. After a failure nvJPEG is not used again.

#include "apps/viewer/nvjpeg.h"

namespace pertev {

class JpegEncoder {
public:
    /// `queue` is the GPU's, used for nothing else; it outlives this. Null: the CPU encodes. `libraries` lists where
    /// nvJPEG may be.
    explicit JpegEncoder(Queue* queue, std::span<const char* const> libraries = Nvjpeg::libraries());

    /// Encodes like encode_jpeg_strips.
    std::vector<std::byte> encode(const Rgba8Image& picture, int quality, bool half_chroma);

    /// Name of the current encoder for people.
    const char* name() const { return nvjpeg_ ? "nvJPEG" : "libjpeg-turbo"; }

private:
    std::unique_ptr<Nvjpeg> nvjpeg_;
};

} // namespace pertev
