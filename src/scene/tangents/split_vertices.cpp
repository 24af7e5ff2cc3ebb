#include "scene/tangents/split_vertices.h"

#include <bit>

#include "base/key_numbers.h"

namespace pertev {

SplitVertices split_vertices(std::span<const uint32_t> indices, std::size_t vertex_count,
                             std::span<const Vec4> tangents) {
    SplitVertices split;
    split.indices.reserve(indices.size());
    split.first_corner.assign(vertex_count, kNoCornerShows);
    KeyNumbers<5> known(indices.size());
    std::vector<uint32_t> vertex_of; // by the key's number
    for (uint32_t corner = 0; corner < indices.size(); ++corner) {
        const uint32_t old = indices[corner];
        const Vec4 t = tangents[corner];
        const uint32_t number = known.number_of({old, std::bit_cast<uint32_t>(t.x), std::bit_cast<uint32_t>(t.y),
                                                 std::bit_cast<uint32_t>(t.z), std::bit_cast<uint32_t>(t.w)});
        if (number == vertex_of.size()) { // a new one
            const bool is_first = split.first_corner[old] == kNoCornerShows;
            vertex_of.push_back(is_first ? old : static_cast<uint32_t>(split.first_corner.size()));
            if (is_first) {
                split.first_corner[old] = corner;
            } else {
                split.first_corner.push_back(corner);
                split.copied_from.push_back(old);
            }
        }
        split.indices.push_back(vertex_of[number]);
    }
    return split;
}

} // namespace pertev
