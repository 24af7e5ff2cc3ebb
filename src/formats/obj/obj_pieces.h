#pragma once

// Splits the text of an OBJ file into pieces for parallel parsing, with the state that a piece needs from earlier
// ones.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace pertev {

/// Key of the group of faces: the names of the last o, g and usemtl.
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

/// The object or the group, or both separated by a slash if they differ.
std::string name_of(const ObjGroupKey& key);

struct ObjCounts {
    std::size_t positions = 0, uvs = 0, normals = 0;
};

/// Whole statements, which one thread parses.
struct ObjPiece {
    std::string_view text;
    // State before the piece.
    uint32_t line = 1; // number of its first line
    ObjCounts counts = {};
    ObjGroupKey key = {};
};

/// Splits a text into pieces of about `piece_bytes` bytes, at line ends that continue no line, inside comments or not.
std::vector<ObjPiece> cut_into_obj_pieces(std::string_view text, char end_of_line, std::size_t piece_bytes);

/// Sets the state before each piece. Returns the total counts.
ObjCounts count_before(std::vector<ObjPiece>& pieces, char end_of_line);

} // namespace pertev
