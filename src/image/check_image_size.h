#pragma once

// Guards every reader's first allocation: a picture's header may claim any size, so the claim is held against what
// the compressed bytes could possibly expand to, and then against base/limits.h, before memory is asked for. A claim
// that is true may still be too much: a picture of one colour compresses nearly without bound.

#include <cstdint>
#include <string>

namespace pertev {

/// Room that a header may ask for before its claim is doubted, whatever the file's length (bytes).
inline constexpr uint64_t kImageBytesAlwaysAllowed = uint64_t(16) << 20;

/// Returns when a file of `file_bytes` bytes may hold width x height pixels that need `decoded_bytes` bytes in memory.
/// `most_per_byte`: the most of these that one byte of the format can stand for. Throws Error(BadInput) that starts
/// with `name` for an empty or impossible size, Error(OverLimit) for a possible one over kMaxImageSide or
/// kMaxImagePixels or as check_decoded_bytes does.
void check_image_size(const std::string& name, uint64_t width, uint64_t height, uint64_t decoded_bytes,
                      uint64_t file_bytes, uint64_t most_per_byte);

/// Throws Error(OverLimit) that starts with `name` when a file of `file_bytes` bytes does not justify `decoded_bytes`
/// bytes of pixels in memory: for what is made of a picture that passed check_image_size.
void check_decoded_bytes(const std::string& name, uint64_t decoded_bytes, uint64_t file_bytes);

/// a * b, or the largest value where that would not fit: for sizes out of a file.
constexpr uint64_t multiply_saturated(uint64_t a, uint64_t b) {
    return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

} // namespace pertev
