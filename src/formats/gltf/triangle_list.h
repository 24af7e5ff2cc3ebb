#pragma once

// Triangle lists, strips and fans as one list. Source: glTF 2.0 section 3.7.2.1.

#include <cstdint>
#include <vector>

namespace pertev::gltf {

enum class Topology : uint8_t { Points, Lines, LineLoop, LineStrip, Triangles, TriangleStrip, TriangleFan };

/// Three indices per triangle, counter-clockwise as seen from the front, from the corners in the order of the file.
/// Corners that form no complete triangle are ignored. Only for the three triangle topologies.
std::vector<uint32_t> triangle_list(Topology topology, std::vector<uint32_t> corners);

} // namespace pertev::gltf
