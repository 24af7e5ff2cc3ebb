#pragma once

// Comparisons of trees for the tests of builders.

#include <algorithm>
#include <cstring>
#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev::test {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Maximum number of triangles in a leaf.
inline int largest_leaf(const Bvh& bvh) {
    int largest = 0, run = 0;
    for (const BvhTriangle& t : bvh.triangles) {
        largest = std::max(largest, ++run);
        if (t.flags & kLastInLeaf) run = 0;
    }
    return largest;
}

} // namespace pertev::test
