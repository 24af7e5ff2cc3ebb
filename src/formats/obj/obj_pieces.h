#pragma once

// The text of an OBJ file in pieces, which threads read at the same time, and what a piece must know of those before
// it.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace pertev {

/// What faces belong to: the names of the last o, g and usemtl.
struct ObjGroupKey {
    std::string_view object, group, material;
    bool operator==(const ObjGroupKey&) const = default;
};

struct ObjGroupKeyHash {
    std::size_t operator()(const ObjGroupKey& key) const {
        const std::hash<std::string_view> hash;
        return (hash(key.object) * 31 + hash(key.group)) * 31 + hash(key.material);
    }
};

using ObjGroupNumbers = std::unordered_map<ObjGroupKey, std::size_t, ObjGroupKeyHash>;

/// The object, the group, or both apart by a slash where they differ.
std::string name_of(const ObjGroupKey& key);

struct ObjCounts {
    std::size_t positions = 0, uvs = 0, normals = 0;
};

/// Whole statements, which one thread reads.
struct ObjPiece {
    std::string_view text;
    // What stands before it.
    uint32_t line = 1; // the number of its first
    ObjCounts counts = {};
    ObjGroupKey key = {};
};

/// Of about so many bytes, cut where a line ends that cannot be joined with the next, be it a comment or not.
std::vector<ObjPiece> cut_into_obj_pieces(std::string_view text, char end_of_line, std::size_t piece_bytes);

/// Says of each piece what stands before it. Returns the counts of all together.
ObjCounts count_before(std::vector<ObjPiece>& pieces, char end_of_line);

} // namespace pertev
