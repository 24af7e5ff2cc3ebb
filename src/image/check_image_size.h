#pragma once

// Guards every reader's first allocation: a picture's header may claim any size, so the claim is compared with the
// maximum expansion of the compressed bytes and then with base/limits.h before memory is allocated. A true claim may
// still be too large, because a picture of one colour compresses almost without bound.

#include <cstdint>
#include <string>

namespace pertev {

/// Size that a header may claim without a check, whatever the file's length (bytes).
inline constexpr uint64_t kImageBytesAlwaysAllowed = uint64_t(16) << 20;

/// Returns if a file of `file_bytes` bytes may contain width x height pixels that need `decoded_bytes` bytes in
/// memory. `max_per_byte` is the maximum number of these per byte of the format. Throws Error(BadInput) that starts
/// with `name` for an empty or impossible size, Error(OverLimit) for a possible one over kMaxImageSide or
/// kMaxImagePixels or as check_decoded_bytes does.
void check_image_size(const std::string& name, uint64_t width, uint64_t height, uint64_t decoded_bytes,
                      uint64_t file_bytes, uint64_t max_per_byte);

/// Throws Error(OverLimit) that starts with `name` if a file of `file_bytes` bytes does not justify `decoded_bytes`
/// bytes of pixels in memory. For data derived from a picture that passed check_image_size.
void check_decoded_bytes(const std::string& name, uint64_t decoded_bytes, uint64_t file_bytes);

/// Saturating product a * b, for sizes from a file.
constexpr uint64_t multiply_saturated(uint64_t a, uint64_t b) {
    return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

} // namespace pertev
