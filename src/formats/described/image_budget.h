#pragma once

// A limit on the pictures that a reader makes of those in files, so that a small file cannot ask for many large ones.

#include <cstdint>

#include <fmt/format.h>

#include "base/error.h"
#include "scene/texture.h"

namespace pertev::described {

class ImageBudget {
public:
    explicit ImageBudget(uint64_t bytes) : bytes_(bytes), left_(bytes) {}

    /// Takes the bytes of a picture with float channels as large as `like`. Throws Error(OverLimit) if too few bytes
    /// are left.
    void charge(const TextureImage& like) {
        const bool is_bytes = !like.rgba8.pixels.empty();
        const uint64_t size = (is_bytes ? like.rgba8.pixels.size() : like.rgba_float.pixels.size()) * sizeof(float);
        if (size > left_) {
            throw Error(ErrorCode::OverLimit, FileLocation{like.name},
                        fmt::format("changed copies of pictures take over {} MiB; the limit for files of this size",
                                    bytes_ >> 20));
        }
        left_ -= size;
    }

private:
    uint64_t bytes_, left_;
};

} // namespace pertev::described
