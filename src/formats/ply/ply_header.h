#pragma once

// The header of a PLY file: its elements in order, with their properties.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/remark.h"

namespace pertev {

enum class PlyFormat : uint8_t { Ascii, LittleEndian, BigEndian };
enum class PlyType : uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64, Int64, UInt64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::Float32; // type of the value, or of a list's entries
    bool is_list = false;
    PlyType count_type = PlyType::UInt8; // lists
};

struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

/// A comment `TextureFile NAME`.
struct PlyTexture {
    std::string name;
    std::size_t line = 0;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::Ascii;
    std::vector<PlyElement> elements;
    std::vector<PlyTexture> textures;
    std::vector<Remark> repairs; // repaired violations of the format, for warnings
    std::size_t size = 0;        // bytes up to the body
};

/// Bytes of one value in a binary file.
std::size_t size_of(PlyType type);

/// Parses the header. Throws Error(BadInput) that names `file` and the line.
PlyHeader parse_ply_header(std::span<const std::byte> bytes, const std::string& file);

} // namespace pertev
