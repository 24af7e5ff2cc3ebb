#pragma once

// Key of a face corner, for files with indices or values per corner. KeyNumbers of base/key_numbers.h assigns a
// vertex to each different key.

#include <cstdint>

namespace pertev {

/// Three numbers of any meaning, indices or the bits of values.
struct VertexKey {
    uint32_t position, uv, normal;
    bool operator==(const VertexKey&) const = default;
};

} // namespace pertev
