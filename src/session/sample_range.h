#pragma once

// The part of a picture that one call or one machine renders: rows of pixels, and a range of the samples of each or one
// of equal parts of them.

#include <cstdint>
#include <optional>
#include <utility>

#include "render/film.h"
#include "settings/picture_options.h"

namespace pertev {

/// The number of one of several equal parts.
struct PartNumber {
    uint64_t index = 0, count = 1; // the index counts from 0

    /// Returns the part [first, end) of `all` things in a row; it may be empty if there are more parts than things.
    std::pair<uint64_t, uint64_t> of(uint64_t all) const { return {all * index / count, all * (index + 1) / count}; }
};

/// Returns the requested part; nothing if none is requested. Throws Error(BadInput) for another text, and for a part
/// that does not exist.
std::optional<PartNumber> part_number(const PictureOptions& options);
/// Returns whether several pictures are requested, which a part is one of.
bool has_frames(const PictureOptions& options);

/// Returns the requested samples: those of `samples`, or of `part`, which may be none if there are more parts than
/// samples; else all, and so for each of several pictures. Throws Error(BadInput) for a text that is neither, and as
/// part_number.
SampleRange sample_range(const PictureOptions& options);

/// Returns the requested rows [first, end); (0, 0) for all. Throws Error(BadInput) for another text.
std::pair<uint32_t, uint32_t> row_range(const PictureOptions& options);

} // namespace pertev
