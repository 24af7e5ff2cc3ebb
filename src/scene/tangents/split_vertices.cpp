#include "scene/tangents/split_vertices.h"

#include <bit>

#include "base/key_numbers.h"

namespace pertev {

SplitVertices split_vertices(std::span<const uint32_t> indices, std::size_t vertex_count,
                             std::span<const Vec4> tangents) {
    SplitVertices split;
    split.indices.assign(indices.begin(), indices.end());
    split.first_corner.assign(vertex_count, kNoCornerShows);
    std::vector<uint32_t> others; // corners whose tangent differs from that of their vertex's first corner
    for (uint32_t corner = 0; corner < indices.size(); ++corner) {
        uint32_t& first = split.first_corner[indices[corner]];
        if (first == kNoCornerShows) first = corner;
        if (!(tangents[corner] == tangents[first])) others.push_back(corner);
    }
    KeyNumbers<std::array<uint32_t, 5>> known(others.size());
    for (const uint32_t corner : others) {
        const Vec4 t = tangents[corner];
        const uint32_t copy =
            known.number_of({indices[corner], std::bit_cast<uint32_t>(t.x), std::bit_cast<uint32_t>(t.y),
                             std::bit_cast<uint32_t>(t.z), std::bit_cast<uint32_t>(t.w)});
        if (copy == split.copied_from.size()) {
            split.copied_from.push_back(indices[corner]);
            split.first_corner.push_back(corner);
        }
        split.indices[corner] = static_cast<uint32_t>(vertex_count + copy);
    }
    return split;
}

} // namespace pertev
