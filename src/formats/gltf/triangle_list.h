#pragma once

// Triangle lists, strips and fans as one list. Source: glTF 2.0 section 3.7.2.1.

#include <cstdint>
#include <vector>

namespace pertev::gltf {

enum class Topology : uint8_t { Points, Lines, LineLoop, LineStrip, Triangles, TriangleStrip, TriangleFan };

/// Three indices a triangle, counter-clockwise seen from the front, of the corners in the order of the file. Corners
/// that make no whole triangle are left over. Only for the three topologies of triangles.
std::vector<uint32_t> triangle_list(Topology topology, std::vector<uint32_t> corners);

} // namespace pertev::gltf
