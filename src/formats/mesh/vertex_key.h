#pragma once

// Key of a face corner, for files with indices or values per corner. CornerNumbers of formats/mesh/corner_numbers.h
// assigns a vertex to each different key of indices, KeyNumbers of base/key_numbers.h to each of values.

#include <cstdint>

namespace pertev {

/// Three numbers of any meaning, indices or the bits of values.
struct VertexKey {
    uint32_t position, uv, normal;
    bool operator==(const VertexKey&) const = default;
};

} // namespace pertev
