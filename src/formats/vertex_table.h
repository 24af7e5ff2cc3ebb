#pragma once

// Gives each different corner of faces one vertex, where a file has indices or values of its own for each corner.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pertev {

/// What tells corners apart: three numbers of any meaning, indices or the bits of values.
struct VertexKey {
    uint32_t position, uv, normal;
    bool operator==(const VertexKey&) const = default;
};

/// The vertices stand in the order of first use. Open addressing: time and memory follow the number of corners,
/// whatever their numbers are.
class VertexTable {
public:
    explicit VertexTable(std::size_t corners) : slots_(std::bit_ceil(2 * corners + 1), kFree) {}

    uint32_t vertex_of(const VertexKey& corner) {
        const std::size_t mask = slots_.size() - 1;
        uint64_t hash = corner.position * 0x9e3779b97f4a7c15u;
        hash = (hash ^ (hash >> 29) ^ corner.uv) * 0xbf58476d1ce4e5b9u;
        hash = (hash ^ (hash >> 32) ^ corner.normal) * 0x94d049bb133111ebu;
        for (std::size_t at = (hash >> 20) & mask;; at = (at + 1) & mask) {
            if (slots_[at] == kFree) {
                slots_[at] = static_cast<uint32_t>(vertices_.size());
                vertices_.push_back(corner);
                return slots_[at];
            }
            if (vertices_[slots_[at]] == corner) return slots_[at];
        }
    }
    const std::vector<VertexKey>& vertices() const { return vertices_; }

private:
    static constexpr uint32_t kFree = 0xffffffffu;
    std::vector<uint32_t> slots_;
    std::vector<VertexKey> vertices_;
};

} // namespace pertev
