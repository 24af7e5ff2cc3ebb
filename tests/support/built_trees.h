#pragma once

// Meshes for tests of builders on a device, and comparisons of trees.

#include <cstring>
#include <vector>

#include "accel/bvh/compressed_bvh.h"
#include "tests/support/stress_meshes.h"

namespace pertev::test {

/// Returns all bytes of a tree, empty arrays included.
template <class T>
bool are_same(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool are_same(const CompressedBvh& a, const CompressedBvh& b) {
    return are_same(a.nodes, b.nodes) && are_same(a.triangles, b.triangles) && a.depth == b.depth &&
           a.sah_cost == b.sah_cost && a.bounds == b.bounds;
}

/// Meshes that break builders, and sizes around the limits of warps and groups.
inline std::vector<StressMesh> builder_meshes() {
    std::vector<StressMesh> all = stress_meshes(700);
    for (const uint32_t count : {2u, 3u, 4u, 15u, 16u, 17u, 31u, 32u, 33u, 34u, 63u, 65u, 129u, 300u}) {
        all.push_back({"a small soup", make_soup(count, 0), {}});
    }
    return all;
}

} // namespace pertev::test
