#pragma once

// What tells the corners of faces apart, where a file has indices or values of its own for each corner. KeyNumbers of
// base/key_numbers.h gives each different corner one vertex.

#include <cstdint>

namespace pertev {

/// Three numbers of any meaning, indices or the bits of values.
struct VertexKey {
    uint32_t position, uv, normal;
    bool operator==(const VertexKey&) const = default;
};

} // namespace pertev
