#pragma once

// Guards every reader's first allocation: a picture's header may claim any size, so the claim is held against what
// the compressed bytes could possibly expand to, and then against base/limits.h, before memory is asked for.

#include <cstdint>
#include <string>

namespace pertev {

/// Room that any file may ask for, whatever its length (bytes): small constant pictures compress without bound.
inline constexpr uint64_t kImageBytesAlwaysAllowed = uint64_t(16) << 20;

/// Returns when a file of `file_bytes` bytes may hold width x height pixels that need `decoded_bytes` bytes in memory.
/// `most_per_byte`: the most that one byte of the format can stand for. Throws Error(BadInput) that starts with
/// `name` for an empty or impossible size, Error(OverLimit) for a possible one over kMaxImageSide or kMaxImagePixels.
void check_image_size(const std::string& name, uint64_t width, uint64_t height, uint64_t decoded_bytes,
                      uint64_t file_bytes, uint64_t most_per_byte);

/// a * b, or the largest value where that would not fit: for sizes out of a file.
constexpr uint64_t multiply_saturated(uint64_t a, uint64_t b) {
    return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

} // namespace pertev
